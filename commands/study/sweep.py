# SPDX-License-Identifier: Apache-2.0
"""`make sweep`: accuracy against latency, multipliers and memory, by the bit-accurate models, into one CSV.

Takes OUT=folder and DASK_SCHEDULER=host:port. Each row is written to the disk before the next begins, so an interrupted
sweep continues where it stopped. Exit status: 0 complete, 2 bad input, 130 interrupted.
"""

import contextlib
import logging
import os
import re
import sys
from collections.abc import Generator, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import joblib

from commands.common import published, tabular, variables
from commands.common.repository import ROOT
from commands.study.accuracy import CONFIGURATION, MEASURED, VERSION, WORST, configuration_cells, measure
from commands.study.rows import Row, Table, Wanted
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import COEFFICIENT, DEFAULT_WIDTHS, SOLVER_WIDTHS, STORED, WIDTHS, Configuration
from tactile_depth.chip.limits import COLUMNS, most_lanes

DEFAULT_OUT = ROOT / "build" / "sweep"
GRIDS = (32, 64, 128, 256, 512)
LANE_GRIDS = (128, 256)  # on both the tridiagonal solver can have the most lanes
ACCEPTED = ("OUT", "DASK_SCHEDULER")
TABLE = Table("sweep", CONFIGURATION, MEASURED, VERSION)
WORD = WIDTHS[STORED].variable
SAFE, SAFE_WORD = {"depth_range_px": WORST}, "DEPTH_RANGE=worst"
CONNECT_S, WORKERS_S = 10, 60  # wait for a cluster, and for its first worker

Choices = dict[str, Any]


def plan() -> list[Choices]:
    """Return every configuration of the sweep, as the arguments of `Configuration` that differ from the default.

    The sweep varies grid, boundary and the two widths one at a time, then both widths together, the depth range that no
    slopes exceed (DEPTH_RANGE=worst) with each data width and both boundaries, and the lanes at the grids of
    LANE_GRIDS. The widest grids come first, so that all cores finish at about the same time.
    """
    default = Configuration()
    widths = [range(low, high + 1) for low, high in (width.accepted for width in SOLVER_WIDTHS.values())]
    rows: list[Choices] = []
    for solver in COLUMNS:
        for columns in sorted(GRIDS, reverse=True):
            if columns != default.columns:
                rows.append({"solver": solver, "columns": columns})
        rows.append({"solver": solver, "neumann": True})
        for data in widths[0]:
            rows += [{"solver": solver, STORED: data, COEFFICIENT: c} for c in widths[1]]
            rows.append({"solver": solver, STORED: data} | SAFE)
        rows.append({"solver": solver, "neumann": True} | SAFE)
    for columns in LANE_GRIDS:
        grid = {"solver": "tridiagonal"} | ({"columns": columns} if columns != default.columns else {})
        rows += [grid | {"lanes": lanes} for lanes in lane_counts(columns)[1:]]
    return sorted(rows, key=pixels, reverse=True)


def lane_counts(columns: int) -> list[int]:
    """Return every number of lanes that a tridiagonal solver of so many columns can have: 1, 2, 4, .."""
    return [1 << log2 for log2 in range(most_lanes(columns).bit_length())]


def pixels(choices: Choices) -> int:
    """Return the pixels of a frame; the time of a configuration grows with them."""
    return int(choices.get("columns", Configuration().columns)) ** 2


def on_all_cores(rows: list[Choices]) -> Generator[Row]:
    """Yield the rows in the order in which they are finished."""
    parallel = joblib.Parallel(n_jobs=-1, return_as="generator_unordered", batch_size=1)
    yield from parallel(joblib.delayed(measure)(row) for row in rows)


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


def on_cluster(client: Any, rows: list[Choices]) -> Generator[Row]:
    """Yield the rows from the workers of a cluster, which run in clones of this commit.

    Raises InputError: workers keep another version of the models; RuntimeError: the cluster failed on the way.
    """
    from dask.distributed import as_completed

    try:
        futures = client.map(measure, rows, pure=False)
        for _, row in as_completed(futures, with_results=True):
            if row["models"] != VERSION:
                raise InputError("DASK_SCHEDULER: a worker keeps another version of the models: restart the workers")
            yield row
    except InputError:
        raise
    except Exception as error:  # a remote machine can fail in any way
        what = " ".join(f"{type(error).__name__} {error}".split())
        raise RuntimeError(f"DASK_SCHEDULER: the cluster failed ({what}); what it measured is kept") from error


def sweep(rows: list[Choices], folder: Path, scheduler: str | None = None) -> list[Row]:
    """Measure the rows that the table in `folder` lacks; return all of them in the order of `rows`.

    Raises InputError or RuntimeError; rows measured before are kept.
    """
    with cluster(scheduler) if scheduler else contextlib.nullcontext() as client:
        wanted = [Wanted(configuration_cells(choices), choices, pixels(choices)) for choices in rows]
        return TABLE.complete(wanted, folder, partial(on_cluster, client) if client else on_all_cores)


def like(rows: Sequence[Row], choices: Choices, *varied: str) -> list[Row]:
    """Return the rows that can be built and differ from a configuration in the columns `varied` alone."""
    wanted = configuration_cells(choices)
    same = [name for name in CONFIGURATION if name not in varied]
    return [row for row in rows if not row["problem"] and all(row[name] == wanted[name] for name in same)]


def with_lanes(rows: Sequence[Row], columns: int) -> list[Row]:
    """Return the rows that differ in their lanes alone, by rising number of lanes."""
    alike = like(rows, {"solver": "tridiagonal", "columns": columns}, "lanes")
    return sorted(alike, key=lambda row: int(row["lanes"]))


def cost_of_worst(rows: list[Row], solver: str) -> list[str]:
    """Return the loss of accuracy with a depth range that no slopes exceed, and the word length that compensates it."""
    default, worst = (
        {int(row[STORED]): float(row["rms_percent_mean"]) for row in like(rows, {"solver": solver} | chosen, STORED)}
        for chosen in ({}, SAFE)
    )
    width = DEFAULT_WIDTHS[STORED]
    if width not in default or width not in worst:
        return []
    line = f"{solver}: {SAFE_WORD}, {worst[width]:.4f} % in place of {default[width]:.4f} %"
    enough = [wide for wide, error in worst.items() if error <= default[width]]
    return [f"{line}; as good again with {WORD}={min(enough)}" if enough else f"{line}; no words are as good"]


def area(row: Row) -> tuple[str, str]:
    return row["multipliers"], f"{int(row['memory_bits']) / 1e6:.2f}"


def summary(rows: list[Row]) -> str:
    """Return a line for each solver, boundary and number of lanes, and the narrowest sufficient words."""
    by_solver, by_lanes = [], []
    for row in like(rows, {}, "solver", "boundary"):
        rms = [f"{float(row[f'rms_percent_{name}']):.4f}" for name in ("mean", "worst")]
        by_solver.append(
            (f"{row['solver']}, {row['boundary']}", *rms, f"{int(row['first_depth_cycles']):,}", *area(row))
        )
    for columns in LANE_GRIDS:
        for row in with_lanes(rows, columns):
            cycles = [f"{int(row[f'last_pixel_to_{name}_depth_cycles']):,}" for name in ("first", "last")]
            by_lanes.append((f"{columns} x {columns}, {row['lanes']}", *cycles, *area(row)))
    costs = ("multipliers", "Mbit")
    lines = [str(tabular.Table(("solver, boundary", "mean RMS, % of peak", "worst", "cycles", *costs), by_solver))]
    for solver in COLUMNS:
        same = like(rows, {"solver": solver}, STORED)
        narrow = [int(row[STORED]) for row in same if float(row["rms_percent_mean"]) <= published.RMS_PERCENT]
        if narrow:
            lines.append(f"{solver}: mean RMS at most {published.RMS_PERCENT} % from {WORD}={min(narrow)}")
        lines += cost_of_worst(rows, solver)
    if by_lanes:
        lines.append(
            str(tabular.Table(("lanes", "last pixel to first depth, cycles", "to last depth", *costs), by_lanes))
        )
    refused = sum(bool(row["problem"]) for row in rows)
    lines.append(f"{len(rows)} rows, {refused} of them of configurations that cannot be built")
    return "\n".join(lines)


def main() -> None:
    with variables.reported("sweep", "every row measured is kept, run it again to go on"):
        values = variables.given(sys.argv[1:], ACCEPTED)
        folder = Path(values.get("OUT", DEFAULT_OUT))
        rows = sweep(plan(), folder, values.get("DASK_SCHEDULER"))
    print(summary(rows))
    print(f"results: {os.path.relpath(folder / 'sweep.csv')}")
