# SPDX-License-Identifier: Apache-2.0
"""Reads a folder of ball presses: pictures, presses.csv and background.png.

presses.csv has a header and one line for each press. Its columns are `frame`, a path in the folder, and `diameter_mm`
or `ball_diameter_mm` of the ball. Optional columns are the contact's circle, `centre_x_px`, `centre_y_px` and
`contact_radius_px`, and the ball's `ball_radius_px`, all in camera pixels.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

from tactile_depth.base.errors import InputError, counted
from tactile_depth.base.npy import is_file
from tactile_depth.calibrate.ball_press import BallPress, Circle
from tactile_depth.pictures.frames import PICTURE_SUFFIXES

TABLE, BACKGROUND = "presses.csv", "background"
LARGEST_TABLE = 1 << 20  # bytes
CIRCLE = ("centre_x_px", "centre_y_px", "contact_radius_px")
DIAMETERS = ("diameter_mm", "ball_diameter_mm")
BALL_RADIUS = "ball_radius_px"
BALLS_MM = (1.0, 50.0)  # diameters that are likely; 6 mm in centimetres is less, in micrometres more
HEAD = ("frame", DIAMETERS[0], *CIRCLE, BALL_RADIUS)
KNOWN = ("frame", *DIAMETERS, *CIRCLE, BALL_RADIUS)


def background_path(folder: Path) -> Path:
    """Return the path of the picture without contact in a folder: background.png, .jpg or .jpeg."""
    paths = [folder / f"{BACKGROUND}{suffix}" for suffix in PICTURE_SUFFIXES]
    return next((path for path in paths if is_file(path)), paths[0])


def read_presses(folder: Path, table: Path | None = None) -> tuple[list[BallPress], list[str]]:
    """Return the presses of a table sorted by name, and one line for each column or line that is not used.

    The table is presses.csv in the folder, if no other is given.
    """
    path = table or folder / TABLE
    if not is_file(path):
        if table is not None:
            raise InputError(f"{table}: no such file: give a table with the columns of {TABLE}")
        raise InputError(
            f"{folder}: no {TABLE} in it: give a folder with background.png, pictures of ball presses, and {TABLE} "
            "with columns frame and diameter_mm"
        )
    head, lines = _cells(path)
    diameter = next((name for name in DIAMETERS if name in head), "")
    if "frame" not in head or not diameter or len(set(head)) < len(head):
        raise InputError(
            f"{path}: columns {', '.join(head) or 'none'}: needed are frame and diameter_mm, each column once, "
            f"separated by commas; accepted are {', '.join(KNOWN)}"
        )
    if 0 < len(missing := [name for name in CIRCLE if name not in head]) < len(CIRCLE):
        raise InputError(f"{path}: no column {', '.join(missing)}: give all of {', '.join(CIRCLE)}, or none")
    presses: dict[str, BallPress] = {}
    notes = []
    if unknown := [name for name in head if name not in KNOWN]:
        notes.append(f"{path}: unknown columns {', '.join(unknown)}: not used; accepted are {', '.join(KNOWN)}")
    for number, cells in enumerate(lines, 2):
        if not any(cells):
            continue
        try:
            if len(cells) != len(head):
                raise ValueError(f"{counted(len(cells), 'cell')} under {counted(len(head), 'column')}")
            press = _press(folder, {name: cell.strip() for name, cell in zip(head, cells, strict=True)}, diameter)
            if press.name in presses:
                raise ValueError(f"{press.name} a second time")
        except ValueError as error:
            notes.append(f"{path}: line {number} left out: {error}")
            continue
        presses[press.name] = press
    balls = sorted(press.diameter_mm for press in presses.values())
    if balls and not (BALLS_MM[0] <= balls[0] and balls[-1] <= BALLS_MM[1]):
        notes.append(f"{path}: balls of {balls[0]:g} to {balls[-1]:g} mm: {diameter} is the diameter in millimetres")
    return [presses[name] for name in sorted(presses)], [str(InputError(note)) for note in notes]


def table_rows(presses: Iterable[BallPress], circles: Mapping[str, Circle]) -> list[list[str]]:
    """Return the lines of a table under `HEAD`, with circles by names of presses; others keep what they have."""
    rows = []
    for press in presses:
        circle = circles.get(press.name, press.circle)
        cells = [""] * len(CIRCLE) if circle is None else [f"{number:.2f}" for number in circle]
        radius = "" if press.ball_radius_px is None else f"{press.ball_radius_px:g}"
        rows.append([press.name, f"{press.diameter_mm:g}", *cells, radius])
    return rows


def _cells(path: Path) -> tuple[list[str], list[list[str]]]:
    """Return the header and the lines of a table."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_TABLE + 1)
        if len(content) > LARGEST_TABLE:
            raise ValueError(f"it is longer than {LARGEST_TABLE:,} bytes")
        lines = list(csv.reader(content.decode("utf-8-sig").splitlines()))
    except (OSError, ValueError, csv.Error) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or " ".join(str(error).split())
        raise InputError(f"{path}: not a readable table ({reason}): write it as UTF-8 with commas") from error
    return ([name.strip() for name in lines[0]], lines[1:]) if lines else ([], [])


def _press(folder: Path, cells: dict[str, str], diameter: str) -> BallPress:
    """Return the press of a line; raise ValueError if the line cannot be used."""

    def number(column: str) -> float | None:
        text = cells.get(column, "")
        try:
            return float(text) if text else None
        except ValueError:
            raise ValueError(f"{column} is {text}: accepted is a number") from None

    name = cells["frame"]
    if not name or Path(name).is_absolute() or ".." in Path(name).parts:
        raise ValueError(f"frame {name!r} is no path in the folder")
    diameter_mm = number(diameter)
    if diameter_mm is None:
        raise ValueError(f"no {diameter}")
    if (other := number(DIAMETERS[-1])) not in (None, diameter_mm):
        raise ValueError(f"{diameter} is {diameter_mm:g}, but {DIAMETERS[-1]} {other:g}: give one of both")
    x, y, radius = (number(column) for column in CIRCLE)
    if 0 < (x, y, radius).count(None) < len(CIRCLE):
        raise ValueError(f"a circle without all of {', '.join(CIRCLE)}: give all three or none")
    circle = None if x is None or y is None or radius is None else (x, y, radius)
    return BallPress(folder / name, diameter_mm, circle, name, number(BALL_RADIUS))
