# SPDX-License-Identifier: Apache-2.0
"""Progress bars, and those of work that another process does."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from tqdm import tqdm

progress_bar = partial(tqdm, leave=False, disable=None)  # of a terminal; it vanishes at the end


def duration(seconds: float) -> str:
    """Return a time in the unit that people would say."""
    for unit, of in (("hours", 3600), ("minutes", 60)):
        if seconds >= 1.5 * of:
            return f"{seconds / of:.0f} {unit}"
    return f"{max(1, seconds):.0f} s"


@contextmanager
def following(what: str, total: int, unit: str, count: Callable[[], int]) -> Iterator[None]:
    """Show a bar that a thread moves to what `count` returns, until the block ends."""
    finished = threading.Event()
    with progress_bar(total=total, desc=what, unit=unit) as bar:

        def follow() -> None:
            while not finished.wait(0.2):
                bar.update(min(count(), total) - bar.n)

        thread = threading.Thread(target=follow)
        thread.start()
        try:
            yield
        finally:
            finished.set()
            thread.join()
