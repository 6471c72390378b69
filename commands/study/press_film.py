# SPDX-License-Identifier: Apache-2.0
"""Moving picture of the README: camera, height and contact while balls come and leave, as animated PNG.

Each press of PRESSES is one real picture. The pictures on the way there and back are blends of it and the picture
without contact, and say so. Every frame shows what `td.Pipeline` computes of its picture, by the shipped calibration.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import tactile_depth as td
from commands.common.press_data import data_folder
from commands.common.published import CLOCK_MHZ
from commands.common.repository import ROOT
from tactile_depth.base.errors import InputError
from tactile_depth.chip.latency import last_pixel_to_last_depth
from tactile_depth.pictures.frames import read_picture

FILM = ROOT / "docs" / "film.png"
PRESSES = (("9.500mm/15.png", 9.5), ("6.310mm/20.png", 6.31), ("9.500mm/2.png", 9.5))  # picture, ball in mm
COMES, LEAVES = (0.35, 0.7), (1.0, 0.7, 0.35, 0.0)  # shares of a press in its blend
STEPS = [  # picture, ball and share; a viewer of still pictures shows the first
    (*press, share)
    for press, after in zip(PRESSES, (*PRESSES[1:], PRESSES[0]), strict=True)
    for press, shares in ((press, LEAVES), (after, COMES))
    for share in shares
]
BLEND_MS, REST_MS, PRESS_MS = 140, 500, 1500
SIZE_INCHES, DPI = (7.6, 2.85), 100
TOP_MM = 0.9  # end of the scale of heights
MARGIN = 0.006  # beside a panel, of the width
SMALL = 10  # points of letters; 11 pixels where the picture is 700 wide
FIRST_LINE, LINE = 0.025, 0.085  # first line below the panels, and the next, of the height


@dataclass(frozen=True)
class Moment:
    """A picture, its depth, and how long it is shown."""

    picture: np.ndarray
    result: td.Result
    map_us: float  # from the last pixel to the last depth, at CLOCK_MHZ
    title: str
    shown_ms: int


def moments(folder: Path) -> Iterator[Moment]:
    """Give the pictures of the film. Raises InputError: one cannot be read."""
    rest = read_picture(folder / "background.png")
    pipeline = td.Pipeline(td.load("gelsight-mini"), reference=rest)
    map_us = last_pixel_to_last_depth(pipeline.config) / CLOCK_MHZ
    for name, diameter_mm, share in STEPS:
        press = read_picture(folder / name)
        picture = np.rint(rest + share * (press.astype(float) - rest)).astype(np.uint8)
        title, shown_ms = f"blend: {100 * share:.0f} % of the press", BLEND_MS
        if share == 0:
            title, shown_ms = "no contact", REST_MS
        elif share == 1:
            title, shown_ms = f"ball of {diameter_mm:g} mm", PRESS_MS
        yield Moment(picture, pipeline(picture), map_us, title, shown_ms)


def _panel(figure: Figure, number: int, title: str, size_mm: tuple[float, float]) -> Any:
    """Return the axis of one of three panels, in mm from the upper left corner of the picture."""
    width_mm, height_mm = size_mm
    width = 1 / 3 - 2 * MARGIN
    height = width * SIZE_INCHES[0] / SIZE_INCHES[1] * height_mm / width_mm
    axis = figure.add_axes((number / 3 + MARGIN, 0.9 - height, width, height))
    axis.set(xlim=(0, width_mm), ylim=(height_mm, 0), xticks=[], yticks=[])
    figure.text((number + 0.5) / 3, 0.925, title, ha="center", fontsize=SMALL + 1, weight="bold")
    return axis


def drawn(moment: Moment) -> Image.Image:
    """Return a frame of the film: camera, height with its scale, and contact with its numbers."""
    result, contact = moment.result, moment.result.contact
    rows, columns = result.codes.shape
    size_mm = (columns * result.pixel_pitch_mm * result.pixel_aspect, rows * result.pixel_pitch_mm)
    place: dict[str, Any] = {"extent": (0, *size_mm, 0), "aspect": "auto"}
    figure = Figure(figsize=SIZE_INCHES, dpi=DPI)
    camera, height, area = (_panel(figure, n, name, size_mm) for n, name in enumerate(("camera", "height", "contact")))
    bottom = camera.get_position().y0

    def write(number: int, line: int, text: str) -> None:
        at = (number + 0.5) / 3, bottom - FIRST_LINE - line * LINE
        figure.text(*at, text, ha="center", va="top", fontsize=SMALL)

    camera.imshow(moment.picture, **place)
    write(0, 0, moment.title)
    shown = height.imshow(result.height_mm, cmap="cividis", vmin=0, vmax=TOP_MM, **place)
    scale = figure.add_axes((1 / 3 + 0.03, bottom - 0.065, 1 / 3 - 0.1, 0.035))
    figure.colorbar(shown, cax=scale, orientation="horizontal", ticks=np.arange(0, TOP_MM + 0.01, 0.3))
    scale.tick_params(labelsize=SMALL, length=2, pad=2)
    figure.text(2 / 3 - 0.06, bottom - 0.045, "mm", va="center", fontsize=SMALL)
    write(1, 2, f"map {moment.map_us:.1f} µs after the last pixel")
    if contact.centroid_mm is None or contact.peak_position_mm is None:
        write(2, 0, "no contact")
    else:
        inside = result.depth_mm > contact.area_threshold_mm
        area.imshow(np.where(inside, 0.4, np.nan), cmap="Oranges", vmin=0, vmax=1, **place)
        row, column = contact.centroid_mm
        for line, at in ((area.axhline, row), (area.axvline, column)):
            line(at, color="#666666", linewidth=0.8)
        area.plot(*contact.peak_position_mm[::-1], "o", color="black", markersize=4)
        write(2, 0, f"peak (dot) {contact.peak_mm:.2f} mm")
        write(2, 1, f"area {contact.area_mm2:.1f} mm²")
        write(2, 2, f"centroid (cross) x {column:.1f}, y {row:.1f} mm")
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return Image.open(file).convert("RGB")


def draw(folder: Path, path: Path = FILM) -> None:
    """Draw the film of the presses in a folder. Raises InputError: a picture of them cannot be read."""
    each = list(moments(folder))
    first, *others = map(drawn, each)
    times = [moment.shown_ms for moment in each]
    first.save(path, save_all=True, append_images=others, duration=times, loop=0, optimize=True)


def draw_if_there() -> str:
    """Draw the film, or return the reason why it stays as it is."""
    try:
        draw(data_folder())
    except InputError as error:
        return f"{FILM.relative_to(ROOT)} stays as it is: {error}"
    return ""
