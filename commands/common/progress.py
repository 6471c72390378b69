# SPDX-License-Identifier: Apache-2.0
"""Progress bars of work that another process does."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tqdm import tqdm


@contextmanager
def following(what: str, total: int, unit: str, count: Callable[[], int]) -> Iterator[None]:
    """Show a bar that a thread moves to what `count` returns, until the block ends."""
    finished = threading.Event()
    with tqdm(total=total, desc=what, unit=unit, leave=False, disable=None) as bar:

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
