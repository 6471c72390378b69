# SPDX-License-Identifier: Apache-2.0
"""`make regress`: all tests that `make test` samples, and a table of them. Exit status 1 if anything failed.

Parts, chosen with PARTS=a,b: `faults` (tests/test_faults.py, the full product), `codes` (RTL against model in bulk),
`power_ups` (the quick tests of every core and of the top from 100 random states), `seeds` (every test of RTL with
another seed, of single cores on Icarus, and all tests that are too long for `make test`). JOBS is the number of
processes, 2 by default.
"""

import json
import os
import re
import resource
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from tqdm import tqdm

from commands.common import markdown, repository, variables
from commands.run import bench
from tactile_depth import files
from tactile_depth.built_in import synthetic
from tactile_depth.common.td_round_saturate import Monitor
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.scenes import SCENES, render
from tactile_depth.tactile_depth import tactile_depth

ROOT = repository.ROOT
POWER_UPS = 100
SEEDS = (2,)
SEEDED = "seeds or regress"  # markers of tests/conftest.py
CODES = 5_000_000  # codes of each job of `codes`, rounded up to whole frames
MODEL_PIXELS = 1 << 20  # pixels that go through the models at a time
SCENES_RENDERED = 160  # most scenes of a job
BAR = "{desc}: {percentage:.0f} % [{elapsed}]{postfix}"


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
    bench.build(job.simulator, config)
    began = time.monotonic()
    with files.temporary() as folder:
        played = bench.play(
            job.simulator,
            config,
            calibration,
            np.concatenate([np.array(profiles, np.uint32), bench.frame_entries(frames)]),
            folder,
            clocks=int(3 * (count + 4) * pixels / (1 - job.gaps) / (1 - job.stalls)),
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


@dataclass
class Part:
    """Result of a part."""

    name: str
    lines: list[dict[str, Any]] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0


def pytest_part(part: Part, bar: tqdm, jobs: int, arguments: list[str], environment: dict[str, str]) -> None:
    """Run tests; their records become the lines of the part."""
    with files.temporary() as folder:
        records = folder / "records.jsonl"
        options = ["-vv", "--timeout=3600", "-n", str(jobs), "--dist", "worksteal", f"--basetemp={folder}/tests"]
        command = [sys.executable, "-m", "pytest", *options, *arguments]
        process = subprocess.Popen(
            command,
            cwd=ROOT,
            env={**os.environ, **environment, "RECORDS": str(records)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert process.stdout is not None
        tail: list[str] = []
        for line in process.stdout:
            tail = [*tail[-200:], line.rstrip()]
            if match := re.search(r"\[ *(\d+)%\] (\w+) (\S+)", line):
                bar.update(int(match[1]) - bar.n)
                bar.set_postfix_str(match[3])
                if match[2] != "PASSED":
                    part.failures.append(f"{match[2]} {match[3]}")
        if process.wait() and not part.failures:
            part.failures.append("pytest: " + " | ".join(tail[-3:]))
        if part.failures:
            log = ROOT / "build" / f"regress-{part.name}.log"
            log.write_text("\n".join(tail))
            part.failures.append(f"see {log}")
        if records.exists():
            part.lines += [json.loads(line) for line in records.read_text().splitlines()]


def faults(part: Part, bar: tqdm, jobs: int) -> None:
    pytest_part(part, bar, jobs, ["tests/test_faults.py"], {"REGRESS": "1"})


def power_ups(part: Part, bar: tqdm, jobs: int) -> None:
    pytest_part(part, bar, jobs, ["tests"], {"POWER_UPS": str(POWER_UPS), "ONLY": "power_ups"})


def seeds(part: Part, bar: tqdm, jobs: int) -> None:
    for seed in SEEDS:
        began = time.monotonic()
        before = len(part.failures)
        environment = {"SEED": str(seed), "POWER_UPS": "1", "REGRESS": "1"}
        pytest_part(part, bar, jobs, ["tests", "--ignore=tests/test_faults.py", "-m", SEEDED], environment)
        line = {"part": part.name, "what": f"SEED={seed}", "simulator": "both", "runs": 1}
        part.lines.append(line | {"failed": len(part.failures) - before, "seconds": time.monotonic() - began})


def codes(part: Part, bar: tqdm, jobs: int) -> None:
    largest_first = sorted(JOBS, key=lambda job: -job.columns * (1 + (job.simulator == "icarus") * 64))
    with ProcessPoolExecutor(jobs) as pool:
        waiting = {pool.submit(compare, job, 1 + index): job for index, job in enumerate(largest_first)}
        for future in as_completed(waiting):
            try:
                part.lines.append(future.result())
            except Exception as error:  # a failed job must not hide the others
                part.failures.append(f"{waiting[future].label}: {error}")
            bar.update(100 / len(JOBS))
            bar.set_postfix_str(waiting[future].label)


PARTS: dict[str, Callable[[Part, tqdm, int], None]] = {
    "faults": faults,
    "codes": codes,
    "power_ups": power_ups,
    "seeds": seeds,
}


def table(parts: list[Part]) -> str:
    """Return a table with a row for each line of a part, and the sum of the part below."""
    rows, failures = [], []
    for part in parts:
        sums = np.zeros(3, int)
        for line in part.lines:
            runs = line.get("cases", line.get("runs", line.get("frames", 1)))
            figures = np.array([runs, line.get("codes", 0), line.get("different", 0)])
            sums += figures
            cells = (*(f"{figure:,}" for figure in figures), f"{line['seconds']:.0f}")
            rows.append((part.name, line["what"], line["simulator"], *cells))
        verdict = f"= {len(part.failures)} FAILED" if part.failures else "= all passed"
        rows.append((part.name, verdict, "", *(f"{figure:,}" for figure in sums), f"{part.seconds:.0f}"))
        failures += [f"    {part.name}: {failure}" for failure in part.failures]
    head = ("part", "what", "simulator", "runs", "codes", "different", "seconds")
    return "\n".join([markdown.table(head, rows), *failures])


def matrix(part: Part) -> str:
    """Return the table of the number of faults of each kind on each device."""
    counts: dict[str, Counter[str]] = {}
    for line in part.lines:
        for kind, number in line.get("kinds", {}).items():
            counts.setdefault(kind, Counter())[f"{line['grid']} {line['simulator']}"] += number
    devices = sorted({device for row in counts.values() for device in row})
    rows = [(device, *(f"{row[device]:,}" for row in counts.values())) for device in devices]
    return markdown.table(("device", *counts), rows)


def main() -> None:
    with variables.reported("regress"):
        values = variables.given(sys.argv[1:], ("PARTS", "JOBS"))
        names = values.get("PARTS", ",".join(PARTS)).split(",")
        jobs = variables.number(values, "JOBS", 2, 1, 1000)
        if not PARTS.keys() >= set(names):
            raise InputError(f"PARTS={values['PARTS']}: accepted are {', '.join(PARTS)}")
        sys.exit(run(names, jobs))


def run(names: list[str], jobs: int) -> int:
    """Run the parts and print their table; return the exit status."""
    parts = []
    for name in names:
        part = Part(name)
        began = time.monotonic()
        with tqdm(total=100, desc=name, leave=False, disable=None, bar_format=BAR) as bar:
            PARTS[name](part, bar, jobs)
        part.seconds = time.monotonic() - began
        part.failures += [f"{line['what']}: {line}" for line in part.lines if line.get("failed")]
        parts.append(part)
        print(f"{name}: {part.seconds:.0f} s, {len(part.failures) or 'nothing'} failed", flush=True)
    report = ROOT / "build" / "regress.json"
    report.parent.mkdir(exist_ok=True)
    report.write_text(json.dumps([asdict(part) for part in parts], indent=1) + "\n")
    print(f"\n{table(parts)}")
    for part in parts:
        if part.name == "faults":
            print(f"\n{matrix(part)}")
    compared = sum(line.get("codes", 0) for part in parts for line in part.lines)
    used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    failed = sum(len(part.failures) for part in parts)
    total = sum(part.seconds for part in parts)
    print(f"\n{compared:,} codes compared; {total / 60:.1f} minutes, {used / 60:.1f} of processor; {failed} failed")
    return variables.MISMATCH if failed else variables.EQUAL
