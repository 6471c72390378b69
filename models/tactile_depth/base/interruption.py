# SPDX-License-Identifier: Apache-2.0
"""Interruption by SIGINT, SIGTERM or SIGHUP. It stays one, whatever exception a library makes of it."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_TEXTS = {"SIGINT": "interrupted", "SIGTERM": "terminated by SIGTERM", "SIGHUP": "terminated by SIGHUP"}
SIGNALS: dict[int, str] = {getattr(signal, name): text for name, text in _TEXTS.items() if hasattr(signal, name)}
_handlers: dict[int, Any] = {}  # handled now by `stoppable`, and the handlers before
_received: list[int] = []  # signals until the outermost `stoppable` ends


class Stopped(KeyboardInterrupt):
    """Signal that ends the command; a KeyboardInterrupt, because libraries clean up after a KeyboardInterrupt."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def received() -> int | None:
    """Return the number of the signal that is ending the command, None without one."""
    return _received[0] if _received else None


def number_of(stop: KeyboardInterrupt) -> int:
    """Return the number of the signal that caused an exception; that of SIGINT if nobody handled it."""
    return stop.number if isinstance(stop, Stopped) else signal.SIGINT


@contextmanager
def stoppable(end: Callable[[], object] = lambda: None) -> Iterator[None]:
    """Call `end` and raise `Stopped` at the first of `SIGNALS`; ignore later signals.

    The block ends with `Stopped` after a signal even if another exception leaves it, or none: numpy turns an
    exception of a signal handler into a TypeError inside `fromfile`, for one.

    A signal that the caller ignores (nohup) stays ignored. A forked worker that gets a signal exits without output.
    Outside the main thread, which alone can handle signals, nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    owner, outermost = os.getpid(), not _handlers

    def stop(number: int, frame: FrameType | None) -> None:
        _received.append(number)
        for other in _handlers:
            signal.signal(other, signal.SIG_IGN)  # make sends SIGTERM a second time: continue to clean up
        end()
        if os.getpid() != owner:
            os._exit(128 + number)
        raise Stopped(number)

    try:
        for number in SIGNALS if outermost else ():
            if (handler := signal.getsignal(number)) != signal.SIG_IGN:
                _handlers[number] = handler
                signal.signal(number, stop)
        yield
    except (Stopped, SystemExit):
        raise
    except BaseException as error:
        if _received:
            raise Stopped(_received[0]) from error
        raise
    else:
        if _received:
            raise Stopped(_received[0])
    finally:
        if outermost:
            for number, handler in _handlers.items():
                signal.signal(number, handler)
            _handlers.clear()
            _received.clear()
