# SPDX-License-Identifier: Apache-2.0
"""Throughput of software: frames per second of a batch, on one core and on all, apart from the latency of one frame.

Each core gets a process of its own with one thread, and solves the frames of its batch one after the other: frames do
not wait for each other, so this is faster than all threads in one frame. All processes begin together.
"""

import math
import multiprocessing
import os
import time
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Barrier
from typing import Any

import numpy as np

from commands.study.baseline_methods import METHODS, Solve

WARM_UPS, FEWEST_RUNS = 100, 10
SECONDS = 1.0  # of solves in a batch
PATIENCE_S = 100.0  # for a process to prepare its method, or to end its batch


def timed(
    solve: Solve,
    inputs: Sequence[Any],
    runs: int,
    wait: Callable[[], None] | None = None,
    end: float = math.inf,
) -> list[float]:
    """Return the times in us of `runs` solves, or of those before the end, at least FEWEST_RUNS.

    `wait` waits for a device.
    """
    wait = wait or (lambda: None)
    times: list[float] = []
    while len(times) < runs and (time.monotonic() < end or len(times) < FEWEST_RUNS):
        one = inputs[len(times) % len(inputs)]
        wait()
        begin = time.perf_counter_ns()
        solve(one)
        wait()
        times.append((time.perf_counter_ns() - begin) / 1000)
    return times


def solve_batch(number: int, frames: np.ndarray, runs: int, core: int, ready: Barrier, rates: "Queue[float]") -> None:
    """Put the frames per second of `runs` solves by METHODS[number] on a core into `rates`."""
    os.sched_setaffinity(0, [core])
    prepared = METHODS[number].prepare(frames.shape[1], 1)
    inputs = [prepared.give(frame) for frame in frames]
    clock = prepared.clock or partial(timed, prepared.solve)
    clock(inputs, WARM_UPS)
    ready.wait(PATIENCE_S)
    rates.put(1e6 * runs / sum(clock(inputs, runs)))


def frames_per_second(number: int, frames: np.ndarray, solve_us: float, cores: Sequence[int]) -> float:
    """Return the frames per second of a method on cores that work at the same time.

    `solve_us` is about the time of a solve. Raises RuntimeError: a process ended without a result.
    """
    spawn = multiprocessing.get_context("spawn")
    ready, rates = spawn.Barrier(len(cores)), spawn.Queue()
    runs = max(1, round(1e6 * SECONDS / solve_us))
    processes = [spawn.Process(target=solve_batch, args=(number, frames, runs, core, ready, rates)) for core in cores]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    if any(process.exitcode for process in processes):
        raise RuntimeError(f"{METHODS[number].name}: a process ended without a result")
    return sum(rates.get() for _ in processes)


def measure(best: Sequence[dict[str, Any]], scenes: dict[int, Any]) -> list[dict[str, Any]]:
    """Return the throughput of the fastest methods, rows of baselines.json, on one core and on all."""
    cores = sorted(os.sched_getaffinity(0), reverse=True)
    names = [method.name for method in METHODS]
    rows = []
    for row in best:
        scene = scenes[row["grid"]]
        frames = scene.pixels if row["from_pixels"] else scene.divergence
        for count in sorted({1, len(cores)}):
            rate = frames_per_second(names.index(row["method"]), frames, row["p50_us"], cores[:count])
            kept = {name: row[name] for name in ("grid", "method", "from_pixels")}
            rows.append({**kept, "cores": count, "frames_per_second": rate})
    return rows
