# SPDX-License-Identifier: Apache-2.0
"""`make baselines`: the solve in software, one frame at a time, against the fixed number of cycles of the pipeline.

Every method makes the same 2-D solve (divergence in, depth out, single precision) of the same frames, the contacts of
the bench in turn: scipy, ducc0, pyFFTW and PyTorch on one core and on all, and on CUDA if there is a device, with the
frames already on it. The method of the tridiagonal solver runs on the CPU too: ducc0 along the rows and Thomas's
algorithm by numba down the columns, and on one core in C with SIMD (simd_solver.c), compiled for this machine. The C
code is timed from the pixels on, too: that is what the pipeline does.
Every result is checked by `reference` before it is timed: WARM_UPS solves, then RUNS that count, or as many
as the time allows. Each method is timed in its own process, pinned to its cores, so that no threads of another method
run.

Takes GRIDS (64,128,256,512), RUNS, CLOCK_MHZ, MAX_LOAD and OUT as KEY=VALUE arguments. Exit status: 0 done, 1 a result
is wrong, 2 bad input or a busy machine. The row of a method that is not installed says so; `make baselines` installs
requirements-baselines.txt.
"""

import gc
import importlib.metadata
import math
import multiprocessing
import os
import signal
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any
from unittest import mock

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from commands.common import published, recorded, repository
from commands.common.machine import machine
from commands.common.progress import progress_bar
from commands.common.results import save, written
from commands.common.tabular import Table
from commands.common.variables import ClockMhz, Mismatch, Place, numbers, real, whole
from commands.study import baseline_throughput
from commands.study.baseline_methods import COMPILER, METHODS, SIMD_SOLVER, missing
from commands.study.baseline_throughput import FEWEST_RUNS, WARM_UPS, timed
from tactile_depth.base.errors import Argument, InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_pixel_to_first_depth, last_pixel_to_last_depth
from tactile_depth.chip.limits import COLUMNS, most_lanes
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.depth import reference
from tactile_depth.sensor.scenes import render
from tactile_depth.sensor.synthetic import synthetic

RESULTS = ("baselines.json", "baselines.png")
DEFAULT_OUT = repository.ROOT / "build" / "baselines"
INTERRUPTED = "nothing was written"
GRIDS = (64, 128, 256, 512)
SCENE = "bench"
RUNS = 1000
QUIET_LOAD = 0.5  # of other programs, at most, before times are taken
SECONDS = 480  # for all solves together: if threads or other programs disturb each other, a solve may take 0.1
# RMS of a result to double precision in % of peak: measured at most 0.00005 (PyTorch's products of matrices at 512).
TOLERANCE_PERCENT = 0.0001
THREAD_VARIABLES = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True)
class Scene:
    """Contacts on a grid: pixels, uint8 (frames, size, size, 3), divergence, float32, and reference depth, float64."""

    pixels: np.ndarray
    divergence: np.ndarray
    depth: np.ndarray


def scene(size: int) -> Scene:
    pixels = render(SCENE, size).frames
    f = divergence(reference.slopes(pixels, synthetic())).astype(np.float32)
    return Scene(pixels, f, reference.solve(f.astype(np.float64)))


def percent_of_peak(depth: np.ndarray, wanted: np.ndarray) -> float:
    """Return the RMS difference over the whole frame, without fitted scale or offset, in % of the peak."""
    return 100 * math.sqrt(np.mean((depth - wanted) ** 2)) / float(wanted.max())


@dataclass(frozen=True)
class Job:
    """One of `METHODS`, by its number, to measure in its own process."""

    number: int
    threads: int
    scenes: dict[int, Scene]  # by grid
    runs: int
    until: float  # end of all jobs by time.monotonic; each grid may take twice its part of the time
    cells: int  # grids of this job and of all that follow


def measure(job: Job) -> list[dict[str, Any]]:
    """Check and time a method: for each grid `error_percent` of the worst frame and `times_us`, or `problem`."""
    method = METHODS[job.number]
    if method.device:
        import torch

        if not torch.cuda.is_available():
            return [{"problem": "no device"} for _ in job.scenes]
    results: list[dict[str, Any]] = []
    for index, (size, contacts) in enumerate(job.scenes.items()):
        end = time.monotonic() + 2 * (job.until - time.monotonic()) / (job.cells - index)
        prepared = method.prepare(size, job.threads)
        inputs = [prepared.give(one) for one in (contacts.pixels if method.from_pixels else contacts.divergence)]
        depths = [np.array(prepared.take(prepared.solve(one)), np.float64) for one in inputs]
        error = max(percent_of_peak(*pair) for pair in zip(depths, contacts.depth, strict=True))
        if not error <= TOLERANCE_PERCENT:
            results.append({"error_percent": error, "problem": "wrong result"})
            continue
        wait = prepared.synchronise
        gc.disable()
        half = (time.monotonic() + end) / 2
        if prepared.clock:
            times = prepared.clock(inputs, WARM_UPS) and prepared.clock(inputs, job.runs)
        else:
            solve = partial(timed, prepared.solve, inputs, wait=wait)
            times = solve(WARM_UPS, end=half) and solve(job.runs, end=end)
        gc.enable()
        results.append({"error_percent": error, "times_us": times})
    return results


def begin_process(threads: int) -> None:
    """Let a signal end this process, and pin it to as many cores as it has threads, the last ones."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-threads:])


def in_own_process(job: Job) -> list[dict[str, Any]]:
    """Run `measure` in its own process, with the threads of the job, each on a core of its own."""
    spawn = multiprocessing.get_context("spawn")
    try:
        with (
            mock.patch.dict(os.environ, dict.fromkeys(THREAD_VARIABLES, str(job.threads))),
            ProcessPoolExecutor(1, spawn, initializer=begin_process, initargs=(job.threads,)) as pool,
        ):
            return pool.submit(measure, job).result()
    except BrokenProcessPool:  # the process ended without a result
        return [{"problem": "it crashed"} for _ in job.scenes]
    except ImportError as error:
        return [{"problem": " ".join(f"cannot be loaded: {error}".split())} for _ in job.scenes]


# The pipeline, in cycles from the last pixel on, where software begins too.


def pipeline(sizes: Sequence[int], clock_mhz: float) -> list[dict[str, Any]]:
    """Return the rows of both solvers, and of the tridiagonal solver with the most lanes."""
    rows = []
    for size in sizes:
        for solver, lanes in (("spectral", 1), ("tridiagonal", 1), ("tridiagonal", most_lanes(size))):
            config = Configuration(columns=size, solver=solver, lanes=lanes)
            clocks = {"first_depth": last_pixel_to_first_depth(config), "last_depth": last_pixel_to_last_depth(config)}
            micros = {f"{name}_us": count / clock_mhz for name, count in clocks.items()}
            rows.append({"grid": size, "solver": solver, "lanes": lanes, **clocks, **micros})
    return rows


def pipeline_name(row: dict[str, Any]) -> str:
    lanes = f" with {row['lanes']} lanes" if row["lanes"] > 1 else ""
    return f"{row['solver']} pipeline{lanes}"


def _sizes(argument: Argument) -> tuple[int, ...]:
    low, high = COLUMNS["spectral"]
    grids = numbers(argument)
    if not grids or any(not low <= size <= high or size & (size - 1) for size in grids):
        raise InputError(argument, f": accepted are powers of two from {low} to {high}, as 64,128")
    return tuple(sorted(set(grids)))


@dataclass(frozen=True)
class BaselinesRun:
    """Grids, runs of each method on each, and the load of the machine beside which nothing is timed."""

    grids: Annotated[tuple[int, ...], _sizes] = GRIDS
    runs: Annotated[int, whole(FEWEST_RUNS, 1_000_000)] = RUNS
    clock_mhz: ClockMhz = published.CLOCK_MHZ
    max_load: Annotated[float, real(0, 10_000)] = QUIET_LOAD
    out: Place = DEFAULT_OUT


def summarise(row: dict[str, Any]) -> dict[str, Any]:
    """Return the row with percentiles instead of the times."""
    times = row.pop("times_us", None)
    if times is not None:
        percentiles = {f"p{share}_us": float(np.percentile(times, share)) for share in (1, 50, 99)}
        row |= {"runs": len(times), **percentiles, "max_us": max(times)}
    return row


def measure_all(request: BaselinesRun) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the content of baselines.json, and the rows with every time, for the picture.

    Raises RuntimeError: a result differs from the reference.
    """
    cores = len(os.sched_getaffinity(0))
    load = os.getloadavg()[0]
    jobs = [  # all cores last: if they are not free, that takes longest
        (number, threads)
        for threads in sorted({1, cores})
        for number, method in enumerate(METHODS)
        if threads == 1 or not (method.device or method.one_core)
    ]
    rows: list[dict[str, Any]] = []
    scenes = {size: scene(size) for size in request.grids}
    until = time.monotonic() + SECONDS
    with progress_bar(jobs) as bar:
        for done, (number, threads) in enumerate(bar):
            method = METHODS[number]
            bar.set_description(f"{method.name}, {threads} threads")
            job = Job(number, threads, scenes, request.runs, until, (len(jobs) - done) * len(scenes))
            problem = missing(method)
            results = [{"problem": problem} for _ in scenes] if problem else in_own_process(job)
            for size, one in zip(scenes, results, strict=True):
                kind = {"threads": None if method.device else threads, "from_pixels": method.from_pixels}
                rows.append({"grid": size, "method": method.name, **kind, **one})
    names = [method.name for method in METHODS]
    rows.sort(key=lambda row: names.index(row["method"]))
    wrong = [row for row in rows if row.get("problem") == "wrong result"]
    if wrong:
        row = wrong[0]
        raise Mismatch(
            f"{row['method']} at {row['grid']}, {row['threads']} threads, is {row['error_percent']:.2g} % of peak from "
            f"the reference: at most {TOLERANCE_PERCENT:g} is right"
        )
    software = [summarise(dict(row)) for row in rows]
    packages = sorted({package for method in METHODS for package in method.packages if not missing(method)})
    document = {
        "machine": machine(),
        "load_before": load,
        "packages": {package: importlib.metadata.version(package) for package in packages},
        "clock_mhz": request.clock_mhz,
        "warm_ups": WARM_UPS,
        "runs": request.runs,
        "tolerance_percent": TOLERANCE_PERCENT,
        "software": software,
        "throughput": baseline_throughput.measure(fastest(software), scenes),
        "pipeline": pipeline(request.grids, request.clock_mhz),
    }
    return document, rows


def threads_of(row: dict[str, Any]) -> str:
    return "device" if row["threads"] is None else str(row["threads"])


def times_of(row: dict[str, Any]) -> list[str]:
    """Return median, p99 and maximum of a row of software in us as text."""
    return [f"{row[key]:,.1f}" if key in row else "-" for key in ("p50_us", "p99_us", "max_us")]


def tables(document: dict[str, Any]) -> list[Table]:
    """Return a summary, throughput, and one table for each grid."""
    made = [fastest_and_pipeline(document), throughput(document)]
    head = ("from the frame's last pixel, us", "threads", "p50", "p99", "maximum", "error, % of peak")
    for size in sorted({row["grid"] for row in document["pipeline"]}):
        rows = []
        for row in document["pipeline"]:
            if row["grid"] == size:
                for what in ("first_depth", "last_depth"):
                    micros = f"{row[f'{what}_us']:.1f}"
                    name = f"{pipeline_name(row)}, {what.replace('_', ' ')}"
                    rows.append((name, f"{row[what]:,} clocks", micros, micros, micros, "-"))
        for row in document["software"]:
            if row["grid"] == size:
                error = row.get("problem") or f"{row['error_percent']:.6f}"
                if row.get("runs", document["runs"]) < document["runs"]:
                    error += f" ({row['runs']} solves)"
                rows.append((row["method"], threads_of(row), *times_of(row), error))
        made.append(Table(head, rows, f"{size} x {size}"))
    return made


def fastest(software: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return for each grid the row of the least median of the methods from the divergence, and of those from pixels."""
    with_times = [row for row in software if "p50_us" in row]
    groups = [
        [row for row in with_times if row["grid"] == size and row["from_pixels"] == from_pixels]
        for size in sorted({row["grid"] for row in with_times})
        for from_pixels in (False, True)
    ]
    return [min(group, key=lambda row: row["p50_us"]) for group in groups if group]


def fastest_and_pipeline(document: dict[str, Any]) -> Table:
    """Return a table with a line per grid and place where software begins."""
    rows = []
    for best in fastest(document["software"]):
        ours = [
            f"{row['first_depth_us']:,.1f} / {row['last_depth_us']:,.1f}"
            + (f" ({row['lanes']} lanes)" if row["lanes"] > 1 else "")
            for row in document["pipeline"]
            if row["grid"] == best["grid"]
        ]
        name = f"{best['method']}, {threads_of(best)}"
        rows.append((f"{best['grid']} x {best['grid']}", begins(best), name, *times_of(best), *ours))
    columns = (*(f"{solver} pipeline" for solver in COLUMNS), "tridiagonal pipeline with the most lanes")
    pipelines = (f"{column}: first depth / whole map" for column in columns)
    head = ("us after the last pixel", "software from", "fastest, threads", "p50", "p99", "maximum", *pipelines)
    return Table(head, rows, "In short")


def throughput(document: dict[str, Any]) -> Table:
    """Return the table of frames per second: software on one core and on all, and the pipeline.

    The pipeline takes one pixel per clock whatever its lanes are. Software that was not measured has "-".
    """
    rates = {
        (row["grid"], row["from_pixels"], row["cores"]): row["frames_per_second"] for row in document["throughput"]
    }
    most = max((cores for *_, cores in rates), default=2)
    rows = []
    for best in fastest(document["software"]):
        size, from_pixels = best["grid"], best["from_pixels"]
        ours = 1e6 * document["clock_mhz"] / size**2
        measured = [rates.get((size, from_pixels, cores)) for cores in (1, most)]
        each = [f"{rate:,.0f} ({rate / ours:.1f} times)" if rate else "-" for rate in measured]
        alone = f"{1e6 / best['p50_us']:,.0f}"
        rows.append((f"{size} x {size}", begins(best), best["method"], alone, *each, f"{ours:,.0f}"))
    batches = ("in batches, one thread (of the pipeline's)", f"in batches, {most} threads (of the pipeline's)")
    head = ("frames per second", "software from", "fastest", "1 / median latency", *batches, "pipeline")
    return Table(head, rows, "Throughput")


def begins(row: dict[str, Any]) -> str:
    return "pixels" if row["from_pixels"] else "divergence"


def sentences(document: dict[str, Any]) -> list[str]:
    """Return sentences that compare the fastest software with the pipeline: for each grid and place to begin."""

    def place(micros: float, row: dict[str, Any]) -> str:
        if micros > row["max_us"]:
            return "after its maximum: software is faster"
        if micros > row["p99_us"]:
            return "after its p99 but not its maximum: software is faster in 99 of 100 solves, not in all"
        if micros > row["p50_us"]:
            return "after its median but not its p99"
        return f"before its median, {row['p50_us'] / micros:.1f} times as early"

    lines = []
    for best in fastest(document["software"]):
        size = best["grid"]
        parts = [
            f"the {what} of the {pipeline_name(row)} ({row[key]:,.1f}) comes {place(row[key], best)}"
            for row in document["pipeline"]
            if row["grid"] == size
            for what, key in (("whole map", "last_depth_us"), ("first depth", "first_depth_us"))
        ]
        name = f"{best['method']} ({threads_of(best)} thread{'' if best['threads'] == 1 else 's'})"
        lines.append(
            f"{size} x {size}, us: the fastest software from the {begins(best)} on, {name}, takes "
            f"{best['p50_us']:,.1f}, p99 {best['p99_us']:,.1f}, maximum {best['max_us']:,.1f}; {'; '.join(parts)}"
        )
    return lines


def setting(document: dict[str, Any]) -> str:
    packages = ", ".join(f"{name} {version}" for name, version in document["packages"].items())
    return (
        f"{document['machine']} (load {document['load_before']:.1f} before); {packages}; {document['warm_ups']} "
        f"warm-ups and {document['runs']:,} solves timed, one frame at a time, float32; pipeline at "
        f"{document['clock_mhz']:g} MHz. Software begins with the divergence in memory and ends with the map in "
        "memory; the pipeline begins with the pixels and ends with the map on its output"
    )


def plot(path: Path, document: dict[str, Any], rows: Sequence[dict[str, Any]]) -> None:
    """Draw every solve, a row for each method, and the two fixed times of the pipeline as lines."""
    sizes = sorted({row["grid"] for row in document["pipeline"]})
    names = list(dict.fromkeys((row["method"], threads_of(row)) for row in rows if "times_us" in row))
    across = min(2, len(sizes))
    down = -(-len(sizes) // across)
    shape = (6.6 * across, 1.2 + down * (0.9 + 0.24 * len(names)))
    figure = Figure(figsize=shape, layout="constrained")
    axes = figure.subplots(down, across, squeeze=False, sharey=True)
    jitter = np.random.default_rng(0)
    colours = {"spectral": "#08306b", "tridiagonal": "#e6550d"}
    for axis, size in zip(axes.flat, sizes, strict=False):
        for row in rows:
            if row["grid"] != size or "times_us" not in row:
                continue
            place = names.index((row["method"], threads_of(row)))
            times = np.array(row["times_us"])
            at = place + jitter.uniform(-0.3, 0.3, len(times))
            axis.scatter(times, at, s=2, color="0.6", linewidths=0, rasterized=True)
            for value, marker in zip(np.percentile(times, (50, 99, 100)), ("|", "d", ">"), strict=True):
                look = {"markersize": 11 if marker == "|" else 4, "markeredgewidth": 1.5, "linestyle": "none"}
                axis.plot([value], [place], color="black", marker=marker, **look)
        for row in document["pipeline"]:
            if row["grid"] == size:
                colour, style = colours[row["solver"]], ":" if row["lanes"] > 1 else "-"
                label = f"{row['solver']} pipeline" + (" with the most lanes" if row["lanes"] > 1 else "")
                axis.axvline(row["last_depth_us"], color=colour, linestyle=style, label=f"{label}, whole map")
                thin: dict[str, Any] = {"color": colour, "linestyle": style, "linewidth": 0.8, "alpha": 0.6}
                axis.axvline(row["first_depth_us"], label=f"{label}, first depth", **thin)
        axis.set(xscale="log", title=f"{size} x {size}")
        axis.grid(axis="x", alpha=0.3)
    for axis in axes.flat[len(sizes) :]:
        axis.set_axis_off()
    for axis in axes[-1]:
        axis.set_xlabel("us after the frame's last pixel")
    for axis in axes[:, 0]:
        axis.set_yticks(range(len(names)), [f"{name}, {threads}" for name, threads in names], fontsize=8)
    axes[0, 0].invert_yaxis()
    marks = [
        Line2D([], [], color="black", linestyle="none", marker=marker, label=label, markersize=size)
        for marker, label, size in (("|", "p50", 9), ("d", "p99", 4), (">", "maximum", 4))
    ]
    handles, _ = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles=[*handles, *marks], loc="outside lower center", ncols=4, fontsize=8)
    figure.savefig(path, dpi=110)


def show(document: dict[str, Any]) -> str:
    return "\n\n".join([setting(document), *map(str, tables(document)), "\n".join(sentences(document))])


def run(request: BaselinesRun) -> dict[str, Any]:
    """Measure, print, write baselines.json and baselines.png, both or none of them, and return the first.

    Raises InputError, Mismatch or RuntimeError; InputError on a busy machine.
    """
    with written(request.out, RESULTS) as work:
        if (load := os.getloadavg()[0]) > request.max_load:
            raise InputError(
                f"other programs are running: a load of {load:.2g} in the last minute, at most {request.max_load:g} "
                f"gives times that can be compared: end them, or give MAX_LOAD={math.ceil(load)}"
            )
        document, rows = measure_all(request)
        print(show(document))
        save(work / "baselines.json", document)
        plot(work / "baselines.png", document, rows)
    return document


def sources(_: Sequence[str]) -> str:
    """Return the digest of the code of this repository that is timed."""
    return recorded.digest([SIMD_SOLVER], COMPILER)


def recordable(document: dict[str, Any]) -> dict[str, Any]:
    """Return what docs/figures.json keeps: setting, throughput, and the times of methods that ran."""
    kept = ("grid", "method", "threads", "from_pixels", "error_percent", "p50_us", "p99_us", "max_us")
    software = [{name: row[name] for name in kept} for row in document["software"] if "p50_us" in row]
    left_out = ("tolerance_percent", "pipeline")  # the pages have the cycles of the present RTL
    return {name: value for name, value in document.items() if name not in left_out} | {"software": software}


def main(request: BaselinesRun) -> None:
    recorded.record(recordable(run(request)))
