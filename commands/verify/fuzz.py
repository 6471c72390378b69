# SPDX-License-Identifier: Apache-2.0
"""`make fuzz`: everything that reads what a user gives, on input made to break it.

Each reader gets files that the bytes of a coverage-guided fuzzer (atheris) are turned into: well-formed outside, so
that checksums and archives let them through, and wrong anywhere inside; every second one is then damaged as a whole.
On each of them a reader gives a valid result or an InputError of one line, within `SECONDS_A_RUN` and `MEMORY_MB`.

MINUTES (10) is the time for all readers together, SEED (1) where the fuzzer begins, READER one of them alone. Failing
inputs are kept in build/fuzz/<reader>; `make fuzz READER=<reader> REPLAY=<file>` runs one again.
"""

from __future__ import annotations

import inspect
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
import zipfile
from collections.abc import Callable
from concurrent.futures import as_completed
from pathlib import Path

import atheris
import numpy as np
from tqdm import tqdm

from commands.common import repository
from commands.common import variables as make_variables
from commands.common.run_request import Request, parse
from commands.common.signals import threads
from commands.run import sim
from commands.verify.fuzz_files import GOOD_PNG, MEMORY_MB, Bytes, damaged, good_jpeg, npy, npz, picture
from tactile_depth import calibration_file, press_folder
from tactile_depth import frames as pictures
from tactile_depth import presses as ball_presses
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.frames import Frames, load_frames
from tactile_depth.gradient.quadratic_gradient import polynomial_words
from tactile_depth.press_folder import read_presses
from tactile_depth.presses import gather, to_grid
from tactile_depth.sensor import Sensor, load

FOLDER = repository.ROOT / "build" / "fuzz"
SECONDS_A_RUN = 10
LONGEST = 4096  # bytes of the fuzzer's input
WORKERS = 2
SIZE = (16, 16)


# Readers: what is given to each, and what a valid result is.


def good_frames(result: Frames) -> None:
    pixels = result.pixels
    assert pixels.dtype == np.uint8
    assert pixels.ndim == 4
    assert pixels.shape[1:] == (*SIZE, 3)
    assert 0 < len(pixels) == len(result.labels)
    assert 1 <= result.pixel_scale < float("inf")


def frames_npy(data: Bytes, folder: Path) -> None:
    path = folder / "frames.npy"
    path.write_bytes(damaged(data, npy(data, [(1, 16, 16, 3), (3, 20, 17, 3), (0, 16, 16, 3)], ["|u1"])))
    good_frames(load_frames(str(path), SIZE))


def frames_picture(data: Bytes, folder: Path) -> None:
    path = folder / data.PickValueInList(["frame.png", "frame.jpg", "frame", "frame.tif", "frame.gif"])
    path.write_bytes(damaged(data, picture(data)))
    good_frames(load_frames(str(path), SIZE))


def frames_folder(data: Bytes, folder: Path) -> None:
    inside = folder / "frames"
    inside.mkdir()
    for _ in range(data.ConsumeIntInRange(0, 3)):
        name = data.PickValueInList(["", "", "7", "12", "\u00b2", "\u0663"])
        name = re.sub(r"[/\0]", "", name + data.ConsumeUnicodeNoSurrogates(8)) + data.PickValueInList(
            [".png", ".jpg", ".PNG", ".JPEG", ""]
        )
        if name in ("", ".", "..") or (inside / name).exists():
            continue
        if data.ConsumeIntInRange(0, 15):
            (inside / name).write_bytes(GOOD_PNG if data.ConsumeBool() else damaged(data, picture(data)))
        else:
            (inside / name).mkdir(exist_ok=True)
    good_frames(load_frames(str(inside), SIZE))


def frames_reference(data: Bytes, folder: Path) -> None:
    frame, reference = folder / "frame.png", folder / "reference.png"
    frame.write_bytes(GOOD_PNG)
    reference.write_bytes(damaged(data, picture(data)))
    good_frames(load_frames(str(frame), SIZE, str(reference)))


def calibration(data: Bytes, folder: Path) -> None:
    path = folder / "sensor.npz"
    path.write_bytes(damaged(data, data.PickValueInList([npz, npz, npz, npz, npz, plain])(data)))
    result: Sensor = load(str(path), camera_size=(240, 320))
    assert 0 < result.pixel_pitch_mm < float("inf")
    config = Configuration(columns=16, gradient_limit=result.gradient_limit)
    if result.gradient is not None:
        b = result.bits_per_channel
        assert result.gradient.shape == (1 << b, 1 << b, 1 << b, 2)
        assert result.gradient.dtype == np.float64
        assert np.isfinite(result.gradient).all()
        Configuration(columns=16, gradient_limit=result.gradient_limit, bits_per_channel=b)
    if result.coefficients is not None:
        assert np.isfinite(result.coefficients).all()
        polynomial_words(result, config, result.pixel_pitch_mm)
    camera = result.camera
    assert camera is not None
    assert min(camera.rows, camera.columns) > 0
    assert camera.black_level == 0
    assert camera.exposure_us is None or 0 < camera.exposure_us < float("inf")
    assert set(result.fitted_slope) | set(result.height_errors) <= set(result.models)
    assert all(0 < slope < float("inf") for slope in result.fitted_slope.values())
    for error in result.height_errors.values():
        assert 0 <= error.relative < float("inf")
        assert error.presses >= 0
    if result.lighting is not None:
        result.check_lighting(REST)
    result.save(path)
    again = load(str(path))
    assert (again.camera, again.height_errors) == (camera, result.height_errors)
    assert (result.gradient if result.model == "lut" else result.coefficients) is not None


def plain(data: Bytes) -> bytes:
    return npy(data, [(2, 2, 2, 2)], ["<f8"])


def presses(data: Bytes, folder: Path) -> None:
    columns = ["frame", data.PickValueInList(["diameter_mm", "diameter_mm", "ball_diameter_mm", "size"])]
    columns += ["centre_x_px", "centre_y_px", "contact_radius_px", "ball_radius_px"][: data.ConsumeIntInRange(0, 4)]
    lines = [",".join(columns)]
    for _ in range(data.ConsumeIntInRange(0, 3)):
        cells = ["1.png"]
        for _ in range(len(columns) - 1 + data.PickValueInList([0, 0, 0, -1, 1])):
            cells.append(data.PickValueInList(["12.5", "30", "-1", "nan", "inf", "1e400", "", '"', "x", "1_0"]))
        lines.append(",".join(cells))
    (folder / "presses.csv").write_bytes(damaged(data, "\n".join(lines).encode()))
    pressed, notes = read_presses(folder)
    assert all(note.isprintable() for note in notes)
    for press in pressed:
        assert 0 < press.diameter_mm < float("inf")
        if press.circle:
            assert np.isfinite(press.circle).all()
            assert 0 < press.circle[2] < (press.ball_radius_px or float("inf"))
    (folder / "1.png").write_bytes(GOOD_PNG)
    (folder / "background.jpg").write_bytes(good_jpeg("RGB", 0, False, 0))
    on_grid = to_grid(gather(folder), 0.5)
    assert all(note.isprintable() for note in on_grid.notes)
    for view in on_grid.views:
        assert 0 < view.press.largest_slope < float("inf")
        assert np.isfinite(view.press.slopes(on_grid.size)).all()


KEYS = ["N", "ROWS", "COLS", "SOLVER", "BOUNDARY", "SIM", "DATA_WIDTH", "COEFF_WIDTH", "DEPTH_RANGE", "REPEAT", "SEED"]
KEYS += ["GAPS", "STALLS", "WAVES", "FRAMES", "OUT", "SIZE"]
VALUES = [
    "16",
    "128",
    "0",
    "-1",
    "1e3",
    "nan",
    "inf",
    "-inf",
    "1_6",
    "0x10",
    "9" * 5000,
    "\uff11\uff16",
    "tridiagonal",
    "neumann",
    "icarus",
    "",
]


def variables(data: Bytes, folder: Path) -> None:
    words = []
    for _ in range(data.ConsumeIntInRange(0, 6)):
        value = data.PickValueInList(VALUES) if data.ConsumeIntInRange(0, 3) else data.ConsumeUnicodeNoSurrogates(12)
        words.append(f"{data.PickValueInList(KEYS)}={value}")
    request: Request = parse(words)
    config = Configuration(
        columns=request.columns,
        rows=request.rows,
        solver=request.solver,
        neumann=request.boundary == "neumann",
        data_width=request.data_width,
        coefficient_width=request.coefficient_width,
        depth_range_px=request.depth_range_mm,
    )
    assert config.rows > 0


def paths(data: Bytes, folder: Path) -> None:
    """Names of files that cannot be."""
    text = data.ConsumeUnicodeNoSurrogates(20) * data.PickValueInList([1, 1, 30, 300])
    name = text + data.PickValueInList(["", ".png", ".npy", ".npz"])
    if data.ConsumeBool():
        load(str(folder / name))
    else:
        load_frames(str(folder / name), SIZE)


READERS: dict[str, Callable[[Bytes, Path], None]] = {
    read.__name__: read
    for read in (frames_npy, frames_picture, frames_folder, frames_reference, calibration, presses, variables, paths)
}
REST = np.full((240, 320, 3), 100, np.uint8)


# One reader, in a process of its own.


def memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def attempt(reader: str, data: bytes, folder: Path) -> str:
    """Return what a reader does wrong on an input, or ""."""
    before = memory_mb()
    place = Path(tempfile.mkdtemp(dir=folder))
    try:
        READERS[reader](Bytes(data), place)
    except InputError as error:
        text = str(error)
        if not text or not text.isprintable():
            return f"an InputError that is not one clear line: {text[:200]!r}"
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        text = " ".join(str(error).split())[:200]
        return f"{type(error).__name__} in {Path(last.filename).name}:{last.lineno}: {text}"
    finally:
        shutil.rmtree(place, ignore_errors=True)
    more = memory_mb() - before
    return f"{more:.0f} MB of memory" if more > MEMORY_MB else ""


def guide() -> None:
    """Let the fuzzer see which branches of the readers are taken."""
    for module in (sim, calibration_file, press_folder, ball_presses, pictures, np.lib.format, zipfile):
        for function in vars(module).values():
            if inspect.isfunction(function):
                atheris.instrument_func(function)


def fuzz(reader: str, seconds: int, seed: int) -> None:
    """Run the fuzzer; it ends the process. Failures go to the reader's folder, one input for each kind."""
    kept = FOLDER / reader
    shutil.rmtree(kept, ignore_errors=True)
    corpus = kept / "corpus"
    corpus.mkdir(parents=True)
    chance = np.random.default_rng(seed)
    for index in range(64):
        (corpus / str(index)).write_bytes(chance.bytes(int(chance.integers(1, LONGEST))))
    folder = Path(tempfile.mkdtemp(prefix="fuzz-"))
    seen: set[str] = set()

    def once(data: bytes) -> None:
        problem = attempt(reader, data, folder)
        kind = re.sub(r"\d+ MB", "MB", problem.split(": ")[0])
        if problem and kind not in seen:
            (kept / f"failure-{len(seen)}").write_bytes(data)
            with (kept / "failures.txt").open("a") as log:
                log.write(f"failure-{len(seen)}: {problem}\n")
            seen.add(kind)

    guide()
    warnings.simplefilter("ignore")
    options = [f"-max_total_time={seconds}", f"-seed={seed}", f"-max_len={LONGEST}", f"-timeout={SECONDS_A_RUN}"]
    options += [
        f"-artifact_prefix={kept}/",
        "-rss_limit_mb=0",
        "-print_final_stats=1",
        "-verbosity=0",
        "-len_control=0",
    ]
    atheris.Setup([sys.argv[0], *options, str(corpus)], once)
    atheris.Fuzz()


# All of them.


def run(reader: str, seconds: int, seed: int) -> tuple[int, list[str]]:
    """Fuzz a reader in a process of its own: runs, and what failed."""
    command = [sys.executable, "-m", "commands.verify.fuzz", f"FUZZ={json.dumps([reader, seconds, seed])}"]
    result = subprocess.run(command, cwd=repository.ROOT, capture_output=True, text=True, check=False)
    log = FOLDER / reader / "failures.txt"
    failures = log.read_text().splitlines() if log.exists() else []
    (FOLDER / reader / "log.txt").write_text(result.stderr)
    runs = re.search(r"number_of_executed_units: (\d+)", result.stderr)
    if result.returncode or runs is None:
        crash = next((line for line in result.stderr.splitlines() if "ERROR" in line or "Error" in line), "no word")
        failures.append(f"the process ended with {result.returncode}: {crash}: see {FOLDER / reader}/log.txt")
    return int(runs[1]) if runs else 0, failures


def main() -> None:
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # of the processes that fuzz a reader
    with make_variables.reported("fuzz"):
        given = make_variables.given(sys.argv[1:], ("MINUTES", "SEED", "READER", "REPLAY", "FUZZ"))
        readers = [given["READER"]] if "READER" in given else list(READERS)
        minutes = make_variables.number(given, "MINUTES", 10.0, 0.01, 10_000, float)
        seed = make_variables.number(given, "SEED", 1, 0, 10**9)
        if not READERS.keys() >= set(readers):
            raise InputError(f"READER={given['READER']} is unknown: accepted are {', '.join(READERS)}")
        if "REPLAY" in given and ("READER" not in given or not Path(given["REPLAY"]).is_file()):
            raise InputError(f"REPLAY={given['REPLAY']}: give a file that is there, and READER, which is to read it")
        sys.exit(campaign(given, readers, minutes, seed))


def campaign(given: dict[str, str], readers: list[str], minutes: float, seed: int) -> int:
    """Fuzz the readers, or replay one file; returns the exit status."""
    if "FUZZ" in given:
        fuzz(*json.loads(given["FUZZ"]))
    if "REPLAY" in given:
        file = Path(given["REPLAY"])
        problem = attempt(readers[0], file.read_bytes(), Path(tempfile.mkdtemp(prefix="fuzz-")))
        if problem:
            raise make_variables.Mismatch(problem)
        return make_variables.EQUAL
    seconds = max(1, round(60 * minutes * min(WORKERS, len(readers)) / len(readers)))
    begin, failed, total = time.monotonic(), [], 0
    with (
        threads(WORKERS) as pool,
        tqdm(total=round(60 * minutes), unit="s", disable=None, leave=False) as bar,
    ):
        pending = {pool.submit(run, reader, seconds, seed): reader for reader in readers}
        for future in as_completed(pending):
            reader, (runs, failures) = pending[future], future.result()
            bar.update(min(int(time.monotonic() - begin), bar.total) - bar.n)
            tqdm.write(f"{reader:18} {runs:9,} runs  {len(failures)} failures")
            for line in failures:
                tqdm.write(f"    {line}")
            failed += failures
            total += runs
    seconds = round(time.monotonic() - begin)
    print(f"fuzz: {total:,} runs of {len(readers)} readers, {len(failed)} failures, {seconds} s, SEED={seed}")
    return make_variables.MISMATCH if failed else make_variables.EQUAL


if __name__ == "__main__":
    main()
