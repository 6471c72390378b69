# SPDX-License-Identifier: Apache-2.0
"""`make calibrate`: from ball presses of known diameter to a calibration file, a picture and a table.

The folder PRESSES holds background.png, the presses as PNGs or JPEGs, and presses.csv (press_folder.py). Circles that
presses.csv does not give are measured in the pictures; with CIRCLES=found all are, because half a pixel in a radius of
26 is 4 % of the height of a cap. HELD_OUT=each measures every whole press by a fit to all others, HELD_OUT=second every
second press by the written fit. With CAMERA the pictures are converted to the stream of a camera with this pixel format
and go through the model of its hardware. models/tactile_depth/fitting.py says how the fit is made.
"""

import os
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from commands.common import repository, variables
from commands.common.run_request import camera_choice
from commands.run import draw
from tactile_depth import files
from tactile_depth.calibration_file import LONGEST_EXPOSURE_US, PIXEL_PITCHES_MM
from tactile_depth.camera_configuration import CameraChoice
from tactile_depth.errors import InputError
from tactile_depth.evaluation import slopes_and_depths
from tactile_depth.fitting import DEFAULT_BITS, Fit, fit_presses
from tactile_depth.presses import GridPresses, View, camera_pitch_mm, gather, to_grid
from tactile_depth.sensor import BITS_PER_CHANNEL, MODELS

VARIABLES = ("PRESSES", "GRADIENT", "PITCH", "BITS", "CIRCLES", "HELD_OUT", "EXPOSURE_US", "CAMERA", "BAYER", "OUT")
PRESSES_DRAWN = 3
PUBLIC_PRESSES = (
    "give PRESSES=<folder with background.png, pictures of ball presses and presses.csv>; real ones are in the public "
    "repository rpl-cmu/gelslam, src/gelslam/resources/example_calibration: put frame and diameter_mm of its "
    "catalog.csv into presses.csv, and set PITCH=0.0634"
)


@dataclass(frozen=True)
class Request:
    """Variables of the command."""

    presses: Path | None
    models: tuple[str, ...]
    pitch_mm: float | None
    bits: int
    find_circles: bool
    each_in_turn: bool
    exposure_us: float | None
    camera: CameraChoice | None
    out: Path | None


def parse(arguments: list[str]) -> Request:
    """Read KEY=VALUE arguments. Raises InputError."""
    values = variables.given(arguments, VARIABLES)
    models = {"both": MODELS, **{model: (model,) for model in MODELS}}
    out = Path(values["OUT"]) if "OUT" in values else None
    if out is not None and out.suffix != ".npz":
        raise InputError(f"OUT={out}: give the name of an .npz file")
    return Request(
        Path(values["PRESSES"]) if "PRESSES" in values else None,
        models[variables.choice(values, "GRADIENT", tuple(models))],
        variables.number(values, "PITCH", None, *PIXEL_PITCHES_MM, float),
        variables.number(values, "BITS", DEFAULT_BITS, *BITS_PER_CHANNEL),
        variables.choice(values, "CIRCLES", ("table", "found")) == "found",
        variables.choice(values, "HELD_OUT", ("second", "each")) == "each",
        variables.number(values, "EXPOSURE_US", None, 1e-3, LONGEST_EXPOSURE_US, float),
        camera_choice(values),
        out,
    )


def data_folder() -> Path:
    """Return the folder of real presses: `gelslam/` in `TACTILE_DATA`, or in ../shared/data beside the repository.

    Raises InputError: it holds no presses.csv.
    """
    beside = repository.ROOT.parent / "shared" / "data"
    folder = Path(os.environ.get("TACTILE_DATA") or beside) / "gelslam"
    if not (folder / "presses.csv").is_file():
        raise InputError(f"no presses: {folder} holds no presses.csv: {PUBLIC_PRESSES}")
    return folder


def run(request: Request) -> int:
    """Fit, print the table, write the calibration and its picture together."""
    folder = data_folder() if request.presses is None else request.presses
    out = request.out or repository.ROOT / "build" / "calibrate" / f"{folder.resolve().name}.npz"
    names = (out.name, out.with_suffix(".png").name)
    with files.workspace(out.parent, names, str(out)) as work:  # refused before the fit, which takes half a minute
        fit = fit_folder(request, folder, out, work)
        files.replace(work, names, out.parent)
    kibibytes = out.stat().st_size / 1024
    print(f"the better model is {fit.sensor.model}: the default in {os.path.relpath(out)} ({kibibytes:.1f} KiB)")
    print(f"picture: {os.path.relpath(out.with_suffix('.png'))}")
    return 0


def fit_folder(request: Request, folder: Path, out: Path, work: Path) -> Fit:
    """Fit to the presses of a folder, print the table, and write both files of `out` into `work`."""
    pictures = gather(folder)
    pitch_mm = camera_pitch_mm(pictures, request.pitch_mm)
    presses = to_grid(pictures, pitch_mm, request.find_circles, compare_circles=True, choice=request.camera)
    for note in presses.notes:
        print(f"make calibrate: {note}", file=sys.stderr)
    fit = fit_presses(
        presses,
        request.models,
        request.bits,
        out.stem,
        request.exposure_us,
        each_in_turn=request.each_in_turn,
        progress=_progress,
    )
    print(report(fit, presses, request.each_in_turn))
    fit.sensor.save(work / out.name)
    draw_presses(work / out.with_suffix(".png").name, fit, presses)
    return fit


def report(fit: Fit, presses: GridPresses, each_in_turn: bool) -> str:
    """Return the text of the report: presses of the fit, and its accuracy on the presses held out."""
    held_out = "every whole press in turn, by a fit to the others" if each_in_turn else "the presses held out"
    lines = [
        f"{len(fit.fitted)} presses fitted, {len(fit.held_out)} held out, {presses.pitch_mm:g} mm per pixel, grid of "
        f"{presses.size}; the fit moved the centres by {fit.centre_shift_px:.1f} pixels (median)"
    ]
    if len(presses.agreement):
        x, y, radius = np.median(presses.agreement, axis=0)
        spread = np.median(np.abs(presses.agreement - (x, y, radius)), axis=0)
        lines.append(
            f"circles found in {len(presses.agreement)} pictures minus those of presses.csv: x {x:+.1f} "
            f"({spread[0]:.1f}), y {y:+.1f} ({spread[1]:.1f}), radius {radius:+.1f} ({spread[2]:.1f}) pixels, median "
            "(and median deviation)"
        )
    lines += [f"measured on {held_out}; cap height: recovered / true", str(fit.evaluation)]
    if fit.bins_fitted is not None and fit.pixels_in_them is not None:
        bits = fit.sensor.bits_per_channel
        lines.append(
            f"table of {bits} bits a colour: the fit filled {100 * fit.bins_fitted:.1f} % of its bins, and "
            f"{100 * fit.pixels_in_them:.1f} % of the pixels of the contacts held out fall into those"
        )
    return "\n".join(lines)


def draw_presses(path: Path, fit: Fit, presses: GridPresses) -> None:
    """Draw held-out presses from the first to the last: frame, slopes, depth, and a cut beside the ball."""
    pitch = presses.grid_pitch_mm
    indices = np.unique(np.linspace(0, len(fit.held_out) - 1, PRESSES_DRAWN).round().astype(int))
    views = [fit.held_out[index] for index in indices]
    maps = {model: slopes_and_depths(fit.sensor, presses, views, model) for model in fit.sensor.models}
    drawn = []
    for index, view in enumerate(views):
        press, size = view.press, presses.size
        x, y = press.edge()
        row = min(max(round(press.y + 0.5), 0), size - 1)
        across = np.arange(size) - press.x - 0.5
        squared = across**2 + (row - press.y - 0.5) ** 2
        ball = np.sqrt(np.maximum(press.ball_radius**2 - squared, 0)) - (press.ball_radius - press.cap_height)
        depths = {model: depth[index] for model, (_, depth) in maps.items()}
        drawn.append(
            draw.DrawnPress(
                name=press.name,
                frame=view.frame,
                slopes=maps[fit.sensor.model][0][index],
                depth=depths[fit.sensor.model] * pitch,
                circle=(x * pitch, y * pitch),
                across=across * pitch,
                ball=np.where(squared < press.contact_radius**2, ball * pitch, np.nan),
                cuts={model: (depth[row] - press.edge_depth(depth)) * pitch for model, depth in depths.items()},
            )
        )
    title = f"presses held out, {fit.sensor.model}, Neumann, {presses.size} x {presses.size}"
    draw.draw_presses(path, drawn, presses.size * pitch, title)


def _progress(views: list[View]) -> Iterable[View]:
    return tqdm(views, "holding out", leave=False, disable=None)


def main() -> None:
    with variables.reported("calibrate"):
        sys.exit(run(parse(sys.argv[1:])))
