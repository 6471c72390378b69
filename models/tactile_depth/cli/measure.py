# SPDX-License-Identifier: Apache-2.0
"""Measures a calibration through a device: what it reads on the presses, beside what the package reads."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tactile_depth.base.errors import InputError, InputWarning, counted, warn
from tactile_depth.calibrate.press_pictures import PressPictures
from tactile_depth.calibrate.presses import GridPresses, View
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.addresses import SIM, open_channel
from tactile_depth.device.device import Device
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.frame import DeviceFrame
from tactile_depth.pictures.doubts import UnusablePicture
from tactile_depth.sensor.synthetic import synthetic

DEVICE = "device:"
TRIES = 3  # for a frame that gets lost on the line
NAME_WIDTH = 22


class Measured(NamedTuple):
    """A press as device and package read it: height RMS in mm of each, and touching."""

    device_mm: float
    package_mm: float
    is_touching: bool


def address_of(word: str) -> str:
    """Return the address of a device from `device:ADDRESS`; raise InputError if it is none."""
    address = word.removeprefix(DEVICE)
    if address == word or not address:
        raise InputError(f"{word}: no device: give {DEVICE}/dev/ttyUSB0, {DEVICE}serial:NUMBER or {DEVICE}sim")
    return address


def grid_of(address: str) -> tuple[int, int] | None:
    """Return rows and columns of a device that can be reached; None for a simulator, which is built for a pipeline.

    Raises
    ------
    InputError
        There is no such port, or the device speaks another version of the link.
    DeviceError
        The port is in use, or the device does not answer.
    """
    if address.partition(":")[0] == SIM:
        return None
    channel = open_channel(address, Pipeline(synthetic()))
    channel.close()
    return channel.status.rows, channel.status.columns


def measure(address: str, pipeline: Pipeline, presses: GridPresses, pictures: PressPictures) -> None:
    """Load a calibration into a device, send background and presses, and print what the device reads on each.

    Parameters
    ----------
    pipeline : Pipeline
        With the calibration, fitted to the presses, and the background as its reference.
    presses, pictures : GridPresses, PressPictures
        The presses that were fitted, and their pictures.

    Raises
    ------
    InputError
        The device has another configuration.
    DeviceError
        It does not answer, or frames get lost again and again.
    """
    background = pictures.background
    rows, columns = pipeline.grid
    print(f"device {address}: {pipeline.config.gradient_model}, {columns} x {rows}", flush=True)
    named = {press.name: press for press in pictures.presses}
    results: dict[str, Measured] = {}
    with Device(address, pipeline) as device:
        device.load()
        device.capture_reference(background)
        if pipeline.config.zero_offset:
            device.capture_zero(background)
        print("background sent, reference and zero offset captured", flush=True)
        print(f"{'press':<{NAME_WIDTH}}  {'touching':<10}height RMS, um: device  package")
        for view in presses.views:
            name = view.press.name
            if (read := _read(device, pipeline, view, pictures.image(named[name]))) is None:
                print(f"{name[-NAME_WIDTH:]:<{NAME_WIDTH}}  gives no depth, as a warning says", flush=True)
                continue
            results[name] = read
            touching = "yes" if read.is_touching else "no"
            numbers = f"{1000 * read.device_mm:>22.1f}{1000 * read.package_mm:>9.1f}"
            print(f"{name[-NAME_WIDTH:]:<{NAME_WIDTH}}  {touching:<10}{numbers}", flush=True)
    print(summary(presses.views, results))
    untouched = [name for name, read in results.items() if not read.is_touching]
    if untouched:
        warn(InputWarning(f"the device sees no contact in {', '.join(untouched)}"))


def summary(views: Sequence[View], results: dict[str, Measured]) -> str:
    """Return the line on all presses."""
    whole = [results[view.press.name] for view in views if view.is_whole and view.press.name in results]
    if not whole:
        return "the device gave depth of no whole press"
    device, package = 1000 * np.mean([(read.device_mm, read.package_mm) for read in whole], axis=0)
    return f"height RMS of {counted(len(whole), 'whole press')}: device {device:.1f} um, package {package:.1f} um"


def _read(device: Device, pipeline: Pipeline, view: View, picture: np.ndarray) -> Measured | None:
    """Send the picture of a press; return None if it gives no depth."""
    try:
        result = pipeline(picture, name=view.press.name)
    except UnusablePicture as error:
        warn(InputWarning("left out: ", *error.parts))
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputWarning)  # those of the pipeline have been told
        frame = _sent(device, picture)
    pitch_mm = pipeline.pixel_pitch_mm
    device_mm, package_mm = (view.press.height_rms(each.depth_mm / pitch_mm) * pitch_mm for each in (frame, result))
    return Measured(device_mm, package_mm, frame.contact.touching)


def _sent(device: Device, picture: np.ndarray) -> DeviceFrame:
    """Return the depth frame of a picture. Raises DeviceError if it gets lost again and again."""
    for _ in range(TRIES):
        for frame in device.depth(picture):
            return frame
    problem = f"{device.address}: the depth of a picture got lost {TRIES} times"
    raise DeviceError(problem, remedy="use a shorter cable, or a lower baud rate")
