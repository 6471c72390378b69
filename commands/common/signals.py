# SPDX-License-Identifier: Apache-2.0
"""Interruption by SIGINT, SIGTERM or SIGHUP: child processes end, and the command removes its temporary files."""

import contextlib
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import psutil

from tactile_depth.base import interruption

GRACE_S = 2.0  # from SIGTERM to SIGKILL of a child


def living(known: Iterable[psutil.Process] = ()) -> list[psutil.Process]:
    """Return the living descendants of this process and those of `known`, whose parents may have ended.

    Trackers of multiprocessing are left out: they delete the shared memory of the workers, and end by themselves.
    """
    processes = []
    for process in {*known, *psutil.Process().children(recursive=True)}:
        with contextlib.suppress(psutil.Error):  # the process has ended meanwhile
            if process.status() != psutil.STATUS_ZOMBIE and "resource_tracker" not in " ".join(process.cmdline()):
                processes.append(process)
    return processes


def end_children() -> None:
    """End all descendants by SIGTERM, and by SIGKILL those that still run after `GRACE_S`."""
    processes = living()
    for number in (signal.SIGTERM, signal.SIGKILL):
        deadline = time.monotonic() + GRACE_S
        for process in processes:
            with contextlib.suppress(psutil.Error):
                process.send_signal(number)
        while (processes := living(processes)) and time.monotonic() < deadline:
            time.sleep(0.02)  # psutil's own waiting would take the exit status from subprocess


class Pool(ThreadPoolExecutor):
    """Pool of threads that begin no call after a signal."""

    def submit(self, call: Callable, /, *arguments: Any, **named: Any) -> Future:
        return super().submit(_begin, call, *arguments, **named)


def _begin(call: Callable, *arguments: Any, **named: Any) -> Any:
    if interruption.received():
        raise CancelledError
    return call(*arguments, **named)


@contextmanager
def threads(workers: int) -> Iterator[Pool]:
    """Yield a pool of threads; an exception cancels calls that have not begun, a signal ends running calls."""
    pool = Pool(workers)
    try:
        yield pool
    except BaseException as error:
        pool.shutdown(wait=False, cancel_futures=True)
        if isinstance(error, interruption.Stopped):
            end_children()  # processes too that a call has started since the signal
        raise
    finally:
        pool.shutdown()
