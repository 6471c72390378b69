# SPDX-License-Identifier: Apache-2.0
"""Codes in bulk: RTL against model on millions of codes of many configurations, in `make regress`."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from commands.run import bench
from tactile_depth.base import files
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.sensor.scenes import SCENES, render
from tactile_depth.sensor.synthetic import synthetic

CODES = 5_000_000  # codes of each job, rounded up to whole frames
MODEL_PIXELS = 1 << 20  # pixels that go through the models at a time
SCENES_RENDERED = 160  # most scenes of a job


@dataclass(frozen=True)
class Job:
    """Device and its disturbances."""

    columns: int
    solver: str
    neumann: bool
    data_width: int = 24
    coefficient_width: int = 18
    rows: int = 0
    gaps: float = 0.0
    stalls: float = 0.0
    depth_share: float = 0.25  # depth range as a fraction of the shorter side
    simulator: str = "verilator"
    codes: int = CODES
    lanes: int = 1

    @property
    def label(self) -> str:
        boundary = "neumann" if self.neumann else "dirichlet"
        disturbed = f"{' gaps' * bool(self.gaps)}{' stalls' * bool(self.stalls)}"
        shape = f"{self.rows or self.columns}x{self.columns}{f'/{self.lanes}' * (self.lanes > 1)}"
        return f"{self.solver} {boundary} {shape} {self.data_width}/{self.coefficient_width}{disturbed}"


# Pairs of solver, boundary, size, word length and disturbance, each at least once.
JOBS = (
    Job(16, "spectral", False),
    Job(16, "spectral", True, 27, 18, gaps=0.2, stalls=0.3),
    Job(16, "tridiagonal", False, 20, 16, stalls=0.3),
    Job(16, "tridiagonal", True, 24, 18, rows=8, gaps=0.3),
    Job(16, "tridiagonal", True, 27, 20, rows=21),
    Job(32, "spectral", False, 12, 10, gaps=0.1, stalls=0.1),
    Job(32, "tridiagonal", True, 16, 14),
    Job(64, "spectral", True, 18, 16, stalls=0.2),
    Job(64, "spectral", False, 32, 24, depth_share=0.05),
    Job(64, "tridiagonal", False, 32, 24, gaps=0.2),
    Job(64, "tridiagonal", True, 20, 18, depth_share=0.05, stalls=0.2),
    Job(128, "spectral", False),
    Job(128, "spectral", True),
    Job(128, "tridiagonal", False),
    Job(128, "tridiagonal", True),
    Job(128, "spectral", False, 27, 18, gaps=0.2),
    Job(128, "tridiagonal", True, 27, 18, stalls=0.2),
    Job(256, "spectral", False, 24, 18, stalls=0.1),
    Job(256, "spectral", True, 27, 20),
    Job(256, "tridiagonal", False, 27, 18, gaps=0.1),
    Job(256, "tridiagonal", True, 24, 18, rows=240),
    Job(512, "tridiagonal", False),
    Job(1024, "tridiagonal", True, 27, 18),
    Job(32, "tridiagonal", True, rows=9, lanes=4, gaps=0.2, stalls=0.3),
    Job(64, "tridiagonal", False, rows=50, lanes=8, stalls=0.2),
    Job(128, "tridiagonal", True, lanes=16),
    Job(128, "tridiagonal", False, rows=100, lanes=32, gaps=0.1, stalls=0.1),
    Job(256, "tridiagonal", False, lanes=32, gaps=0.1),
    Job(256, "tridiagonal", True, rows=99, lanes=2),
    Job(512, "tridiagonal", True, rows=101, lanes=64, gaps=0.1, stalls=0.1),
    Job(16, "spectral", False, simulator="icarus", codes=60_000),
    Job(16, "tridiagonal", True, rows=8, simulator="icarus", codes=60_000),
    Job(16, "tridiagonal", False, rows=9, simulator="icarus", codes=60_000, lanes=2),
)


def frames_of(job: Job, count: int, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Yield `count` different frames, uint8 (rows, columns, 3): noise, extremes and scenes in turn."""
    shape = (job.rows or job.columns, job.columns, 3)
    names = [name for name in SCENES if name != "flat"]
    scenes: list[np.ndarray] = []
    rendered = 0
    for index in range(count):
        match index % 4:
            case 0:  # noise of every amplitude around every colour
                spread = rng.integers(1, 129)
                noise = rng.integers(-spread, spread + 1, shape) + rng.integers(0, 256, 3)
                yield np.clip(noise, 0, 255).astype(np.uint8)
            case 1:  # blocks of colours at their limits
                high, wide = (int(rng.integers(1, size + 1)) for size in shape[:2])
                blocks = rng.integers(0, 2, (-(-shape[0] // high), -(-shape[1] // wide), 3))
                yield np.uint8(255) * np.kron(blocks, np.ones((high, wide, 1), int))[: shape[0], : shape[1]].astype(
                    np.uint8
                )
            case 2:  # uniform
                yield rng.integers(0, 256, shape).astype(np.uint8)
            case _:
                if not scenes and rendered < SCENES_RENDERED:
                    name, seed = names[rendered % len(names)], int(rng.integers(1 << 30))
                    scenes = list(render(name, *shape[:2], seed).frames)
                    rendered += 1
                yield scenes.pop() if scenes else rng.integers(96, 160, shape).astype(np.uint8)


def compare(job: Job, seed: int) -> dict[str, Any]:
    """Stream the frames of a job through its device; compare every code and the counters of the hardware."""
    depth = job.depth_share * min(job.rows or job.columns, job.columns)
    config = Configuration(
        columns=job.columns,
        rows=job.rows,
        solver=job.solver,
        lanes=job.lanes,
        neumann=job.neumann,
        data_width=job.data_width,
        coefficient_width=job.coefficient_width,
        depth_range_px=depth,
    )
    calibration, rng = synthetic(config.bits_per_channel), np.random.default_rng(seed)
    pixels = config.rows * config.columns
    count = max(-(-job.codes // pixels), 4)
    frames = np.stack(list(frames_of(job, count, rng)))
    profiles = [bench.entry("sink", bench.chance(job.stalls)), bench.entry("source", bench.chance(job.gaps))]
    clocks = int(3 * (count + 4) * pixels / (1 - job.gaps) / (1 - job.stalls))
    bench.build(job.simulator, config, clocks)
    began = time.monotonic()
    with files.temporary() as folder:
        played = bench.play(
            job.simulator,
            config,
            calibration,
            np.concatenate([np.array(profiles, np.uint32), bench.frame_entries(frames)]),
            folder,
            clocks=clocks,
            total_frames=count,
            seed=seed,
        )
    simulated = time.monotonic()
    monitor, batch = Monitor(), max(MODEL_PIXELS // pixels, 1)
    codes = [tactile_depth(frames[i : i + batch], calibration, config, monitor) for i in range(0, count, batch)]
    different = int((played.codes.reshape(frames.shape[:3]) != np.concatenate(codes)).sum())
    clipped = min(monitor.saturations.total(), 2**32 - 1)
    counted = {name: played.registers[name] for name in ("frames_in", "frames_out", "frames_dropped", "saturations")}
    agree = counted == {"frames_in": count, "frames_out": count, "frames_dropped": 0, "saturations": clipped}
    return {
        "part": "codes",
        "what": job.label,
        "simulator": job.simulator,
        "frames": count,
        "codes": int(played.codes.size),
        "different": different,
        "failed": int(bool(different) or not agree),
        "saturations": clipped,
        "seconds": simulated - began,
        "model_seconds": time.monotonic() - simulated,
    }


LARGEST_FIRST = sorted(JOBS, key=lambda job: -job.columns * (1 + (job.simulator == "icarus") * 64))


@pytest.mark.codes
@pytest.mark.timeout(0)  # an hour on a busy machine
@pytest.mark.parametrize(("seed", "job"), list(enumerate(LARGEST_FIRST, 1)), ids=[job.label for job in LARGEST_FIRST])
def test_rtl_has_the_codes_of_the_model(seed: int, job: Job, record_property: Callable[[str, object], None]) -> None:
    figures = compare(job, seed)
    record_property("records", [figures])
    assert not figures["failed"], figures
