# SPDX-License-Identifier: Apache-2.0
"""Files for `make fuzz`, made of a fuzzer's bytes: well-formed outside, and wrong anywhere inside."""

from __future__ import annotations

import io
import math
import re
import struct
import warnings
import zipfile
import zlib
from functools import cache
from typing import TYPE_CHECKING, Any

import atheris
import numpy as np
from PIL import Image

from tactile_depth import calibration_file
from tactile_depth.frames import EXIF_ORIENTATION
from tactile_depth.sensor import LIGHTING_BLOCKS

MEMORY_MB = 256  # more than a reader may take beyond what it has after the first runs
BOMB_MB = 2 * MEMORY_MB  # that an archive unpacks to

if TYPE_CHECKING:
    Bytes = Any  # atheris has no types
else:
    Bytes = atheris.FuzzedDataProvider


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


@cache
def good_jpeg(mode: str, subsampling: int, progressive: bool, orientation: int) -> bytes:
    """A JPEG of 20 x 20 pixels; orientation 0: without EXIF."""
    ramp = np.add.outer(np.arange(20), np.arange(20)).astype(np.uint8) * 5
    picture, exif = Image.fromarray(ramp).convert(mode), Image.Exif()
    if orientation:
        exif[EXIF_ORIENTATION] = orientation
    store = io.BytesIO()
    picture.save(store, "JPEG", subsampling=subsampling, progressive=progressive, exif=exif)
    return store.getvalue()


def jpeg(data: Bytes) -> bytes:
    """A JPEG of any mode, whose header may claim any size."""
    mode = data.PickValueInList(["RGB", "RGB", "RGB", "L", "CMYK", "YCbCr"])
    subsampling, orientation = data.ConsumeIntInRange(0, 2), data.PickValueInList([0, 0, 0, 1, 3, 6, 65535])
    file = good_jpeg(mode, subsampling, data.ConsumeBool(), orientation)
    frame = re.search(rb"\xff[\xc0\xc2]\x00.\x08", file, re.DOTALL)
    if frame and data.ConsumeIntInRange(0, 2) == 0:
        height, width = (data.PickValueInList([20, 16, 0, 4096, 4097, 65535]) for _ in range(2))
        file = file[: frame.end()] + struct.pack(">HH", height, width) + file[frame.end() + 4 :]
    return file


def picture(data: Bytes) -> bytes:
    return data.PickValueInList([png, png, jpeg])(data)


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
    store = io.BytesIO()
    kept = KEYS_OF_A_FILE if data.ConsumeIntInRange(0, 3) else KEYS_OF_VERSION_0_1
    with warnings.catch_warnings(), zipfile.ZipFile(store, "w") as archive:
        warnings.simplefilter("ignore")  # a name may come twice
        # One key in ten is damaged: a file has so many that more would leave none readable.
        for wanted in kept:
            harm = data.ConsumeIntInRange(0, 19)
            if harm == 0:
                continue
            name = data.PickValueInList(["other", f"../{wanted}", "pixel_pitch_mm", wanted]) if harm == 1 else wanted
            content = npy(data, *FIELDS[wanted]) if harm == 2 else good_member(wanted, data)
            packings = (
                [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2] if harm == 3 else [zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED]
            )
            suffix = data.PickValueInList(["", ".NPY"]) if harm == 4 else ".npy"
            archive.writestr(name + suffix, content, data.PickValueInList(packings), 1)
    return store.getvalue()


BINS: list[tuple[int, ...]] = [(1 << b, 1 << b, 1 << b, 2) for b in (1, 2, 4)]
NUMBER: tuple[list[tuple[int, ...]], list[str]] = ([()], ["<f8", "<i8", "<f4"])
FIELDS: dict[str, tuple[list[tuple[int, ...]], list[str]]] = {
    "gradient": (BINS, ["<f8", "<f4", "<f2"]),
    "pixel_pitch_mm": NUMBER,
    "coefficients": ([(2, 3, 6)], ["<f8", "<f4"]),
    "largest_slope": NUMBER,
    "model": ([()], ["<U3", "<U9"]),
    "format_version": ([()], ["<i8", "|u1", "<u8"]),
    "camera_size": ([(2,)], ["<i8", "<u2", "<i4"]),
    "pixel_format": ([()], ["<U6", "<U9"]),
    "black_level": NUMBER,
    "exposure_us": NUMBER,
    "flat_field": ([()], ["|b1", "|u1"]),
    "lighting": ([(*LIGHTING_BLOCKS, 3)], ["<f8", "<f4"]),
    "fitted_slope_lut": NUMBER,
    "fitted_slope_quadratic": NUMBER,
    "cap_height_lut": ([(3,)], ["<f8", "<f4"]),
    "cap_height_quadratic": ([(3,)], ["<f8", "<f4"]),
}
KEYS_OF_A_FILE = calibration_file.KEYS
KEYS_OF_VERSION_0_1 = calibration_file.OLD_KEYS
NUMBERS = [0.0, -1.0, 1e-300, 0.05, 1.0, 63.9, 64.0, 1e6, 1e300, math.inf, -math.inf, math.nan]
GOOD: dict[str, Any] = {
    "gradient": np.linspace(-0.7, 0.7, 4**3 * 2).reshape(4, 4, 4, 2),
    "pixel_pitch_mm": 0.05,
    "coefficients": np.linspace(-1, 1, 36).reshape(2, 3, 6),
    "largest_slope": 0.7,
    "model": "quadratic",
    "format_version": 2,
    "camera_size": np.array((240, 320)),
    "pixel_format": "rgb888",
    "black_level": 0.0,
    "exposure_us": math.nan,
    "flat_field": True,
    "lighting": np.ones((*LIGHTING_BLOCKS, 3)),
    "fitted_slope_lut": 0.7,
    "fitted_slope_quadratic": 0.7,
    "cap_height_lut": np.array((1.0, 0.1, 11.0)),
    "cap_height_quadratic": np.array((1.0, 0.1, 11.0)),
}


def good_member(key: str, data: Bytes) -> bytes:
    """An array as a calibration file holds it, one number in it at times another."""
    array = np.array(GOOD[key])
    if data.ConsumeIntInRange(0, 7) == 0:
        if array.dtype.kind == "f":
            array[np.unravel_index(data.ConsumeIntInRange(0, array.size - 1), array.shape)] = data.PickValueInList(
                NUMBERS
            )
        elif array.dtype.kind == "i":
            place = np.unravel_index(data.ConsumeIntInRange(0, array.size - 1), array.shape)
            array[place] = min(max(whole_number(data), -(1 << 63)), (1 << 63) - 1)
        elif array.dtype.kind == "U":
            array = np.array(data.ConsumeUnicodeNoSurrogates(9))
        else:
            array = ~array
    store = io.BytesIO()
    np.save(store, array)
    return store.getvalue()


ROWS = b"".join(b"\0" + bytes(range(60)) for _ in range(20))
GOOD_PNG = (
    b"\x89PNG\r\n\x1a\n"
    + chunk(b"IHDR", struct.pack(">IIBBBBB", 20, 20, 8, 2, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(ROWS))
    + chunk(b"IEND", b"")
)
