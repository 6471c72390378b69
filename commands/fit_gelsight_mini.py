# SPDX-License-Identifier: Apache-2.0
"""Fit calibrations/gelsight-mini.npz to real ball presses: `python -m commands.fit_gelsight_mini`.

The presses are those of the public repository rpl-cmu/gelslam (MIT): `gelslam/` in the folder that
`TACTILE_DATA` names, or in ../shared/data beside the repository. A press that the square crop cuts is fitted;
of the whole ones every second is held out, and the table printed is of those alone.

The slope of a pixel is that of the ball where it touches, 0 elsewhere. A bin of the table is the mean over
its pixels, contact and surroundings weighted to count as much as each other: counted by area, the
surroundings (97 % of the pixels) pull every slope towards 0, and caps come out at two thirds of their height.
Bins hardly seen are filled from their neighbours, so slopes steeper than those of the balls (0.65) read as
about that.
"""

from __future__ import annotations

import csv
import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import map_coordinates, uniform_filter

from models import reference
from models.calibration import FOLDER, Calibration
from models.configuration import Configuration
from models.errors import InputError
from models.frames import load_frames, resampling
from models.tactile_depth import tactile_depth

CAMERA = (240, 320)
PIXEL_PITCH_MM = 0.0634
BITS_PER_CHANNEL = 4
FEWEST_PIXELS = 10  # a bin seen less often counts as empty
FRACTION_BITS = 12  # of a stored slope, so that the file is small and the same on every machine
TOP_PX = 2  # radius of the top of a cap, in grid pixels


@dataclass(frozen=True)
class Press:
    """A ball press. Lengths in pixels of the grid it is on, x along the columns, y down the rows."""

    name: str
    x: float
    y: float
    contact_radius: float
    ball_radius: float

    @property
    def cap_height(self) -> float:
        """Height of the ball's cap above its contact circle."""
        return self.ball_radius - float(np.sqrt(self.ball_radius**2 - self.contact_radius**2))

    def margin(self, size: int) -> float:
        """Distance from the contact circle to the nearest edge of a square grid; negative where it is cut."""
        return min(self.x, self.y, size - 1 - self.x, size - 1 - self.y) - self.contact_radius

    def on_grid(self, size: int) -> Press:
        """The press as it lies on a square grid, from the camera's pixels."""
        plan = resampling(CAMERA, (size, size))
        top, left = plan.origin
        return Press(
            self.name,
            (self.x - left + 0.5) / plan.scale - 0.5,
            (self.y - top + 0.5) / plan.scale - 0.5,
            self.contact_radius / plan.scale,
            self.ball_radius / plan.scale,
        )

    def slopes(self, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Slopes of depth, float64 (rows, cols, 2), 0 outside the contact; and the contact, bool."""
        rows, columns = np.indices(shape, dtype=np.float64)
        offset = np.stack((columns - self.x, rows - self.y), axis=-1)
        squared = (offset**2).sum(axis=-1)
        touches = squared < self.contact_radius**2
        drop = np.sqrt(np.where(touches, self.ball_radius**2 - squared, 1))
        return np.where(touches[..., None], -offset / drop[..., None], 0), touches

    def recovered(self, depth: np.ndarray) -> float:
        """Cap height in a depth map (rows, cols) in grid pixels, over the true one.

        Mean depth within `TOP_PX` of the centre minus mean depth on the contact circle. Depth lies half a
        pixel up and left of the slopes (models/divergence.py): a point of the frame is found half a pixel on.
        """
        x, y = self.x + 0.5, self.y + 0.5
        rows, columns = np.indices(depth.shape)
        top = depth[np.hypot(columns - x, rows - y) <= TOP_PX].mean()
        angle = np.linspace(0, 2 * np.pi, 360, endpoint=False)
        circle = [y + self.contact_radius * np.sin(angle), x + self.contact_radius * np.cos(angle)]
        return float((top - map_coordinates(depth, circle, order=1).mean()) / self.cap_height)


def data_folder() -> Path:
    """The folder of the presses: `gelslam/` in `TACTILE_DATA`, or in ../shared/data beside the repository.

    Raises
    ------
    InputError
        It holds no presses.csv.
    """
    beside = Path(__file__).resolve().parent.parent.parent / "shared" / "data"
    folder = Path(os.environ.get("TACTILE_DATA") or beside) / "gelslam"
    if not (folder / "presses.csv").is_file():
        raise InputError(f"{folder}: no presses.csv in it: set TACTILE_DATA to the folder that holds gelslam/")
    return folder


def read_presses(folder: Path) -> list[Press]:
    """All presses in camera pixels, by name.

    Raises
    ------
    InputError
        The table is not one.
    """
    path = folder / "presses.csv"
    columns = ("centre_x_px", "centre_y_px", "contact_radius_px", "ball_radius_px")
    presses = []
    try:
        with path.open(newline="", encoding="utf-8") as table:
            for row in csv.DictReader(table):
                press = Press(str(row["frame"]), *(float(row[column]) for column in columns))
                if not all(map(math.isfinite, (press.x, press.y))):
                    raise ValueError(f"{press.name} is nowhere")
                if not 0 < press.contact_radius < press.ball_radius < math.inf:
                    raise ValueError(f"the contact of {press.name} does not lie on its ball")
                presses.append(press)
    except (OSError, ValueError, TypeError, KeyError, csv.Error) as error:
        raise InputError(f"{path}: not a table of frame, {', '.join(columns)} ({error!r})") from error
    return sorted(presses, key=lambda press: press.name)


def held_out(presses: list[Press]) -> list[Press]:
    """Every second of the presses that the square crop leaves whole."""
    square = min(CAMERA)
    return [press for press in presses if press.on_grid(square).margin(square) >= 0][1::2]


def load_press(folder: Path, press: Press, size: tuple[int, int]) -> np.ndarray:
    """Flat-fielded frame on a grid: uint8 (rows, cols, 3)."""
    return load_frames(str(folder / press.name), size, str(folder / "background.png")).pixels[0]


def fit(folder: Path, presses: list[Press]) -> np.ndarray:
    """The table of slopes: float64 (2**b, 2**b, 2**b, 2), multiples of 2**-FRACTION_BITS."""
    bins = 1 << BITS_PER_CHANNEL
    count = np.zeros((2, bins**3))  # outside, inside the contact
    total = np.zeros((bins**3, 2))
    for press in presses:
        red, green, blue = np.moveaxis(load_press(folder, press, CAMERA) >> (8 - BITS_PER_CHANNEL), -1, 0)
        index = np.ravel_multi_index((red, green, blue), (bins,) * 3)
        slopes, touches = press.slopes(CAMERA)
        for contact in (0, 1):
            count[contact] += np.bincount(index[touches == contact], minlength=bins**3)
        for axis in (0, 1):
            total[:, axis] += np.bincount(index.ravel(), slopes[..., axis].ravel(), bins**3)
    outside, inside = count
    weight = inside + outside * inside.sum() / outside.sum()
    known = inside + outside >= FEWEST_PIXELS
    mean = np.where(known[:, None], total / np.where(known, weight, 1)[:, None], 0)
    table = fill(mean.reshape(bins, bins, bins, 2), known.reshape(bins, bins, bins))
    return np.rint(table * 2**FRACTION_BITS) / 2**FRACTION_BITS


def fill(table: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Give unknown bins the mean of their known neighbours, layer by layer.

    Parameters
    ----------
    table : float64 array (B, B, B, 2), 0 where unknown
    known : bool array (B, B, B), at least one true
    """
    table, known = table.copy(), known.copy()
    while not known.all():
        share = uniform_filter(known.astype(np.float64), 3, mode="constant")
        mean = uniform_filter(table, (3, 3, 3, 1), mode="constant") / np.maximum(share, 1e-9)[..., None]
        layer = ~known & (share > 0.5 / 27)
        table[layer] = mean[layer]
        known |= layer
    return table


def depth_of_codes(frame: np.ndarray, calibration: Calibration, config: Configuration) -> np.ndarray:
    """Depth in grid pixels as the hardware finds it."""
    return tactile_depth(frame, calibration, config) * config.depth_lsb_px


def report(folder: Path, presses: list[Press], calibration: Calibration, size: int) -> None:
    """Print, press by press, how well slopes and cap heights come out on a grid of `size`."""
    config = Configuration(
        columns=size,
        gradient_limit=calibration.gradient_limit,
        bits_per_channel=calibration.bits_per_channel,
    )
    print(f"\n{'press':<16}{'margin px':>10}{'slope R2':>10}{'cap height, recovered/true':>28}")
    print(f"{'':<36}{'double':>14}{'bit-accurate':>14}")
    rows = []
    for press in presses:
        frame, on_grid = load_press(folder, press, (size, size)), press.on_grid(size)
        truth, touches = on_grid.slopes((size, size))
        error = (reference.slopes(frame, calibration) - truth)[touches]
        r2 = 1 - (error**2).sum() / ((truth[touches] - truth[touches].mean(axis=0)) ** 2).sum()
        double = on_grid.recovered(reference.depth(frame, calibration))
        rows.append((r2, double, on_grid.recovered(depth_of_codes(frame, calibration, config))))
        margin = press.on_grid(min(CAMERA)).margin(min(CAMERA))
        print(f"{press.name:<16}{margin:>10.0f}{r2:>10.3f}{double:>14.3f}{rows[-1][2]:>14.3f}")
    r2, double, exact = np.mean(rows, axis=0)
    print(f"{'mean':<26}{r2:>10.3f}{double:>14.3f}{exact:>14.3f}")


def main() -> None:
    folder = data_folder()
    presses = read_presses(folder)
    test = held_out(presses)
    gradient = fit(folder, [press for press in presses if press not in test])
    path = FOLDER / "gelsight-mini.npz"
    np.savez_compressed(
        path,
        gradient=gradient.astype(np.float32),
        pixel_pitch_mm=PIXEL_PITCH_MM,
        held_out=[press.name for press in test],
    )
    calibration = Calibration("gelsight-mini", gradient, PIXEL_PITCH_MM)
    print(
        f"{len(presses) - len(test)} presses fitted, {len(test)} held out, "
        f"gradient limit {calibration.gradient_limit:g}, {path.stat().st_size / 1024:.1f} KiB"
    )
    report(folder, test, calibration, 128)


if __name__ == "__main__":
    main()
