# SPDX-License-Identifier: Apache-2.0
"""A CSV with a row for each configuration that a study measures.

Header and rows are only ever appended, and each row is on the disk before the next begins: an interrupted study
continues where it stopped.
"""

import contextlib
import csv
import fcntl
import io
import os
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from tqdm import tqdm

from tactile_depth.base import files
from tactile_depth.base.errors import InputError

Key = tuple[str, ...]
Row = dict[str, str]


@dataclass(frozen=True)
class Wanted:
    """A row to be measured.

    Attributes
    ----------
    cells : dict of str
        The cells that describe the configuration.
    choices : object
        Argument of the function that measures it.
    work : int
        Time it takes, in any unit.
    """

    cells: Row
    choices: Any
    work: int


@dataclass(frozen=True)
class Table:
    """The file `name`.csv of a study.

    Attributes
    ----------
    name : str
    configuration, measured : tuple of str
        Columns: those that describe a configuration, and the others. One of them is `models`.
    version : str
        Cell of `models`; rows of other versions are not comparable.
    """

    name: str
    configuration: tuple[str, ...]
    measured: tuple[str, ...]
    version: str

    @property
    def header(self) -> tuple[str, ...]:
        return (*self.configuration, *self.measured)

    def key(self, row: Row) -> Key:
        return tuple(row[name] for name in self.configuration)

    def kept(self, path: Path, content: bytes) -> tuple[dict[Key, Row], int]:
        """Return the rows of an earlier run and the length of the complete lines; a last line without an end is torn.

        Raises InputError: the rows are not of these columns and these models.
        """
        mend = "move it away, or give another folder with OUT="
        complete = content[: content.rfind(b"\n") + 1]
        if not complete and line(self.header).startswith(content):
            return {}, 0
        try:
            lines = [*csv.reader(io.StringIO(complete.decode()), strict=True)]
        except (UnicodeDecodeError, csv.Error) as error:
            raise InputError(f"{path}: not a readable table ({error}): {mend}") from error
        if lines[:1] != [list(self.header)]:
            raise InputError(f"{path}: its columns are not those of this version: {mend}")
        rows = {}
        for number, cells in enumerate(lines[1:], start=2):
            if len(cells) != len(self.header):
                raise InputError(f"{path}: line {number} has {len(cells)} cells in place of {len(self.header)}: {mend}")
            row = dict(zip(self.header, cells, strict=True))
            if row["models"] != self.version:
                raise InputError(f"{path}: line {number} was measured with another version of the models: {mend}")
            rows[self.key(row)] = row
        return rows, len(complete)

    @contextlib.contextmanager
    def opened(self, folder: Path) -> Iterator[tuple[BinaryIO, dict[Key, Row]]]:
        """Yield the table in a folder, open to append, and its rows; one study at a time. Raises InputError."""
        path = folder / f"{self.name}.csv"
        files.make(folder, [path.name])
        file = path.open("a+b")
        with file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                mend = "wait for it, or give another OUT="
                raise InputError(f"{path}: another {self.name} is writing it: {mend}") from error
            file.seek(0)
            content = file.read()
            rows, length = self.kept(path, content)
            if length < len(content):  # removes a line that a crash cut off
                file.truncate(length)
            if not length:
                _append(file, self.header)
            yield file, rows

    def complete(
        self, wanted: Sequence[Wanted], folder: Path, measure: Callable[[list[Any]], Generator[Row]]
    ) -> list[Row]:
        """Measure the rows that the table in `folder` lacks; return all in the order of `wanted`.

        `measure` yields the rows of a list of choices in any order. Raises InputError; rows measured are kept.
        """
        with contextlib.ExitStack() as stack:
            file, done = stack.enter_context(self.opened(folder))
            left = [row for row in wanted if self.key(row.cells) not in done]
            if len(left) < len(wanted):
                print(
                    f"{len(wanted) - len(left)} of {len(wanted)} rows are there already: {os.path.relpath(file.name)}"
                )
            work = {self.key(row.cells): row.work for row in left}
            shape = "{percentage:3.0f}%|{bar}| {postfix} [{elapsed} < {remaining}]"
            bar = stack.enter_context(tqdm(total=sum(work.values()), bar_format=shape, leave=False, disable=None))
            measured = stack.enter_context(contextlib.closing(measure([row.choices for row in left])))
            for count, row in enumerate(measured, start=1):
                _append(file, tuple(row[name] for name in self.header))
                done[self.key(row)] = row
                bar.set_postfix_str(f"{count} of {len(left)} rows", refresh=False)
                bar.update(work[self.key(row)])
        return [done[self.key(row.cells)] for row in wanted]


def line(cells: Sequence[str]) -> bytes:
    """Return a line of a CSV file."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode()


def _append(file: BinaryIO, cells: Sequence[str]) -> None:
    """Write a line to the disk."""
    file.write(line(cells))
    file.flush()
    os.fsync(file.fileno())
