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
import io
import json
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
import zipfile
import zlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import cache
from pathlib import Path

import atheris
import numpy as np
from tqdm import tqdm

from commands import calibrate, sim
from commands import simulator as simulation
from commands import variables as make_variables
from commands.calibrate import read_presses
from commands.sim import Request, parse
from models import calibration as calibrations
from models import frames as pictures
from models.calibration import Calibration, load
from models.configuration import Configuration
from models.errors import InputError
from models.frames import Frames, load_frames
from models.quadratic_gradient import polynomial_words

FOLDER = simulation.ROOT / "build" / "fuzz"
SECONDS_A_RUN = 10
MEMORY_MB = 256  # more than a reader may take beyond what it has after the first runs
BOMB_MB = 2 * MEMORY_MB
LONGEST = 4096  # bytes of the fuzzer's input
WORKERS = 2
SIZE = (16, 16)

Bytes = atheris.FuzzedDataProvider


# Files out of bytes.


def whole_number(data: Bytes) -> int:
    """Mostly small, at times on an edge of a machine word."""
    kind = data.ConsumeIntInRange(0, 9)
    if kind < 7:
        return data.ConsumeIntInRange(0, 40)
    if kind < 9:
        return data.ConsumeIntInRange(0, 1 << 24)
    edge = 1 << data.PickValueInList([15, 16, 31, 32, 62, 63, 64])
    return data.PickValueInList([edge - 1, edge, -1, -edge])


def chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # of PNG's colour types
CHUNKS = [b"tRNS", b"PLTE", b"gAMA", b"tEXt", b"zTXt", b"iTXt", b"iCCP", b"eXIf", b"acTL", b"fcTL", b"fdAT", b"pHYs"]


def png(data: Bytes) -> bytes:
    """A PNG with right checksums and any contents."""
    width, height = (max(whole_number(data), 0) & 0xFFFFFFFF for _ in range(2))
    if data.ConsumeIntInRange(0, 3):
        width, height = 16 + width % 8, 16 + height % 8
    elif data.ConsumeIntInRange(0, 3) == 0:
        width, height = 1 << data.ConsumeIntInRange(12, 20), 16
    depth = data.PickValueInList([8, 8, 8, 1, 2, 4, 16, 0, 255])
    colour = data.PickValueInList([2, 2, 6, 3, 0, 4, 1, 7])
    interlace = data.PickValueInList([0, 0, 0, 1, 2])
    out = b"\x89PNG\r\n\x1a\n"
    out += chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlace))
    if colour == 3 and data.ConsumeIntInRange(0, 7):
        out += chunk(b"PLTE", bytes(range(48)))
    for _ in range(data.ConsumeIntInRange(0, 2)):
        kind = data.PickValueInList(CHUNKS)
        body = data.ConsumeBytes(data.ConsumeIntInRange(0, 40))
        if kind in (b"zTXt", b"iCCP"):
            body = b"name\0\0" + zlib.compress(bytes(data.PickValueInList([10, 1 << 16, 1 << 24])))
        out += chunk(kind, body)
    row = (width * depth * CHANNELS.get(colour, 3) + 7) // 8 + 1
    wanted = row * height
    body = data.ConsumeBytes(data.ConsumeIntInRange(0, 200))
    if wanted <= 1 << 26:
        body = (body + bytes(wanted))[: wanted + data.PickValueInList([0, 0, 0, -1, 1])]
    elif data.ConsumeBool():
        body = bytes(1 << 24)
    packed = zlib.compress(body, 1)
    cut = data.PickValueInList([len(packed), len(packed), len(packed) // 2])
    out += chunk(b"IDAT", packed[:cut])
    if data.ConsumeIntInRange(0, 7):
        out += chunk(b"IEND", b"")
    return out


DTYPES = [
    "|u1",
    "|u1",
    "|u1",
    "<f8",
    "<f8",
    "<f4",
    "<f2",
    ">f8",
    "<f16",
    "|i1",
    "<i8",
    "|O",
    "|b1",
    "<c16",
    "<U4",
    "|V3",
    "<M8[s]",
]


def npy(data: Bytes, shapes: list[tuple[int, ...]], dtypes: list[str]) -> bytes:
    """A .npy with a header of the right length and any contents."""
    shape = data.PickValueInList([*shapes, *shapes, ()])
    if data.ConsumeIntInRange(0, 2) == 0:
        shape = tuple(whole_number(data) for _ in range(data.ConsumeIntInRange(0, 5)))
    name = data.PickValueInList([*dtypes, *dtypes, *DTYPES])
    order = data.PickValueInList(["False", "False", "True", "0"])
    header = f"{{'descr': '{name}', 'fortran_order': {order}, 'shape': {shape}, }}"
    kind = data.ConsumeIntInRange(0, 15)
    if kind == 0:
        header = data.ConsumeUnicodeNoSurrogates(60)
    elif kind == 1:
        header = "(" * data.PickValueInList([10, 200, 9000]) + header
    elif kind == 2:
        header = header.replace("descr", "descriptor")
    elif kind == 3:
        header = header.replace(f"'{name}'", "[('x', '|u1', (3,)), ('y', '<f8')]")
    text = header.encode("utf-8", "replace") + b"\n"
    version = data.PickValueInList([1, 1, 1, 2, 3, 0, 255])
    length = struct.pack("<H" if version < 2 else "<I", len(text) % 65536)
    try:
        count = int(np.prod([max(s, 0) for s in shape], dtype=object)) * np.dtype(name).itemsize
    except (TypeError, ValueError):
        count = 64
    body = data.ConsumeBytes(data.ConsumeIntInRange(0, 64))
    if count <= 1 << 22:
        body = (body + bytes(count))[: count + data.PickValueInList([0, 0, 0, -1, 7])]
    return b"\x93NUMPY" + bytes([version, 0]) + length + text + body


def damaged(data: Bytes, file: bytes) -> bytes:
    """The file, or every second time one with bytes changed, cut off or inserted."""
    for _ in range(data.ConsumeIntInRange(0, 1) * data.ConsumeIntInRange(1, 4)):
        place = data.ConsumeIntInRange(0, len(file))
        kind = data.ConsumeIntInRange(0, 3)
        if kind == 0:
            file = file[:place]
        elif kind == 1:
            file = file[:place] + data.ConsumeBytes(4) + file[place:]
        else:
            file = file[:place] + bytes([data.ConsumeIntInRange(0, 255)]) + file[place + 1 :]
    return file


@cache
def bomb(member: str) -> bytes:
    """A small archive with a member that is `BOMB_MB` large."""
    count = BOMB_MB << 17
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count},), }}\n".encode()
    store = io.BytesIO()
    with zipfile.ZipFile(store, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        with archive.open(f"{member}.npy", "w") as file:
            file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text)
            for _ in range(BOMB_MB):
                file.write(bytes(1 << 20))
        archive.writestr("pixel_pitch_mm.npy" if member == "gradient" else "gradient.npy", b"")
    return store.getvalue()


def npz(data: Bytes) -> bytes:
    """An archive of arrays."""
    if data.ConsumeIntInRange(0, 15) == 0:
        return bomb(data.PickValueInList(["gradient", "pixel_pitch_mm"]))
    bins = [(1 << b, 1 << b, 1 << b, 2) for b in (1, 2, 4)]
    store = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(store, "w") as archive:
        warnings.simplefilter("ignore")  # a name may come twice
        keys = ["gradient", "pixel_pitch_mm", "coefficients", "largest_slope", "model"]
        for wanted in keys[: data.PickValueInList([2, 2, 4, 5])]:
            name = data.PickValueInList([wanted, wanted, wanted, wanted, "other", f"../{wanted}", "pixel_pitch_mm"])
            if wanted == "gradient":
                content = npy(data, bins, ["<f8", "<f4", "<f2"])
            elif wanted == "coefficients":
                content = npy(data, [(2, 3, 6)], ["<f8", "<f4"])
            elif wanted == "model":
                content = npy(data, [()], ["<U3", "<U9"])
            else:
                content = npy(data, [()], ["<f8", "<i8", "<f4"])
            method = data.PickValueInList([zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED, zipfile.ZIP_LZMA])
            archive.writestr(f"{name}{data.PickValueInList(['.npy', '.npy', '.npy', ''])}", content, method, 1)
    return store.getvalue()


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


def frames_png(data: Bytes, folder: Path) -> None:
    path = folder / data.PickValueInList(["frame.png", "frame.png", "frame", "frame.tif", "frame.gif"])
    path.write_bytes(damaged(data, png(data)))
    good_frames(load_frames(str(path), SIZE))


def frames_folder(data: Bytes, folder: Path) -> None:
    inside = folder / "frames"
    inside.mkdir()
    for _ in range(data.ConsumeIntInRange(0, 3)):
        name = data.PickValueInList(["", "", "7", "12", "\u00b2", "\u0663"])
        name = re.sub(r"[/\0]", "", name + data.ConsumeUnicodeNoSurrogates(8)) + data.PickValueInList(
            [".png", ".png", ".PNG", ""]
        )
        if name in ("", ".", "..") or (inside / name).exists():
            continue
        if data.ConsumeIntInRange(0, 15):
            (inside / name).write_bytes(GOOD_PNG if data.ConsumeBool() else damaged(data, png(data)))
        else:
            (inside / name).mkdir(exist_ok=True)
    good_frames(load_frames(str(inside), SIZE))


def frames_reference(data: Bytes, folder: Path) -> None:
    frame, reference = folder / "frame.png", folder / "reference.png"
    frame.write_bytes(GOOD_PNG)
    reference.write_bytes(damaged(data, png(data)))
    good_frames(load_frames(str(frame), SIZE, str(reference)))


def calibration(data: Bytes, folder: Path) -> None:
    path = folder / "sensor.npz"
    path.write_bytes(damaged(data, data.PickValueInList([npz, npz, npz, npz, npz, plain])(data)))
    result: Calibration = load(str(path))
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
    rows, notes = read_presses(folder)
    assert all(note.isprintable() for note in notes)
    for row in rows:
        assert 0 < row.diameter_mm < float("inf")
        if row.circle:
            assert np.isfinite([row.circle.x, row.circle.y]).all()
            assert 0 < row.circle.radius < (row.ball_radius or float("inf"))


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
    for read in (frames_npy, frames_png, frames_folder, frames_reference, calibration, presses, variables, paths)
}
ROWS = b"".join(b"\0" + bytes(range(60)) for _ in range(20))
GOOD_PNG = (
    b"\x89PNG\r\n\x1a\n"
    + chunk(b"IHDR", struct.pack(">IIBBBBB", 20, 20, 8, 2, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(ROWS))
    + chunk(b"IEND", b"")
)


# One reader, in a process of its own.


def memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def attempt(reader: str, data: bytes, folder: Path) -> str:
    """What is wrong with what a reader does on an input, or nothing."""
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
    for module in (calibrate, sim, calibrations, pictures, np.lib.format, zipfile):
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
    command = [sys.executable, "-m", "commands.fuzz", f"FUZZ={json.dumps([reader, seconds, seed])}"]
    result = subprocess.run(command, cwd=simulation.ROOT, capture_output=True, text=True, check=False)
    log = FOLDER / reader / "failures.txt"
    failures = log.read_text().splitlines() if log.exists() else []
    (FOLDER / reader / "log.txt").write_text(result.stderr)
    runs = re.search(r"number_of_executed_units: (\d+)", result.stderr)
    if result.returncode or runs is None:
        crash = next((line for line in result.stderr.splitlines() if "ERROR" in line or "Error" in line), "no word")
        failures.append(f"the process ended with {result.returncode}: {crash}: see {FOLDER / reader}/log.txt")
    return int(runs[1]) if runs else 0, failures


def main() -> None:
    with make_variables.reported("fuzz"):
        given = make_variables.given(sys.argv[1:], ("MINUTES", "SEED", "READER", "REPLAY", "FUZZ"))
        readers = [given["READER"]] if "READER" in given else list(READERS)
        minutes = make_variables.number(given, "MINUTES", 10.0, 0.01, 10_000, float)
        seed = make_variables.number(given, "SEED", 1, 0, 10**9)
        if not READERS.keys() >= set(readers):
            raise InputError(f"READER={given['READER']} is unknown: accepted are {', '.join(READERS)}")
        if "REPLAY" in given and ("READER" not in given or not Path(given["REPLAY"]).is_file()):
            raise InputError(f"REPLAY={given['REPLAY']}: give a file that is there, and READER, which is to read it")
    if "FUZZ" in given:
        fuzz(*json.loads(given["FUZZ"]))
    if "REPLAY" in given:
        file = Path(given["REPLAY"])
        problem = attempt(readers[0], file.read_bytes(), Path(tempfile.mkdtemp(prefix="fuzz-")))
        sys.exit(problem or 0)
    seconds = max(1, round(60 * minutes * min(WORKERS, len(readers)) / len(readers)))
    begin, failed, total = time.monotonic(), [], 0
    with (
        ThreadPoolExecutor(WORKERS) as pool,
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
    sys.exit(bool(failed))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
