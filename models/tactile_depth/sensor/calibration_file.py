# SPDX-License-Identifier: Apache-2.0
"""Reads calibration files and reports errors in them. docs/calibration-file.md describes the format."""

from __future__ import annotations

import io
import math
import sys
import zipfile
from pathlib import Path

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, Part, counted, warn
from tactile_depth.base.npy import DIGEST, digest_of, is_file, read_header
from tactile_depth.chip.limits import COEFFICIENTS, CUBIC, GRADIENT_LIMITS, MODELS
from tactile_depth.sensor.sensor import (
    CORRECTIONS,
    FORMAT_VERSION,
    LIGHTING_BLOCKS,
    PIXEL_FORMATS,
    ROUNDING,
    TABLE_BITS,
    UNTOUCHED_AREAS,
    Camera,
    HeightError,
    Sensor,
)
from tactile_depth.sensor.verdict import BAD, GRADES, Verdict
from tactile_depth.sensor.view import SMALLEST_VIEW, is_share, require_field

FOLDER = Path(__file__).resolve().parent / "calibrations"
BUILT_IN = ("synthetic", "gelsight-mini")
LARGEST_COEFFICIENT = 1e6
LARGEST_MEMBER = 2 * (1 << TABLE_BITS[1]) ** 3 * np.dtype(np.longdouble).itemsize + 1024  # bytes, with a header
PIXEL_PITCHES_MM = (1e-6, 1e3)
PIXEL_ASPECTS = (0.5, 2.0)
CAMERA_SIZES = (8, 8192)  # rows, and columns
LONGEST_EXPOSURE_US = 1e8
OLD_KEYS = ("gradient", "pixel_pitch_mm", "coefficients", "largest_slope", "model")
CAMERA_KEYS = ("camera_size", "pixel_format", "black_level", "exposure_us", "flat_field")
KEYS = (
    "format_version",
    *OLD_KEYS,
    *CAMERA_KEYS,
    "lighting",
    "untouched",
    "view",
    "verdict",
    "cubic",
    "corrections",
    "pixel_aspect",
    *(f"{what}_{model}" for what in ("fitted_slope", "cap_height") for model in MODELS),
    DIGEST,
)

READ_VERSIONS = tuple(range(2, FORMAT_VERSION + 1))

Arrays = dict[str, np.ndarray]


def read_calibration(name: str, path: Path, camera_size: tuple[int, int] | None = None) -> Sensor:
    """Return the sensor of a calibration file.

    Parameters
    ----------
    camera_size : (rows, columns), optional
        Size of the pictures; needed if the file does not hold it, and refused if it contradicts the file.
    """
    if not is_file(path):
        problem = f"{path}: no such file" if path.suffix == ".npz" else f"unknown calibration {name}"
        raise InputError(f"{problem}: accepted are {', '.join(BUILT_IN)}, or the path of an .npz file")
    arrays = _unchanged(path, _arrays(path))
    held = {model: key in arrays for model, key in zip(MODELS, ("gradient", "coefficients", "cubic"), strict=True)}
    has_polynomials = held["quadratic"] or held["cubic"]
    if not any(held.values()):
        raise InputError(f"{path}: no `gradient`, `coefficients` or `cubic` in it: a calibration holds one or more")
    needed = ["pixel_pitch_mm", *["largest_slope"] * has_polynomials, *["corrections"] * held["cubic"]]
    old = "format_version" not in arrays
    if not old:
        _version(path, arrays["format_version"])
        needed += CAMERA_KEYS
    for key in needed:
        if key not in arrays:
            raise InputError(f"{path}: no `{key}` in it: a calibration holds {' and '.join(f'`{k}`' for k in needed)}")
    largest_slope = _slope(path, arrays, "largest_slope") if has_polynomials else 0.0
    pitch_mm = _limited(path, arrays, "pixel_pitch_mm", PIXEL_PITCHES_MM, "in mm")
    camera = _old_camera(path, camera_size) if old else _camera(path, arrays, camera_size)
    remedy = "correct `pixel_pitch_mm`, in mm per camera pixel, or the size of the camera's pictures"
    require_field((camera.rows, camera.columns), pitch_mm, f"{path}: `pixel_pitch_mm` is {pitch_mm:g}", remedy=remedy)
    models = [model for model in MODELS if held[model]]
    keys = {model: f"fitted_slope_{model}" for model in models}
    fitted = {model: _slope(path, arrays, key) for model, key in keys.items() if key in arrays}
    if old and held["quadratic"]:
        fitted["quadratic"] = largest_slope
    return Sensor(
        name,
        _gradient(path, arrays["gradient"]) if held["lut"] else None,
        pitch_mm,
        _polynomials(path, arrays, "coefficients", COEFFICIENTS) if held["quadratic"] else None,
        largest_slope,
        _model(path, arrays.get("model"), models),
        camera=camera,
        flat_field=True if old else bool(_checked(path, arrays, "flat_field", (), "b", "True or False")),
        fitted_slope=fitted,
        height_errors={
            model: _height_error(path, arrays, model) for model in models if f"cap_height_{model}" in arrays
        },
        lighting=_finite(path, arrays, "lighting", (*LIGHTING_BLOCKS, 3)) if "lighting" in arrays else None,
        cubic=_polynomials(path, arrays, "cubic", CUBIC) if held["cubic"] else None,
        corrections=_corrections(path, arrays) if held["cubic"] else None,
        pixel_aspect=_limited(path, arrays, "pixel_aspect", PIXEL_ASPECTS, "width over height")
        if "pixel_aspect" in arrays
        else 1.0,
        view=_view(path, arrays) if "view" in arrays else None,
        untouched=_untouched(path, arrays) if "untouched" in arrays else None,
        verdict=_verdict(path, arrays["verdict"]) if "verdict" in arrays else None,
    )


def _unchanged(path: Path, arrays: Arrays) -> Arrays:
    """Return what a file holds; of one that was changed since it was written, without its errors and verdict."""
    if DIGEST not in arrays or str(arrays[DIGEST]) == digest_of(arrays):
        return arrays
    warn(InputWarning(f"{path} was changed after the fit: its error does not hold any more", remedy="calibrate again"))
    return {key: array for key, array in arrays.items() if key != "verdict" and not key.startswith("cap_height_")}


def _view(path: Path, arrays: Arrays) -> tuple[float, float]:
    width, height = map(float, _finite(path, arrays, "view", (2,)))
    if not (is_share(width) and is_share(height)):
        accepted = f"shares of the full picture's width and height, {SMALLEST_VIEW:g} to 1"
        raise InputError(f"{path}: `view` is {width:g}, {height:g}: accepted are {accepted}")
    return width, height


def _verdict(path: Path, words: np.ndarray) -> Verdict:
    if words.ndim != 1 or words.dtype.kind != "U" or not len(words) or words[0] not in GRADES:
        accepted = f"one of {', '.join(GRADES)}, then reasons"
        raise InputError(f"{path}: `verdict` is {words.dtype} {words.shape}", accepted=accepted)
    verdict = Verdict(str(words[0]), tuple(map(str, words[1:])))
    if verdict.grade == BAD:
        warn(InputWarning(f"{path}: the verdict of its fit is {verdict}", remedy="calibrate again"))
    return verdict


def _untouched(path: Path, arrays: Arrays) -> np.ndarray:
    untouched = _finite(path, arrays, "untouched", (*UNTOUCHED_AREAS, 3))
    if untouched.min() < 0 or untouched.max() > 255:
        reach = f"{untouched.min():.3g} to {untouched.max():.3g}"
        raise InputError(f"{path}: `untouched` reaches from {reach}: accepted are grey levels, 0 to 255")
    return untouched


def _arrays(path: Path) -> Arrays:
    arrays = {}
    try:
        with zipfile.ZipFile(path) as archive:
            for key in KEYS:
                if f"{key}.npy" in archive.namelist():
                    arrays[key] = _member(archive, f"{key}.npy")
    except Exception as error:  # numpy, zipfile and zlib raise a dozen kinds over a damaged file
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: not a readable .npz ({reason}): write it with Sensor.save") from error
    return arrays


def _version(path: Path, version: np.ndarray) -> None:
    if version.shape != () or version.dtype.kind not in "iu" or int(version) not in READ_VERSIONS:
        shown = int(version) if version.shape == () and version.dtype.kind in "iu" else version.dtype
        accepted = f"accepted are {', '.join(map(str, READ_VERSIONS))}: a newer file needs a newer package"
        raise InputError(f"{path}: `format_version` is {shown}: {accepted}")


def _old_camera(path: Path, camera_size: tuple[int, int] | None) -> Camera:
    if camera_size is None:
        size = Argument("camera_size", ("<rows>", "<columns>"))
        raise InputError(
            f"{path}: a calibration of version 0.1, which names no camera",
            remedy=("give ", size, " of the pictures that it was made from, or calibrate again"),
        )
    rows, columns = _given_size(camera_size)
    warning = InputWarning(
        f"{path}: a calibration of version 0.1: taken for RGB pictures of {columns} x {rows} pixels (columns x rows) "
        "relative to a reference",
        remedy="calibrate again to have that written down",
    )
    warn(warning)
    return Camera(rows, columns)


def _camera(path: Path, arrays: Arrays, camera_size: tuple[int, int] | None) -> Camera:
    size = arrays["camera_size"]
    shown = tuple(size.tolist()) if size.shape == (2,) else f"{size.dtype} {size.shape}"
    rows, columns = _size(size, f"{path}: the size of the camera's pictures is {shown}")
    if camera_size is not None and _given_size(camera_size) != (rows, columns):
        raise InputError(
            Argument("camera_size", camera_size),
            f" contradicts {path}, which was made from pictures of {columns} x {rows} pixels (columns x rows)",
            remedy=("omit ", Argument("camera_size")),
        )
    form = arrays["pixel_format"]
    if form.shape != () or form.dtype.kind != "U" or str(form) not in PIXEL_FORMATS:
        raise InputError(f"{path}: `pixel_format` is {form!s:.40}: accepted is {', '.join(PIXEL_FORMATS)}")
    black = _number(path, arrays, "black_level")
    if black != 0:
        raise InputError(f"{path}: `black_level` is {black:g}: accepted is 0: subtract it from the pictures first")
    exposure = _number(path, arrays, "exposure_us")
    if not (math.isnan(exposure) or 0 < exposure <= LONGEST_EXPOSURE_US):
        raise InputError(f"{path}: `exposure_us` is {exposure:g}: accepted is a time in microseconds, or NaN: unknown")
    return Camera(rows, columns, str(form), black, None if math.isnan(exposure) else exposure)


def _given_size(camera_size: tuple[int, int]) -> tuple[int, int]:
    return _size(np.array(camera_size), Argument("camera_size", camera_size))


def _size(size: np.ndarray, what: Part) -> tuple[int, int]:
    low, high = CAMERA_SIZES
    if size.shape != (2,) or size.dtype.kind not in "iu" or not ((size >= low) & (size <= high)).all():
        raise InputError(what, accepted=("rows and columns", f"whole numbers from {low} to {high}"))
    return int(size[0]), int(size[1])


def _checked(path: Path, arrays: Arrays, key: str, shape: tuple[int, ...], kinds: str, accepted: str) -> np.ndarray:
    """Return an array of a calibration; raise InputError for another shape or another kind of numbers."""
    value = arrays[key]
    if value.shape != shape or value.dtype.kind not in kinds:
        raise InputError(f"{path}: `{key}` is {value.dtype} {value.shape}: accepted is {accepted}")
    return value


def _number(path: Path, arrays: Arrays, key: str) -> float:
    return float(_checked(path, arrays, key, (), "iuf", "one number"))


def _height_error(path: Path, arrays: Arrays, model: str) -> HeightError:
    key = f"cap_height_{model}"
    accepted = "mean, spread, number of presses"
    mean, spread, presses = _finite(path, arrays, key, (3,), accepted)
    if min(mean, spread, presses) < 0:
        raise InputError(f"{path}: `{key}` has negative values: accepted is {accepted}")
    if presses < 1:
        problem = f"{path}: `{key}` is of no presses, so nothing is known of the error"
        raise InputError(problem, accepted=accepted, remedy="leave it out of the file")
    return HeightError(float(mean), float(spread), int(min(presses, 1e9)))


def _finite(path: Path, arrays: Arrays, key: str, shape: tuple[int, ...], accepted: str = "") -> np.ndarray:
    accepted = accepted or f"float {shape}"
    value = _checked(path, arrays, key, shape, "f", accepted)
    if not np.isfinite(value).all():
        raise InputError(f"{path}: `{key}` holds NaN or infinity: accepted is {accepted}")
    return value.astype(np.float64)


def _member(archive: zipfile.ZipFile, name: str) -> np.ndarray:
    """Return an array of an archive; a member larger than the largest table is refused before it is unpacked."""
    member = archive.getinfo(name)
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{name} is packed in a way that numpy does not write")
    if member.file_size > LARGEST_MEMBER:
        raise ValueError(f"{name} has {member.file_size:,} bytes, and the largest table {LARGEST_MEMBER:,}")
    content = io.BytesIO(archive.read(member))  # never longer than file_size
    shape, _, dtype = read_header(content)
    if any(length < 0 for length in shape) or math.prod(shape) * dtype.itemsize > LARGEST_MEMBER:
        raise ValueError(f"{name} is {dtype} {shape}")
    content.seek(0)
    array = np.lib.format.read_array(content, allow_pickle=False)
    if dtype.kind == "U" and (np.frombuffer(array.tobytes(), f"{dtype.byteorder}u4") > sys.maxunicode).any():
        raise ValueError(f"{name} holds characters that do not exist")  # numpy makes broken strings of them
    return array


def _gradient(path: Path, gradient: np.ndarray) -> np.ndarray:
    low, high = TABLE_BITS
    shapes = [(1 << b, 1 << b, 1 << b, 2) for b in range(low, high + 1)]
    if gradient.shape not in shapes or gradient.dtype.kind != "f":
        raise InputError(
            f"{path}: `gradient` is {gradient.dtype} {gradient.shape}: accepted is float "
            f"(2^b, 2^b, 2^b, 2), b from {low} to {high}"
        )
    if bad := np.count_nonzero(~np.isfinite(gradient)):
        raise InputError(f"{path}: `gradient` holds {counted(int(bad), 'value')} of NaN or infinity: fill empty bins")
    largest = float(np.abs(gradient).max())
    if largest:
        _within_limits(path, "the largest slope in `gradient`", largest)
    return gradient.astype(np.float64)


def _polynomials(path: Path, arrays: Arrays, key: str, shape: tuple[int, ...]) -> np.ndarray:
    coefficients = _checked(path, arrays, key, shape, "f", f"float {shape}")
    if not (np.abs(coefficients) <= LARGEST_COEFFICIENT).all():  # NaN is not
        raise InputError(
            f"{path}: `{key}` holds NaN, or values over {LARGEST_COEFFICIENT:g}: is x in mm from the centre?"
        )
    return coefficients.astype(np.float64)


def _corrections(path: Path, arrays: Arrays) -> np.ndarray:
    corrections = _finite(path, arrays, "corrections", CORRECTIONS)
    _, high = GRADIENT_LIMITS
    if np.abs(corrections).max() > high:
        raise InputError(f"{path}: `corrections` reach {np.abs(corrections).max():.3g}: accepted is up to {high:g}")
    return corrections


def _slope(path: Path, arrays: Arrays, key: str) -> float:
    slope = _number(path, arrays, key)
    _within_limits(path, f"`{key}`", slope)
    return slope


def _within_limits(path: Path, what: str, slope: float) -> None:
    low, high = GRADIENT_LIMITS
    if not low <= slope <= high * (1 - ROUNDING):
        raise InputError(f"{path}: {what} is {slope:.3g}: accepted are {low:g} to {high:g}, in pixels per pixel")


def _model(path: Path, model: np.ndarray | None, held: list[str]) -> str:
    if model is None:
        return held[0]
    name = str(model) if model.shape == () and model.dtype.kind == "U" else f"{model.dtype} {model.shape}"
    if name not in held:
        raise InputError(f"{path}: `model` is {name}: accepted is a model that the file holds: {', '.join(held)}")
    return name


def _limited(path: Path, arrays: Arrays, key: str, limits: tuple[float, float], unit: str) -> float:
    value, (low, high) = _number(path, arrays, key), limits
    if not low <= value <= high:
        raise InputError(f"{path}: `{key}` is {value:g}: accepted are {low:g} to {high:g}, {unit}")
    return value
