# SPDX-License-Identifier: Apache-2.0
"""Captures of reference and zero offset in a device."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tactile_depth.base.errors import InputError, InputWarning, warn
from tactile_depth.base.npy import Bytes
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import captured_gains, pixel_gains, require_light, untouched_of
from tactile_depth.chip.gradient.light_gains import ROUNDS
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.registers.table_banks import CAPTURES, COMMIT
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.arrived import arrived
from tactile_depth.device.camera_frame import dead_pixels
from tactile_depth.device.channel import Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.exchange import CAMERA_S, Exchange
from tactile_depth.device.registers import meanwhile, read_words, write_words
from tactile_depth.device.tables import select, wait_in_use
from tactile_depth.pictures.doubts import Doubt, UnusablePicture
from tactile_depth.pictures.reader import Reader
from tactile_depth.pictures.reference_check import check_reference, check_zero_depth
from tactile_depth.sensor.sensor import Sensor, equal_areas

ATTEMPTS = 3
LIGHT = REGISTERS["LIGHT"]
STILL = (1 << LIGHT_GAIN.fraction) // 512
"""Move of a light gain that changes the brightest pixel by half a level."""
STEADY_LIGHT = "switch lamps that flicker off, then call capture_zero() again"
OF_CAMERA = "the reference that the device took from its camera"


class Unseen(NamedTuple):
    """Table of a capture whose pictures this program did not send, as far as it is known.

    Attributes
    ----------
    doubts : tuple of Doubt
    entries : int64 array (entries,), or None
        Lower words; None for a capture of before this program.
    """

    doubts: tuple[Doubt, ...] = ()
    entries: np.ndarray | None = None


def write_gains(line: Channel, gains: Sequence[int]) -> None:
    """Write the light gains of the next frame, of red, green and blue."""
    write_words(line, list(zip(GAINS, gains, strict=True)))


def held_light(line: Channel) -> AbstractContextManager[None]:
    """Keep light gains as they are written, until the end of the context."""
    light = read_words(line, [LIGHT.name])[LIGHT.name]
    return meanwhile(line, LIGHT.name, light & ~LIGHT.field("follow").mask, light)


@contextmanager
def unity_light(line: Channel) -> Iterator[None]:
    """Keep light gains of 1, until the end of the context: those for another reference are far from right."""
    with held_light(line):
        write_gains(line, [1 << LIGHT_GAIN.fraction] * len(GAINS))
        yield


def capture_of_pictures(line: Channel, table: str, frames: Bytes, gains: Sequence[Sequence[int]] | None = None) -> None:
    """Capture a table from pictures that are sent, and wait until it is in use.

    Parameters
    ----------
    table : str
        `reference` or `zero`.
    frames : uint8 array (2**k, rows, columns, 3)
        Pictures on the grid.
    gains : sequence of (red, green, blue), optional
        Light gains of each; by default they follow the light.

    Raises
    ------
    DeviceError
        Too many pictures get lost, or the device does not answer.
    """
    with Exchange(line) as exchange:

        def untouched() -> None:
            exchange.depth_of(frames[0])

        def all_sent() -> bool:
            """Send the pictures; return False as soon as one gets lost."""
            for index, frame in enumerate(frames):
                if gains is not None:
                    write_gains(line, gains[index])
                if exchange.depth_of(frame) is None:
                    return False
            return True

        with held_light(line) if gains is not None else nullcontext():
            for _ in range(ATTEMPTS):
                wait_in_use(line, untouched)
                _start(line, table, len(frames))
                if all_sent() and _has_ended(line, table):
                    break
            else:
                raise DeviceError(f"{ATTEMPTS} captures lost pictures on the line", remedy="check cable and baud rate")
        wait_in_use(line, untouched)


def capture_of_camera(line: Channel, table: str, count: int, give_picture: Callable[[], None]) -> None:
    """Capture a table from the next pictures of the device's camera, and wait until it is in use.

    Parameters
    ----------
    table : str
        `reference` or `zero`.
    count : int
        2**k pictures.
    give_picture : function
        Sends a picture without contact.

    Raises
    ------
    DeviceError
        The camera gives no pictures, or the device does not answer.

    Warns
    -----
    InputWarning
        The light moves, so a zero offset depends on it.
    """
    wait_in_use(line, give_picture)
    if table == "zero":
        _settle_light(line)
    _start(line, table, count)
    for _ in _looks(line):
        if not _busy(line, table):
            break
    wait_in_use(line, give_picture)


def read_captured(line: Channel, table: str, give_picture: Callable[[], None]) -> np.ndarray:
    """Return the lower words of a table that was captured, int64 (entries,).

    Software reads the bank that no frame uses: meanwhile the table before the capture is in use.
    """

    def change_over() -> None:
        write_words(line, [(COMMIT.name, COMMIT.pack(**{table: 1}))])
        wait_in_use(line, give_picture)

    change_over()
    write_words(line, [select(table), ("TABLE_INDEX", 0)])
    size = read_words(line, ["TABLE_SIZE"])["TABLE_SIZE"]
    words = line.read([REGISTERS["TABLE_LOW"].offset] * size)
    change_over()
    if len(words) < size:
        raise DeviceError(f"the device refuses to read its table {table}", remedy="call load() first")
    return np.array(words)


def check_reference_of_camera(pipeline: Pipeline, entries: np.ndarray) -> tuple[tuple[Doubt, ...], int]:
    """Refuse or doubt a reference by the entries of its table; return the doubts and the number of its dead pixels."""
    config, sensor = pipeline.config, _as_captured(pipeline)
    gains = gains_at_nodes(entries, config)
    require_light(gains, config, OF_CAMERA)
    try:
        doubts = check_reference(sensor, untouched_of(gains, config)[None], OF_CAMERA)
    except UnusablePicture as error:
        problem = str(error).removesuffix(f": {error.remedy}")
        remedy = "build the device for its camera (BAYER), and mount that as calibrated"
        raise InputError(problem, remedy=remedy) from error
    return doubts, dead_pixels(pixel_gains(gains, config))


def gains_at_nodes(entries: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the gains (node rows, node columns, 3) of the entries of a reference."""
    return entries.reshape(*config.reference_nodes, -1)[..., :3]


def codes_at_nodes(entries: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the depth codes (node rows, node columns) of the entries of a zero offset."""
    sign = 1 << config.depth.width - 1
    return (entries.reshape(config.reference_nodes) & 2 * sign - 1 ^ sign) - sign


def _as_captured(pipeline: Pipeline) -> Sensor:
    """Return the sensor with the calibration's own picture as a capture keeps it: as gains at nodes of the grid."""
    sensor, config = pipeline.reader.sensor, pipeline.config
    if sensor.untouched is None or sensor.camera is None:
        return sensor
    own = np.rint(equal_areas(sensor.untouched, (sensor.camera.rows, sensor.camera.columns))).astype(np.uint8)
    ((_, frame),), _ = Reader(sensor, pipeline.grid).pictures(own, OF_CAMERA)
    return replace(sensor, untouched=equal_areas(untouched_of(captured_gains(frame[None], config), config)))


def check_zero_of_camera(pipeline: Pipeline, entries: np.ndarray) -> tuple[Doubt, ...]:
    """Doubt a zero offset by the entries of its table."""
    codes = codes_at_nodes(entries, pipeline.config)
    return check_zero_depth(codes * pipeline.depth_lsb_mm, "the zero offset that the device took from its camera")


def _settle_light(line: Channel) -> None:
    """Wait until the light gains stand still; warn if they do not within `ROUNDS` pictures of the camera."""
    light = read_words(line, [LIGHT.name])[LIGHT.name]
    fastest = light & ~LIGHT.field("rate").mask
    with meanwhile(line, LIGHT.name, fastest, then=light):
        pictures = filter(None, _looks(line))
        gains, still = np.zeros(len(GAINS)), 0
        for _ in range(ROUNDS):
            next(pictures)
            before, gains = gains, np.array(list(read_words(line, GAINS).values()))
            still = still + 1 if np.abs(gains - before).max() < STILL else 0
            if still == 2:  # the gains may come a little later than the count of the picture that moves them
                return
    warn(InputWarning("the light of the device's camera does not stand still", remedy=STEADY_LIGHT))


def _looks(line: Channel) -> Iterator[bool]:
    """Look for pictures of the camera, without end: give True if one has come. Raises DeviceError if none comes."""
    last, came = time.monotonic(), -1
    while True:
        taken = read_words(line, ["FRAMES_IN"])["FRAMES_IN"]
        is_new = taken != came
        if is_new:
            last, came = time.monotonic(), taken
        elif time.monotonic() - last > line.limit_s + CAMERA_S:
            came_in = arrived(line, is_awaited=True)
            reason = f", {came_in.problem}" if came_in.problem else ""
            problem = f"no picture came from the camera of the device in {line.limit_s + CAMERA_S:.1f} s{reason}"
            raise DeviceError(problem, remedy=came_in.remedy or "let it send pictures of the grid, or give pictures")
        yield is_new


def _start(line: Channel, table: str, count: int) -> None:
    register = CAPTURES[table]
    write_words(line, [(register.name, register.pack(log2_frames=count.bit_length() - 1, start=1))])


def _busy(line: Channel, table: str) -> bool:
    register = CAPTURES[table]
    return bool(read_words(line, [register.name])[register.name] & register.field("busy").mask)


def _has_ended(line: Channel, table: str) -> bool:
    """Wait for the end of a capture whose pictures have all come; return False if it waits for more."""
    end = time.monotonic() + line.limit_s
    while _busy(line, table):
        if time.monotonic() > end:
            return False
    return True
