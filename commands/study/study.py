# SPDX-License-Identifier: Apache-2.0
"""A study: a CSV with a row for each configuration that it measures, on all cores or on a cluster.

A study declares its columns with the fields of two dataclasses: a `Point` describes a configuration, and a row extends
it by what is measured. Header and rows are only ever appended, and each row is on the disk before the next begins: an
interrupted study continues where it stopped.
"""

import contextlib
import csv
import fcntl
import hashlib
import io
import logging
import os
import re
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, make_dataclass, replace
from functools import partial
from importlib.resources import files as resources
from pathlib import Path
from typing import Any, BinaryIO, Generic, Protocol, Self, TypeVar, get_args, get_type_hints

import joblib

from commands.common import python_code
from commands.common.progress import duration, progress_bar
from tactile_depth.base import files
from tactile_depth.base.errors import InputError

CONNECT_S, WORKERS_S = 10, 60  # wait for a cluster, and for its first worker
INTERRUPTED = "every row measured is kept, run it again to go on"
"""Sentence of a study that a signal ends; `python -m commands` prints what a module has under this name."""


def _version() -> str:
    """Return a digest of the code of all models; rows with different digests are not comparable."""
    digest = hashlib.sha256()

    def add(folder: Any) -> None:
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
            if entry.is_dir():
                add(entry)
            elif entry.name.endswith(".py"):
                digest.update(f"{entry.name}\0{python_code.code_of(entry.read_text())}\0".encode())

    add(resources("tactile_depth"))
    return digest.hexdigest()[:12]


VERSION = _version()  # computed at import, so that it belongs to the code that runs


@dataclass(frozen=True)
class Shape:
    """First columns of every study."""

    solver: str
    boundary: str
    rows: int
    columns: int
    lanes: int

    @property
    def pixels(self) -> int:
        """Pixels of a frame; the time of a measurement grows with them."""
        return self.rows * self.columns

    def but(self, **changes: Any) -> Self:
        """Return it with changes."""
        return replace(self, **changes)


def with_numbers(numbers: Iterable[str]) -> type:
    """Return the base of a Point: a Shape with a column for each of some numbers of `Configuration`."""
    return make_dataclass("Numbers", [(name, int) for name in numbers], bases=(Shape,), frozen=True)


class Measured(Protocol):
    """Row of a study."""

    @property
    def problem(self) -> str:
        """Reason why the configuration cannot be built; its measurements are then None."""


P = TypeVar("P", bound=Shape)
R = TypeVar("R", bound=Shape)
M = TypeVar("M", bound=Measured)
Cells = Sequence[str]
Measure = Callable[[P], Cells]


def built(rows: Iterable[M]) -> list[M]:
    """Return the rows of configurations that can be built."""
    return [row for row in rows if not row.problem]


def line(cells: Cells) -> bytes:
    """Return a line of a CSV file."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode()


def read(path: Path, row: type[R]) -> list[R]:
    """Return the rows of a table."""
    with path.open(newline="") as file:
        return [_row(row, cells.values()) for cells in csv.DictReader(file)]


def _row(kind: type[R], cells: Iterable[str]) -> R:
    def value(hint: Any, cell: str) -> Any:
        of = (*get_args(hint), hint)[0]  # of `float | None`
        return of(cell) if cell or of is str else None

    hints = get_type_hints(kind).values()
    return kind(*map(value, hints, cells))


def point_of(kind: type[P], row: Shape) -> P:
    """Return the configuration of a row."""
    return kind(*(getattr(row, column.name) for column in fields(kind)))


def _text(value: object) -> str:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Study(Generic[P, R]):
    """A study, whose table is the file `name`.csv.

    Attributes
    ----------
    name : str
    point, row : dataclass
        Columns that describe a configuration, and all columns; among the others are `problem` and `models`.
    measure : callable
        Returns what is measured of a configuration, by the names of columns. Raises InputError: it cannot be built.
    seconds : float
        Time that a pixel of a frame takes, on one core of 2.5 GHz.
    noted : callable
        Returns cells that a row has even if its configuration cannot be built.
    models : str
        Cell of the column `models`; rows of other versions are not comparable.
    """

    name: str
    point: type[P]
    row: type[R]
    measure: Callable[[P], dict[str, Any]]
    seconds: float
    noted: Callable[[P], dict[str, Any]]
    models: str = VERSION

    @property
    def header(self) -> list[str]:
        return [column.name for column in fields(self.row)]

    def cells(self, point: P) -> Cells:
        """Measure a configuration; return the cells of its row."""
        try:
            found = self.measure(point)
        except InputError as error:
            found = {"problem": str(error)}
        found |= {**vars(point), **self.noted(point), "models": self.models}
        return [_text(found.get(name)) for name in self.header]

    def measured(self, point: P) -> R:
        """Measure a configuration; return its row."""
        return _row(self.row, self.cells(point))

    def kept(self, path: Path, content: bytes) -> tuple[dict[P, R], int]:
        """Return the rows of an earlier run and the length of the complete lines; a last line without an end is torn.

        Raises InputError: the rows are not of these columns and these models.
        """

        def refused(what: str) -> InputError:
            return InputError(f"{path}: {what}: move it away, or give another folder with OUT=")

        complete = content[: content.rfind(b"\n") + 1]
        if not complete and line(self.header).startswith(content):
            return {}, 0
        try:
            lines = [*csv.reader(io.StringIO(complete.decode()), strict=True)]
        except (UnicodeDecodeError, csv.Error) as error:
            raise refused(f"not a readable table ({error})") from error
        if lines[:1] != [self.header]:
            raise refused("its columns are not those of this version")
        rows = {}
        for number, cells in enumerate(lines[1:], start=2):
            if len(cells) != len(self.header):
                raise refused(f"line {number} has {len(cells)} cells in place of {len(self.header)}")
            if cells[self.header.index("models")] != self.models:
                raise refused(f"line {number} was measured with another version of the models")
            try:
                row = _row(self.row, cells)
            except ValueError as error:
                raise refused(f"line {number} is not readable ({error})") from error
            rows[point_of(self.point, row)] = row
        return rows, len(complete)

    @contextlib.contextmanager
    def opened(self, folder: Path) -> Iterator[tuple[BinaryIO, dict[P, R]]]:
        """Yield the table in a folder, open to append, and its rows; one study at a time. Raises InputError."""
        path = folder / f"{self.name}.csv"
        files.make(folder, [path.name], guarded=False)  # `kept` refuses the tables of others
        with path.open("a+b") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise InputError(
                    f"{path}: another {self.name} is writing it: wait for it, or give another OUT="
                ) from error
            file.seek(0)
            content = file.read()
            rows, length = self.kept(path, content)
            if length < len(content):  # removes a line that a crash cut off
                file.truncate(length)
            if not length:
                _append(file, self.header)
            yield file, rows

    def seconds_left(self, points: Sequence[P], folder: Path) -> float:
        """Return the time that the points take which the table in `folder` lacks, on the cores of this machine."""
        path = folder / f"{self.name}.csv"
        done: Mapping[P, R] = {}
        with contextlib.suppress(InputError):  # `complete` refuses it
            done, _ = self.kept(path, path.read_bytes() if path.is_file() else b"")
        return self._seconds(point for point in points if point not in done)

    def _seconds(self, points: Iterable[P], cores: int = 0) -> float:
        return self.seconds * sum(point.pixels for point in points) / (cores or joblib.cpu_count())

    def complete(self, points: Sequence[P], folder: Path, scheduler: str | None = None) -> list[R]:
        """Measure the points that the table in `folder` lacks; return the rows of all in the order of `points`.

        Raises InputError or RuntimeError; rows measured are kept.
        """
        with contextlib.ExitStack() as stack:
            client = stack.enter_context(cluster(scheduler)) if scheduler else None
            file, done = stack.enter_context(self.opened(folder))
            left = [point for point in points if point not in done]
            if len(left) < len(points):
                there = os.path.relpath(file.name)
                print(f"{len(points) - len(left)} of {len(points)} rows are there already: {there}")
            work = sum(point.pixels for point in left)
            cores = sum(client.ncores().values()) if client else joblib.cpu_count()
            print(f"{len(left)} rows to measure: about {duration(self._seconds(left, cores))} on {cores} cores")
            shape = "{percentage:3.0f}%|{bar}| {postfix} [{elapsed} < {remaining}]"
            bar = stack.enter_context(progress_bar(total=work, bar_format=shape))
            fresh = on_cluster(client, self.cells, left) if client else on_all_cores(self.cells, left)
            for count, cells in enumerate(stack.enter_context(contextlib.closing(fresh)), start=1):
                _append(file, cells)
                row = _row(self.row, cells)
                done[point_of(self.point, row)] = row
                bar.set_postfix_str(f"{count} of {len(left)} rows", refresh=False)
                bar.update(row.pixels)
        return [done[point] for point in points]


def _append(file: BinaryIO, cells: Cells) -> None:
    """Write a line to the disk."""
    file.write(line(cells))
    file.flush()
    os.fsync(file.fileno())


def on_all_cores(measure: Measure[P], points: Sequence[P]) -> Generator[Cells]:
    """Yield the rows in the order in which they are finished."""
    parallel = joblib.Parallel(n_jobs=-1, return_as="generator_unordered", batch_size=1)
    yield from parallel(joblib.delayed(measure)(point) for point in points)


@contextlib.contextmanager
def cluster(address: str) -> Iterator[Any]:
    """Return a client of the Dask cluster at host:port, which must have workers. Raises InputError."""
    if not re.fullmatch(r"(tcp://)?[\w.\-]+:\d{1,5}", address):
        raise InputError(f"DASK_SCHEDULER={address}: accepted is host:port")
    try:
        import dask.distributed as dask  # only this function needs it
    except ImportError as error:
        raise InputError(f"DASK_SCHEDULER={address}: Dask is not installed: run `make setup`") from error
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # its messages repeat those of this command
    try:
        client = dask.Client(address, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise InputError(f"DASK_SCHEDULER={address}: no scheduler answers there: start one, or leave it out") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKERS_S)
        except TimeoutError as error:
            raise InputError(f"DASK_SCHEDULER={address}: it has no workers: start some with `dask worker`") from error
        yield client


def _on_worker(measure: Measure[P], version: str, point: P) -> Cells:
    if version != VERSION:
        raise InputError("DASK_SCHEDULER: a worker keeps another version of the models: restart the workers")
    return measure(point)


def on_cluster(client: Any, measure: Measure[P], points: Sequence[P]) -> Generator[Cells]:
    """Yield the rows from the workers of a cluster, which run in clones of this commit.

    The backend of joblib for Dask would return an exception as a row when the cluster fails, and send no work to
    workers that join later.

    Raises InputError: workers keep another version of the models; RuntimeError: the cluster failed on the way.
    """
    from dask.distributed import as_completed

    try:
        futures = client.map(partial(_on_worker, measure, VERSION), points, pure=False)
        for _, cells in as_completed(futures, with_results=True):
            yield cells
    except InputError:
        raise
    except Exception as error:  # a remote machine can fail in any way
        what = " ".join(f"{type(error).__name__} {error}".split())
        raise RuntimeError(f"DASK_SCHEDULER: the cluster failed ({what}); what it measured is kept") from error
