# SPDX-License-Identifier: Apache-2.0
"""Keys that are pressed in the terminal, one at a time, without Enter."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def pressed_keys() -> Iterator[Callable[[], str] | None]:
    """Give a function that returns the key pressed since the last call, "" for none; None without a terminal.

    The terminal is as before when the block ends, however it ends.
    """
    if sys.stdin is None or not sys.stdin.isatty():
        yield None
        return
    if sys.platform == "win32":
        import msvcrt

        yield lambda: msvcrt.getwch() if msvcrt.kbhit() else ""
        return
    import termios
    import tty

    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)

    def key() -> str:
        if not select.select([terminal], [], [], 0)[0]:
            return ""
        return os.read(terminal, 1).decode(errors="replace")

    try:
        tty.setcbreak(terminal)
        yield key
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)
