# SPDX-License-Identifier: Apache-2.0
"""Pictures that arrive at a device: what is wrong with them, by its registers, and what to set."""

from __future__ import annotations

from typing import NamedTuple

from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS, REGISTERS
from tactile_depth.device.channel import Channel
from tactile_depth.device.registers import read_words
from tactile_depth.pictures.doubts import Doubt, doubt

NAMES = ("STATUS", "ARRIVED", "GRID", "FRAMES_DROPPED")
CAMERA = ("CAMERA_STATUS", "CAMERA_ARRIVED", "CAMERA_PICTURE")
PAGE = "docs/integrate.md, 5"
SET_SIZE = "set CAMERA_PICTURE or the camera: docs/camera.md"


class Arrived(NamedTuple):
    """Pictures that arrive.

    Attributes
    ----------
    rows, columns : int
        Rows of the one before the one that began last, columns of the last row; 0 as long as none, or no mark of its
        end, has come since the reset.
    hunting, stalled : bool
        Pixels are dropped up to a start of frame; the sink of depth stalls.
    problem, remedy : str
        What is wrong with them, and what to set; empty if nothing is.
    """

    rows: int
    columns: int
    hunting: bool
    stalled: bool
    problem: str = ""
    remedy: str = ""

    @property
    def line(self) -> str:
        """Return problem and remedy in one line."""
        return f"{self.problem}: {self.remedy}" if self.problem else ""


def arrived(line: Channel, is_awaited: bool = False) -> Arrived:
    """Return what arrives at a device; that nothing does is a problem if pictures are awaited.

    Raises DeviceError if the device does not answer.
    """
    fields = {name: REGISTERS[name].unpack(word) for name, word in read_words(line, NAMES).items()}
    status, size, grid = fields["STATUS"], fields["ARRIVED"], fields["GRID"]
    columns, rows = size["columns"], size["rows"]
    problem, remedy = _of_camera(line, is_awaited)
    if problem:
        return Arrived(rows, columns, bool(status["hunting"]), bool(status["stalled"]), problem, remedy)
    if not columns and not status["hunting"] and fields["FRAMES_DROPPED"]["value"]:
        problem, remedy = "no end of a row has come", f"set tlast with the last pixel of each row: {PAGE}"
    elif columns and (columns, rows or grid["rows"]) != (grid["columns"], grid["rows"]):
        problem = f"the source sends {columns} x {rows or '?'}, the build takes {grid['columns']} x {grid['rows']}"
        remedy = f"set its width and height, or build the device for them: {PAGE}"
    elif status["hunting"]:
        problem = "pixels come without a start of frame, and are dropped: the source gives no tuser"
        remedy = f"set tuser with the first pixel of a frame: {PAGE}"
    elif status["stalled"]:
        problem, remedy = "what takes the depth stalls", "start it, or set CONTROL.drop_frames"
    elif is_awaited and not columns:
        problem, remedy = "no row of pixels has come since the reset", "start the camera"
    return Arrived(rows, columns, bool(status["hunting"]), bool(status["stalled"]), problem, remedy)


def size_doubts(line: Channel) -> list[Doubt]:
    """Doubt a camera whose pictures have another size than CAMERA_PICTURE: the window is elsewhere in them."""
    problem = _other_size(*fields[1:]) if (fields := _camera_fields(line)) else ""
    return [doubt("size", f"{problem}: heights are wrong", remedy=SET_SIZE)] if problem else []


def _camera_fields(line: Channel) -> list[dict[str, int]]:
    """Return the fields of the registers `CAMERA`; empty without a camera front end, and over `uio`."""
    words = line.read([CAMERA_REGISTERS[name].offset for name in CAMERA])
    if len(words) < len(CAMERA):
        return []
    return [CAMERA_REGISTERS[name].unpack(word) for name, word in zip(CAMERA, words, strict=True)]


def _other_size(size: dict[str, int], picture: dict[str, int]) -> str:
    """Say that pictures come in another size than `picture`; empty if they do not, or none has come."""
    columns, rows = size["columns"], size["rows"] or picture["rows"]
    if not columns or (columns, rows) == (picture["columns"], picture["rows"]):
        return ""
    return f"the camera sends {columns} x {rows}, CAMERA_PICTURE is {picture['columns']} x {picture['rows']}"


def _of_camera(line: Channel, is_awaited: bool) -> tuple[str, str]:
    """Return problem and remedy of the pictures in front of the camera front end; empty without one, and over `uio`."""
    fields = _camera_fields(line)
    if not fields:
        return "", ""
    if problem := _other_size(*fields[1:]):
        return problem, SET_SIZE
    status = fields[0]
    if status["hunting"]:
        return "words of the camera come without a start of picture, and are dropped", "set tuser: docs/camera.md"
    if is_awaited and status["waiting"]:
        return "no word of the camera has come since the reset", "check its clock, VSYNC and set-up: docs/camera.md"
    return "", ""
