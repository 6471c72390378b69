# SPDX-License-Identifier: Apache-2.0
"""Configuration and tables of a device: compared with those of a pipeline, written, and taken into use."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from tactile_depth.base.errors import InputError
from tactile_depth.chip.camera.camera_registers import WINDOW
from tactile_depth.chip.camera_configuration import window_of
from tactile_depth.chip.registers.axil_registers import Build
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS, REGISTERS, TABLES, Field
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT
from tactile_depth.chip.table_entries import ONE_WORD, table_entries
from tactile_depth.chip.tactile_depth import top_parameters
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.arrived import size_doubts
from tactile_depth.device.channel import Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.registers import read_words, write_words
from tactile_depth.pictures.doubts import Doubt, doubt
from tactile_depth.sensor.view import share_of

ARITHMETIC = "ARITHMETIC"
DESCRIPTION = ("GRID", "FORMAT", "DEVICE", "DEPTH_UNIT", "SLOPE_UNIT")
# Largest difference of a window from the calibration's view, in the length and the middle of each side, relative to the
# length. A window that is rounded to half pixels per grid pixel differs by 0.02; one of 0.97 and 0.95 of the view makes
# heights 4 and 7 % too large.
WINDOWS_AGREE = 0.025
BUSY = tuple(capture.name for capture in CAPTURES.values())
REMEDY = "make the pipeline with the configuration of the device, or build the device for the pipeline"


def build_of(pipeline: Pipeline) -> Build:
    """Return the build of a device that fits a pipeline."""
    return Build(top_parameters(pipeline.config, pipeline.pixel_pitch_mm))


def require_same(line: Channel, pipeline: Pipeline) -> None:
    """Raise InputError, which names what differs, unless a device has the configuration of a pipeline.

    The lanes may differ. Raises DeviceError if the device is no tactile_depth, or does not answer.
    """
    words = read_words(line, ["ID", *DESCRIPTION, ARITHMETIC])
    if words["ID"] != REGISTERS["ID"].reset:
        raise DeviceError(
            f"the device has another ID, {words['ID']:#010x}", remedy="build it with hdl/tactile_depth.sv"
        )
    expected = build_of(pipeline).description
    differing = [
        f"{name}.{field.name} is {_shown(words[name], field)}, that of the pipeline {_shown(expected[name], field)}"
        for name in DESCRIPTION
        for field in REGISTERS[name].fields
        if (words[name] ^ expected[name]) & field.mask and (name, field.name) != ("DEVICE", "lanes")
    ]
    if differing:
        raise InputError(f"the device has another configuration: {'; '.join(differing)}", remedy=REMEDY)
    if words[ARITHMETIC] != expected[ARITHMETIC]:
        problem = "the device computes with other numbers than the pipeline (ARITHMETIC)"
        raise InputError(problem, remedy="build the device for this calibration")
    _require_link(line, pipeline)


def _require_link(line: Channel, pipeline: Pipeline) -> None:
    """Raise InputError unless the link takes the rows and codes of depth as a device for a pipeline sends them."""
    *_, bits, bottom_first = line.status.shape
    codes, right = pipeline.config.depth.width, pipeline.config.solver == "tridiagonal"
    if bits != codes:
        problem = f"link_unit of the device takes depth codes of {bits} bits, they have {codes}"
        raise InputError(problem, remedy="build link_unit for these")
    if bottom_first != right:
        problem = f"link_unit of the device has BottomFirst={bottom_first:d}, its depth needs {right:d}"
        raise InputError(problem, remedy=f"build link_unit with BottomFirst={right:d}")


def camera_doubts(line: Channel, pipeline: Pipeline) -> list[Doubt]:
    """Doubt a device whose camera front end does not fit the calibration, or its camera."""
    return [*window_doubts(line, pipeline), *size_doubts(line)]


def window_doubts(line: Channel, pipeline: Pipeline) -> list[Doubt]:
    """Doubt a device that cuts its camera's pictures to another part than the calibration's pictures show.

    The camera is taken to send the sensor's full picture. No doubt of a device without a camera front end, over `uio`,
    which does not reach its registers, and for a calibration whose view is unknown.
    """
    view, words = pipeline.sensor.view, line.read([CAMERA_REGISTERS[name].offset for name in WINDOW])
    if view is None or len(words) < len(WINDOW):
        return []
    picture, first, size = (CAMERA_REGISTERS[name].unpack(word) for name, word in zip(WINDOW, words, strict=True))
    window = np.array((first["x"], first["y"], size["columns"], size["rows"]))
    expected = np.array(window_of((picture["rows"], picture["columns"]), pipeline.grid, share_of(view)))
    differs = np.concatenate((window[2:] - expected[2:], (window - expected)[:2] + (window - expected)[2:] / 2))
    if (np.abs(differs) <= WINDOWS_AGREE * np.tile(expected[2:], 2)).all():
        return []
    shown, right = (",".join(map(str, each.tolist())) for each in (window, expected))
    text = (
        f"CAMERA_WINDOW and CAMERA_WINDOW_SIZE of the device are {shown}, but {pipeline.sensor.name} is for {right} of "
        f"a picture of {picture['columns']} x {picture['rows']}: heights are wrong"
    )
    remedy = f"build the device with WINDOW={right}, unless its camera sends less than the sensor's full picture"
    return [doubt("window", text, remedy=remedy)]


def _shown(word: int, field: Field) -> str:
    value = (word & field.mask) >> field.low
    names = {code: name for name, code in field.values.items()}
    return names.get(value, str(value))


def load_tables(line: Channel, pipeline: Pipeline, give_picture: Callable[[], None]) -> None:
    """Write all tables and the pitch of a pipeline into a device, and commit them together.

    Parameters
    ----------
    give_picture : function
        Sends a picture without contact, which takes earlier tables into use and ends an earlier capture.

    Raises
    ------
    InputError
        The device has other tables.
    DeviceError
        It refuses an entry, earlier tables stay pending, or it does not answer.
    """
    entries = table_entries(pipeline.sensor, pipeline.config, pipeline.zero_codes)
    for name, words in entries.items():
        write_words(line, [select(name)])
        size = read_words(line, ["TABLE_SIZE"])["TABLE_SIZE"]
        if size != len(words):
            problem = f"the device has {size} entries in its table {name}, the pipeline {len(words)}"
            raise InputError(problem, remedy=REMEDY)
    wait_in_use(line, give_picture, also_captures=True)
    for name, words in entries.items():
        _write_table(line, name, words)
    pitch = build_of(pipeline).parameters["PitchNm"]
    write_words(line, [("PITCH", pitch), (COMMIT.name, COMMIT.pack(**dict.fromkeys(entries, 1)))])


def select(name: str) -> tuple[str, int]:
    """Return the register access that selects a table."""
    return "TABLE_SELECT", REGISTERS["TABLE_SELECT"].pack(select=TABLES[name])


def _write_table(line: Channel, name: str, entries: np.ndarray) -> None:
    """Write the entries (n, 2) of a table, lower and upper word, into its free bank."""
    accesses = [select(name), ("TABLE_INDEX", 0)]
    for low, high in entries.tolist():
        if name not in ONE_WORD:
            accesses.append(("TABLE_HIGH", high))
        accesses.append(("TABLE_LOW", low))
    write_words(line, accesses)
    if read_words(line, ["TABLE_INDEX"])["TABLE_INDEX"]:
        raise DeviceError(f"the device did not take every entry of its table {name}", remedy="call load() again")


def wait_in_use(line: Channel, give_picture: Callable[[], None], also_captures: bool = False) -> None:
    """Wait until frames use all tables that are committed, and until captures have ended if `also_captures` is set.

    Raises DeviceError if they stay pending.
    """
    quiet_ends, pictures = time.monotonic() + line.quiet_s, 0
    most = 2 + (1 << 8) * also_captures  # pictures of a capture, one that takes its table, and one that was malformed
    ends = time.monotonic() + line.limit_s
    while changing := pending(line, also_captures):
        if time.monotonic() < quiet_ends:
            continue
        if pictures < most:
            pictures += 1
            give_picture()
            ends = time.monotonic() + line.limit_s
        elif time.monotonic() > ends:
            problem = f"tables of the device stay pending ({', '.join(changing)}), although pictures were sent"
            raise DeviceError(problem, remedy="reset the device, then call load()")


def pending(line: Channel, also_captures: bool) -> list[str]:
    """Return the tables that are not in use yet, and the captures under way."""
    words = read_words(line, [*BUSY, COMMIT.name])  # the captures first: the end of one sets a bit of TABLE_COMMIT
    busy = [name for name in BUSY if also_captures and words[name] & REGISTERS[name].field("busy").mask]
    return busy + [name for name, bit in COMMIT.unpack(words[COMMIT.name]).items() if bit]
