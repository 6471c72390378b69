# SPDX-License-Identifier: Apache-2.0
"""Programs of users on the RTL of a device: the same on a line of bytes and at the pins, and as the package says."""

from __future__ import annotations

import functools
import os
import signal
import time
import warnings

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.chip.gradient.flat_field import reference_gains
from tactile_depth.chip.link.depth_formats import (
    FORMATS,
    DepthFormatName,
    exact_shift,
    from_bytes,
    sent_shape,
    to_bytes,
    value_bytes,
)
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.table_entries import reference_entries
from tactile_depth.device import captures
from tactile_depth.device.status import DeviceStatus
from tactile_depth.device.tables import wait_in_use
from tests.device.test_device import require_flags
from tests.device.test_simulator import process_of
from tests.real_data import FOLDER, needs_real_data

GRID = (16, 32)
PRESSES = 20


def seen(frame: td.DeviceFrame | td.Result) -> tuple[bytes, object]:
    """Return heights as float32, and the contact without number and time of the frame."""
    return frame.height_mm.astype(np.float32).tobytes(), frame.contact.record[3:-1]


def small(sample: td.Sample) -> td.Pipeline:
    """Return the pipeline whose device the tests at the pins simulate: one build for all of them.

    Without light gains, so that the depth of a picture does not depend on those before it, and with small tables.
    """
    return td.Pipeline(sample.sensor, sample.reference, grid=GRID, model="quadratic", light_gains=False)


def dimmer(sample: td.Sample) -> np.ndarray:
    return (0.95 * sample.reference.astype(float)).astype(np.uint8)


def program(address: str, sample: td.Sample, pictures: list[np.ndarray]) -> list[object]:
    """Return all that a program reads of a device: heights, contacts, flags, registers, status."""
    pipeline = small(sample)
    read: list[object] = []
    untouched = dimmer(sample)
    with td.Device(address, pipeline) as device:
        device.load()
        frames = list(device.depth(pictures))
        read += [*map(seen, frames), *(frame.flags for frame in frames)]
        device.capture_reference(untouched)
        device.capture_zero([untouched, untouched])
        device.set_thresholds(touch_mm=0.2, area_mm=0.4)
        read += [(seen(frame), frame.number) for frame in device.depth(pictures[:1])]
        read += [device.registers[name] for name in ("THRESHOLD", "FRAMES_OUT", "DARK_LEVEL")]
        with pytest.raises(td.InputError):
            device.registers["FRAMES_OUT"] = 1
        read += [device.status()]
    return read


def test_a_program_reads_the_same_on_bytes_and_at_the_pins() -> None:
    sample = td.sample("ball")
    pictures = [sample.image, sample.reference, sample.image]
    on_bytes = program("sim", sample, pictures)
    at_pins = program("sim:pins", sample, pictures)
    status, status_at_pins = on_bytes.pop(), at_pins.pop()
    assert on_bytes == at_pins
    assert isinstance(status, DeviceStatus)
    assert isinstance(status_at_pins, DeviceStatus)
    assert status_at_pins._replace(resets=status.resets) == status
    for read, result in zip(on_bytes[: len(pictures)], small(sample).stream(pictures), strict=True):
        assert read == seen(result)


def test_the_tables_of_captures_are_read_back() -> None:
    sample = td.sample("ball")
    captured = small(sample)
    captured.capture_reference(dimmer(sample))
    captured.capture_zero(sample.image)
    gains = reference_gains(captured.sensor, captured.config)
    with td.Device("sim", small(sample)) as device:
        device.load()
        device.self_test()
        device.capture_reference(dimmer(sample))
        device.capture_zero(sample.image)
        device.self_test()
        with device._open_line() as line:
            send = functools.partial(line.send, device._untouched)
            words, zero = (captures.read_captured(line, name, send) for name in ("reference", "zero"))
        (frame,) = device.depth(sample.image)
    np.testing.assert_array_equal(words, reference_entries(gains)[:, 0])
    np.testing.assert_array_equal(zero.astype(np.int32), captured.zero_codes.ravel())
    np.testing.assert_array_equal(frame.codes, captured(sample.image).codes)


def test_a_device_knows_what_it_holds() -> None:
    """It needs no load of what it is built for; an entry of another program, and a reset, are refused."""
    sample = td.sample("ball")
    pipeline, first = small(sample), r"call load\(\) first"

    def require_refused(message: str) -> None:
        for pictures in (sample.image, None):
            with pytest.raises(td.DeviceError, match=f"{message}.*: {first}"):
                next(device.depth(pictures))

    with td.Device("sim", pipeline) as device:
        (frame,) = device.depth(sample.image)
        for name, word in (("TABLE_SELECT", TABLES["reference"]), ("TABLE_INDEX", 5), ("TABLE_LOW", 1 << 20)):
            device.registers[name] = word
        device.registers["TABLE_COMMIT.reference"] = 1
        require_refused("about to change")
        with device._open_line() as line:
            wait_in_use(line, functools.partial(line.send, device._untouched))
        require_refused(r"not those of this program \(reference\)")
        device.load()
        (loaded,) = device.depth(sample.image)
        os.kill(process_of(device), signal.SIGUSR1)
        time.sleep(0.3)
        with pytest.raises(td.DeviceError, match="was reset"):
            device.status()
        require_refused("settings of the device are not those")
    for each in (frame, loaded):
        np.testing.assert_array_equal(each.codes, pipeline(sample.image).codes)


@pytest.mark.parametrize("name", FORMATS)
def test_each_format_of_depth(name: DepthFormatName) -> None:
    """Each frame has the codes that the model of the link sends of those of the package."""
    sample = td.sample("ball")
    pictures, pipeline = [sample.image, sample.reference, sample.image], small(sample)
    depth_format, width = FORMATS[name], pipeline.config.data_width
    shift = 0 if name == "words" else exact_shift(width)
    shape, size = sent_shape(depth_format, *GRID), value_bytes(depth_format, width)
    with td.Device("sim", pipeline, depth_format=name) as device:
        device.load()
        frames = list(device.depth(pictures))
    for frame, result in zip(frames, pipeline.stream(pictures), strict=True):
        values = to_bytes(result.codes[::-1], depth_format, width, shift)  # the bottom row leaves first
        codes = from_bytes(values, size).reshape(shape)[::-1] << shift
        np.testing.assert_array_equal(frame.codes, codes)
        assert frame.contact.record[3:-1] == result.contact.record[3:-1]


def test_flags_of_frames() -> None:
    """Send pictures in a light that changes, some of them too deep, with a dark corner."""
    sample = td.sample("ball")
    reference, brighter = sample.reference.copy(), np.rint(sample.image * 1.1).clip(0, 255).astype(np.uint8)
    reference[:60, :80] = 1
    pictures = [reference, sample.image, brighter, brighter]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pipeline = td.Pipeline(sample.sensor, reference, grid=GRID, model="quadratic", depth_range_mm=0.5)
        with td.Device("sim", pipeline) as device:
            device.load()
            frames = list(device.depth(iter(pictures)))
        results = list(pipeline.stream(pictures))
    for frame, result in zip(frames, results, strict=True):
        require_flags(frame.flags, result)
    assert [frame.flags.light_moves for frame in frames] == [False, False, True, False]
    assert not frames[0].flags.depth_clipped
    assert frames[1].flags[:3] == (True, True, True)
    assert frames[0].flags.dark


@needs_real_data
def test_real_presses() -> None:
    """Load, capture reference and zero offset, send presses of a real sensor: each frame is that of the package."""
    folder = FOLDER / "gelslam"
    background = folder / "background.png"
    balls = [sorted(map(str, folder.glob(f"{ball}mm/*.png")))[: PRESSES // 2] for ball in ("6.310", "9.500")]
    presses = [*balls[0], *balls[1]]
    pipeline = td.Pipeline(td.load("gelsight-mini"), background)
    captured = td.Pipeline(td.load("gelsight-mini"), background)
    captured.capture_reference(background)
    captured.capture_zero(background)
    with td.Device("sim", pipeline) as device:
        device.load()
        device.capture_reference(background)
        device.capture_zero(background)
        device.self_test()
        frames = list(device.depth(iter(presses)))
    assert [frame.lost for frame in frames] == [0] * PRESSES
    for frame, result in zip(frames, captured.stream(presses), strict=True):
        assert seen(frame) == seen(result)
        require_flags(frame.flags, result)
