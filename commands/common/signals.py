# SPDX-License-Identifier: Apache-2.0
"""Interruption by SIGINT, SIGTERM or SIGHUP: child processes end, and the command removes its temporary files."""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

SIGNALS: dict[int, str] = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated by SIGTERM",
    signal.SIGHUP: "terminated by SIGHUP",
}
GRACE_S = 2.0  # from SIGTERM to SIGKILL of a child
PROC = Path("/proc")
_handled: dict[int, Any] = {}  # signals that `stoppable` handles now, and their previous handlers
_stopping = threading.Event()  # set from a signal until the command has cleaned up


class Stopped(KeyboardInterrupt):
    """Signal that ends the command; a KeyboardInterrupt, because libraries clean up after a KeyboardInterrupt."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


@contextmanager
def stoppable() -> Iterator[None]:
    """Raise `Stopped` at the first of `SIGNALS`, after the child processes have ended; ignore later signals.

    A signal that the caller ignores (nohup) stays ignored. A forked worker that gets a signal exits without output.
    """
    if _handled or threading.current_thread() is not threading.main_thread():
        yield  # the outermost handles the signals
        return
    owner = os.getpid()

    def stop(number: int, frame: FrameType | None) -> None:
        _stopping.set()
        for other in _handled:
            signal.signal(other, signal.SIG_IGN)  # make sends SIGTERM a second time: continue to clean up
        end_children()
        if os.getpid() != owner:
            os._exit(128 + number)
        raise Stopped(number)

    for number in SIGNALS:
        if (handler := signal.getsignal(number)) != signal.SIG_IGN:
            _handled[number] = handler
            signal.signal(number, stop)
    try:
        yield
    finally:
        for handled, handler in _handled.items():
            signal.signal(handled, handler)
        _handled.clear()
        _stopping.clear()


def children() -> list[int]:
    """Return the process ids of all living descendants of this process; none if there is no /proc.

    Trackers of multiprocessing are left out: they delete the shared memory of the workers, and end by themselves.
    """
    parents: dict[int, list[int]] = {}
    for entry in PROC.glob("[0-9]*"):
        with contextlib.suppress(OSError):  # the process has ended meanwhile
            state, parent = (entry / "stat").read_text().rpartition(")")[2].split()[:2]
            if state != "Z" and b"resource_tracker" not in (entry / "cmdline").read_bytes():
                parents.setdefault(int(parent), []).append(int(entry.name))
    descendants = parents.get(os.getpid(), [])
    for process in descendants:  # the list grows in the loop
        descendants.extend(parents.get(process, []))
    return descendants


def end_children() -> None:
    """End all descendants by SIGTERM, and by SIGKILL those that still run after `GRACE_S`."""
    processes = children()
    deadline = time.monotonic() + GRACE_S
    for number in (signal.SIGTERM, signal.SIGKILL):
        for process in processes:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, number)
        while (processes := living(processes)) and time.monotonic() < deadline:
            time.sleep(0.02)
        deadline += GRACE_S


def living(processes: list[int]) -> list[int]:
    """Return the processes of the list that still run, zombies excluded, and their new children."""
    left = []
    for process in processes:
        with contextlib.suppress(OSError):
            if (PROC / str(process) / "stat").read_text().rpartition(")")[2].split()[0] != "Z":
                left.append(process)
    return list(dict.fromkeys([*left, *children()]))


class Pool(ThreadPoolExecutor):
    """Pool of threads that begin no call after a signal."""

    def submit(self, call: Callable, /, *arguments: Any, **named: Any) -> Future:
        return super().submit(_begin, call, *arguments, **named)


def _begin(call: Callable, *arguments: Any, **named: Any) -> Any:
    if _stopping.is_set():
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
        if isinstance(error, Stopped):
            end_children()  # processes too that a call has started since the signal
        raise
    finally:
        pool.shutdown()
