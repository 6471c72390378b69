# SPDX-License-Identifier: Apache-2.0
"""`make benchmark`: time from a camera picture to depth in the models, against another commit.

A case begins with uint8 pictures of the camera in memory and ends with depth in mm, float64: area average to 128 x 128,
rounding, flat field, quadratic slopes, divergence, solve (tridiagonal, Neumann), scale. `chip` is the bit-accurate
model, `float` the reference in double precision. Tables are prepared first. The pictures are scenes of the project.

Each version runs in its own process, on one thread. The two run in turn, ROUNDS times after WARM_UPS, so that other
load on the machine affects both; each ratio is that of two neighbouring runs. The depth maps of both are compared.

Takes BEFORE (a commit, 32a97ff by default), ROUNDS and OUT as KEY=VALUE arguments. Exit status: 0 done, 1 a version
does not run, 2 bad input.
"""

import io
import json
import os
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from commands.common import markdown, variables
from commands.common.machine import machine
from commands.common.repository import ROOT, git
from commands.study import benchmark_child
from commands.study.baselines import THREAD_VARIABLES
from commands.study.benchmark_child import CASES
from tactile_depth import files
from tactile_depth.errors import InputError
from tactile_depth.scenes import Press, render

DEFAULT_OUT = ROOT / "build" / "benchmark"
FIRST = "32a97ff"  # the last commit before the models were a package
CAMERA = (240, 320)  # picture size of a GelSight Mini
SCENE, NO_CONTACT = "bench", "flat"
WARM_UPS, ROUNDS, FEWEST_ROUNDS = 5, 60, 10
SPREAD = (10, 90)  # percentiles


@dataclass(frozen=True)
class Request:
    """Values of the variables: a commit, the number of pairs of runs of each case, the folder of the results."""

    before: str
    rounds: int
    out: Path


def parse(arguments: Sequence[str]) -> Request:
    """Read KEY=VALUE arguments; an empty value means the default. Raises InputError."""
    values = variables.given(arguments, ("BEFORE", "ROUNDS", "OUT"))
    rounds = variables.number(values, "ROUNDS", ROUNDS, FEWEST_ROUNDS, 100_000)
    return Request(commit(values.get("BEFORE", FIRST)), rounds, Path(values.get("OUT", DEFAULT_OUT)))


def commit(name: str) -> str:
    """Return the abbreviated hash of a commit that holds models. Raises InputError."""
    output = git("rev-parse", "--verify", "--quiet", "--short", "--end-of-options", f"{name}^{{commit}}")
    if output is None:
        raise InputError(f"BEFORE={name} is no commit of this clone: give a hash or a branch, or run `git fetch`")
    if git("cat-file", "-e", f"{name}:models") is None:
        raise InputError(f"BEFORE={name} has no folder models/: give {FIRST} or a later commit")
    return output.decode().strip()


def extract(name: str, folder: Path) -> None:
    """Write the models of a commit into a folder."""
    packed = git("archive", "--format=tar", name, "models")
    assert packed is not None
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")


def draw_pictures(folder: Path) -> None:
    """Write `pictures.npy`, with the pictures of the largest case, and `no_contact.npy`, uint8."""
    frames = render(SCENE, *CAMERA).frames
    np.save(folder / "pictures.npy", frames[np.arange(max(CASES.values())) % len(frames)])
    np.save(folder / "no_contact.npy", render(NO_CONTACT, *CAMERA, press=Press(noise=0)).frames[0])


class Version:
    """Child process that runs one version of the models; its depth maps are `<case>.npy` in the folder `results`."""

    def __init__(self, name: str, process: subprocess.Popen[str], results: Path) -> None:
        self.name, self.results, self._process = name, results, process

    def run(self, case: str) -> float:
        """Run a case once and return ms per frame. Raises RuntimeError: the child ended."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(case + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass
        answer = self._process.stdout.readline()
        if not answer:
            raise RuntimeError(f"the models of {self.name} do not run, see above: give another BEFORE")
        return float(answer)


@contextmanager
def started(name: str, folder: Path, pictures: Path) -> Iterator[Version]:
    """Start the child of a version with models in `folder`, on one thread."""
    with tempfile.TemporaryDirectory() as results:
        command = [sys.executable, benchmark_child.__file__, str(folder), str(pictures), results]
        one_thread = os.environ | dict.fromkeys(THREAD_VARIABLES, "1")
        pipe = subprocess.PIPE
        with subprocess.Popen(command, env=one_thread, stdin=pipe, stdout=pipe, text=True) as process:
            yield Version(name, process, Path(results))


def measure(before: Version, now: Version, rounds: int) -> list[dict[str, Any]]:
    """Run both versions in turn; return one row of `summary` per case."""
    times: dict[str, list[tuple[float, float]]] = {case: [] for case in CASES}
    for index in tqdm(range(WARM_UPS + rounds), leave=False, disable=None):
        for case, pairs in times.items():
            if index % 2:
                later, earlier = now.run(case), before.run(case)
            else:
                earlier, later = before.run(case), now.run(case)
            pairs.append((earlier, later))
    rows = []
    for case, pairs in times.items():
        depths = [np.load(version.results / f"{case}.npy") for version in (before, now)]
        difference = float(np.abs(depths[0] - depths[1]).max())
        rows.append(summary(case, np.array(pairs[WARM_UPS:]), difference))
    return rows


def summary(case: str, pairs: np.ndarray, difference_mm: float) -> dict[str, Any]:
    """Return the medians of pairs (rounds, 2) of ms, before and now, and of their ratios, with percentiles."""
    before, now = np.median(pairs, axis=0)
    low, ratio, high = np.percentile(pairs[:, 1] / pairs[:, 0], (SPREAD[0], 50, SPREAD[1]))
    return {
        "case": case,
        "before_ms": float(before),
        "now_ms": float(now),
        "ratio": float(ratio),
        "ratio_low": float(low),
        "ratio_high": float(high),
        "largest_difference_mm": difference_mm,
    }


def table(rows: Sequence[dict[str, Any]], before: str) -> str:
    """Return the table of the rows, for the terminal and for a page."""
    head = ("per frame", f"{before}, ms", "now, ms", "ratio", f"{SPREAD[0]} to {SPREAD[1]} %", "largest difference, mm")
    cells = [
        (
            row["case"],
            f"{row['before_ms']:.2f}",
            f"{row['now_ms']:.2f}",
            f"{row['ratio']:.2f}",
            f"{row['ratio_low']:.2f} to {row['ratio_high']:.2f}",
            f"{row['largest_difference_mm']:.1g}" if row["largest_difference_mm"] else "0",
        )
        for row in rows
    ]
    return markdown.table(head, cells)


def run(request: Request) -> dict[str, Any]:
    """Measure, and write benchmark.json.

    Raises InputError: the folder of the results cannot be written; RuntimeError: a version does not run.
    """
    files.make(request.out, ("benchmark.json",))
    folder = request.out / request.before
    folder.mkdir(exist_ok=True)
    extract(request.before, folder)
    with ExitStack() as stack:
        pictures = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        draw_pictures(pictures)
        before = stack.enter_context(started(request.before, folder, pictures))
        now = stack.enter_context(started("the working tree", ROOT, pictures))
        rows = measure(before, now, request.rounds)
    document = {"machine": machine(), "before": request.before, "rounds": request.rounds, "cases": rows}
    (request.out / "benchmark.json").write_text(json.dumps(document, indent=2) + "\n")
    return document


def main() -> None:
    with variables.reported("benchmark"):
        request = parse(sys.argv[1:])
        document = run(request)
        print(table(document["cases"], request.before))
        print(f"{document['machine']}; one thread, {request.rounds} pairs of runs; {request.out / 'benchmark.json'}")
