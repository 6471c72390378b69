# SPDX-License-Identifier: Apache-2.0
"""`make calibrate`: from ball presses of known diameter to a calibration file, a picture and a table.

The folder PRESSES holds background.png, the presses as PNGs or JPEGs, and presses.csv (press_folder.py). Circles that
presses.csv does not give are measured in the pictures; with CIRCLES=found all are, because half a pixel in a radius of
26 is 4 % of the height of a cap. The calibration is fitted to all presses; every whole press is measured by a fit to
all others. With CAMERA the pictures are converted to the stream of a camera with this pixel format and go through the
model of its hardware. models/tactile_depth/calibrate/fitting.py says how the fit is made.
"""

import os
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from commands.common import repository, variables
from commands.common.progress import progress_bar
from commands.common.run_request import camera_choice
from commands.run import draw
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.evaluation import slopes_and_depths
from tactile_depth.calibrate.fitting import DEFAULT_BITS, Fit, fit_presses
from tactile_depth.calibrate.presses import GridPresses, View, camera_pitch_mm, gather, to_grid
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.limits import MODELS
from tactile_depth.sensor.calibration_file import LONGEST_EXPOSURE_US, PIXEL_PITCHES_MM
from tactile_depth.sensor.sensor import TABLE_BITS

VARIABLES = ("PRESSES", "GRADIENT", "PITCH", "BITS", "CIRCLES", "EXPOSURE_US", "CAMERA", "BAYER", "OUT")
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
    exposure_us: float | None
    camera: CameraChoice | None
    out: Path | None


def parse(arguments: list[str]) -> Request:
    """Read KEY=VALUE arguments. Raises InputError."""
    values = variables.given(arguments, VARIABLES)
    models = {"all": MODELS, **{model: (model,) for model in MODELS}}
    out = Path(values["OUT"]) if "OUT" in values else None
    if out is not None and out.suffix != ".npz":
        raise InputError(f"OUT={out}: give the name of an .npz file")
    return Request(
        Path(values["PRESSES"]) if "PRESSES" in values else None,
        models[variables.choice(values, "GRADIENT", tuple(models))],
        variables.number(values, "PITCH", None, *PIXEL_PITCHES_MM, float),
        variables.number(values, "BITS", DEFAULT_BITS, *TABLE_BITS),
        variables.choice(values, "CIRCLES", ("table", "found")) == "found",
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
    with files.workspace(out.parent, names, str(out)) as work:  # refused before the fit, which takes some seconds
        fit = fit_folder(request, folder, out, work)
        files.replace(work, names, out.parent)
    kibibytes = out.stat().st_size / 1024
    print(f"the best model is {fit.sensor.model}: the default in {os.path.relpath(out)} ({kibibytes:.1f} KiB)")
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
        _progress,
    )
    print(report(fit, presses))
    fit.sensor.save(work / out.name)
    draw_presses(work / out.with_suffix(".png").name, fit, presses)
    return fit


def report(fit: Fit, presses: GridPresses) -> str:
    """Return the text of the report: presses of the fit, and its accuracy on each press by a fit to the others."""
    rows, columns = presses.grid
    lines = [f"{len(presses.views)} presses fitted, grid of {columns} x {rows}", presses.field_of_view]
    if len(presses.agreement):
        x, y, radius = np.median(presses.agreement, axis=0)
        spread = np.median(np.abs(presses.agreement - (x, y, radius)), axis=0)
        lines.append(
            f"circles found in {len(presses.agreement)} pictures minus those of presses.csv: x {x:+.1f} "
            f"({spread[0]:.1f}), y {y:+.1f} ({spread[1]:.1f}), radius {radius:+.1f} ({spread[2]:.1f}) pixels, median "
            "(and median deviation)"
        )
    lines += ["every whole press, by a fit to the others; cap height: recovered / true", str(fit.evaluation)]
    return "\n".join(lines)


def draw_presses(path: Path, fit: Fit, presses: GridPresses) -> None:
    """Draw presses from the first to the last, by fits to the others: frame, slopes, depth, a cut beside the ball."""
    pitch, (rows, columns) = presses.grid_pitch_mm, presses.grid
    measured = [view for view in presses.views if view.press.name in fit.without]
    indices = np.unique(np.linspace(0, len(measured) - 1, PRESSES_DRAWN).round().astype(int))
    drawn = []
    for view in (measured[index] for index in indices):
        press, sensor = view.press, fit.without[view.press.name]
        maps = {model: slopes_and_depths(sensor, presses, [view], model) for model in sensor.models}
        slopes, depths = maps[fit.sensor.model][0][0], {model: depth[0] for model, (_, depth) in maps.items()}
        x, y = press.edge()
        row = min(max(round(press.y + 0.5), 0), rows - 1)
        drawn.append(
            draw.DrawnPress(
                name=press.name,
                frame=view.frame,
                slopes=slopes,
                depth=depths[fit.sensor.model] * pitch,
                circle=(x * pitch, y * pitch),
                across=(np.arange(columns) - press.x - 0.5) * pitch,
                ball=press.depth(presses.grid)[row] * pitch,
                cuts={model: (depth[row] - press.edge_depth(depth)) * pitch for model, depth in depths.items()},
            )
        )
    title = f"presses by fits to the others, {fit.sensor.model}, Neumann, {columns} x {rows}"
    draw.draw_presses(path, drawn, (columns * pitch, rows * pitch), title)


def _progress(views: list[View]) -> Iterable[View]:
    return progress_bar(views, "leaving out")


def main() -> None:
    with variables.reported("calibrate"):
        sys.exit(run(parse(sys.argv[1:])))
