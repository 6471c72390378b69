# SPDX-License-Identifier: Apache-2.0
"""Interruption by SIGINT, SIGTERM or SIGHUP: child processes end, and the command removes its temporary files.

Nobody is told of SIGKILL: a process beside each command, its guard, ends what a run leaves.
"""

import contextlib
import os
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import psutil

from tactile_depth.base import interruption

GRACE_S = 2.0  # from SIGTERM to SIGKILL of a child
POLL_S = 0.5  # of a guard
RUN = "TACTILE_DEPTH_RUN"
"""Variable of each process of a run: `/`, the make that its command follows or 0, `-`, and the id of the command."""
_guards: set[int] = set()


def living(known: Iterable[psutil.Process] = ()) -> list[psutil.Process]:
    """Return the living descendants of this process, the others of its run, whose parents have ended, and `known`.

    Trackers of multiprocessing are left out: they delete the shared memory of the workers, and end by themselves. The
    guard of this process is left out too.
    """
    processes, run = [], os.environ.get(RUN, "")
    own = of_run(run) if run.endswith(f"-{os.getpid()}") else ()  # in a forked worker the run is its parent's
    for process in {*known, *own, *psutil.Process().children(recursive=True)}:
        with contextlib.suppress(psutil.Error):  # the process has ended meanwhile
            left_out = process.pid in _guards or "resource_tracker" in " ".join(process.cmdline())
            if process.status() != psutil.STATUS_ZOMBIE and not left_out:
                processes.append(process)
    return processes


def end_children(known: Iterable[psutil.Process] = ()) -> None:
    """End what `living` returns by SIGTERM, and those that still run after `GRACE_S` by SIGKILL."""
    processes = living(known)
    for number in (signal.SIGTERM, signal.SIGKILL):
        deadline = time.monotonic() + GRACE_S
        for process in processes:
            with contextlib.suppress(psutil.Error):
                process.send_signal(number)
        # The second search finds what a process has started and left during the first.
        while (processes := living(processes) or living()) and time.monotonic() < deadline:
            time.sleep(0.02)  # psutil's own waiting would take the exit status from subprocess


@contextmanager
def guarded() -> Iterator[None]:
    """Keep a guard: when SIGKILL ends this command, or the make that runs it, every process of the run ends."""
    run, command = os.environ.get(RUN, ""), psutil.Process()
    if not run.endswith(f"-{command.pid}"):  # no make has started this command
        run = os.environ[RUN] = f"{run}/0-{command.pid}"
    guard = os.fork()
    if not guard:
        try:
            _guard(command, run)
        finally:
            os._exit(0)
    _guards.add(guard)
    try:
        yield
    finally:
        if os.getpid() == command.pid:  # no forked worker
            os.kill(guard, signal.SIGKILL)
            os.waitpid(guard, 0)
            _guards.remove(guard)


def _guard(command: psutil.Process, run: str) -> None:
    """Wait until a command ends or another process than its make is its parent, then end every process of the run."""
    os.setsid()  # a signal to the terminal does not end the guard
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nowhere, stream)
    os.closerange(3, os.sysconf("SC_OPEN_MAX"))  # nobody waits for the guard at a pipe or a lock
    make = int(run.rpartition("/")[2].partition("-")[0])
    with contextlib.suppress(psutil.Error):  # the command has ended
        while command.status() != psutil.STATUS_ZOMBIE and make in (0, command.ppid()):
            time.sleep(POLL_S)
    while processes := living(of_run(run)) or living(of_run(run)):
        end_children(processes)


def of_run(run: str) -> Iterator[psutil.Process]:
    """Yield the processes of a run but this one."""
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):  # it has ended, or belongs to another user
            if process.pid != os.getpid() and f"{process.environ().get(RUN)}/".startswith(f"{run}/"):
                yield process


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
