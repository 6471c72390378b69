# SPDX-License-Identifier: Apache-2.0
"""A device with the pipeline on a host: calibration, captures, thresholds, registers, and depth frames in mm."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, MutableMapping
from contextlib import AbstractContextManager

from tactile_depth.device.frame import DeviceFrame
from tactile_depth.device.status import DeviceStatus
from tactile_depth.pictures import Picture, Pictures
from tactile_depth.pipeline import Pipeline

CAPTURED = 8
"""Pictures of the device's camera that a capture takes the mean of."""


class Device(AbstractContextManager["Device"]):
    """Device with the pipeline, on a serial line or in a simulator. Several may be open at once.

    After a DeviceError the next call works if its cause is gone. A device that was unplugged is opened anew. After a
    reset of the device, or a loss of its power, call `load` again: its settings are those of power-up.

    Parameters
    ----------
    address : str
        `serial:PATH`, `serial:PATH@BAUD` (3000000 by default) or `serial:NUMBER`, the USB serial number; a bare
        `/dev/ttyUSB0` is a path. `sim` simulates the device of the pipeline's configuration, from a clone of the
        repository, and `sim:pins` with the pins of its serial line.
    pipeline : Pipeline
        Pipeline with the arithmetic of the hardware. Its configuration is that of the device; it gives calibration,
        reference, zero offset, thresholds and units.

    Attributes
    ----------
    address : str
    pipeline : Pipeline
    registers : mapping of str to int
        Registers of the device by name, as `registers["FRAMES_OUT"]`, and their fields, as
        `registers["CONTROL.hold_contact"]`. Each access goes to the device; assignment writes. docs/registers.md lists
        them. A register with a signed value gives a signed number.

    Raises
    ------
    InputError
        The address or the pipeline is not accepted, there is no such port, or the device has another configuration, or
        speaks another version of the link.
    DeviceError
        The port is in use or cannot be opened, the device does not answer, or pyserial or the simulator is missing.
    """

    registers: MutableMapping[str, int]

    def __init__(self, address: str, pipeline: Pipeline) -> None:
        raise NotImplementedError

    def __exit__(self, *raised: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the link. Further calls raise DeviceError; closing twice does nothing."""
        raise NotImplementedError

    def load(self) -> None:
        """Write calibration, reference, zero offset and thresholds of the pipeline, and wait until they are in use.

        Tables take effect with the next picture. If no camera gives one, a picture of the untouched sensor is sent,
        whose depth is dropped. Captures of the device are replaced.

        Raises
        ------
        InputError
            The device has another configuration than the pipeline.
        DeviceError
        """
        raise NotImplementedError

    def capture_reference(self, pictures: Pictures | None = None, *, frames: int = CAPTURED) -> None:
        """Take the mean of pictures without contact as the reference, in the device.

        The zero offset does not change: call `capture_zero` next. With pictures the device's reference is then the one
        that `pipeline.capture_reference` computes of them; the pipeline itself does not change.

        Parameters
        ----------
        pictures : as for a call of a pipeline, optional
            1, 2, 4, .. pictures to be sent; by default the device's camera gives them.
        frames : int
            1, 2, 4, .. pictures of the device's camera.

        Raises
        ------
        InputError
            The number of pictures is not accepted, they are no reference, or the pipeline takes colours as sent.
        DeviceError
        """
        raise NotImplementedError

    def capture_zero(self, pictures: Pictures | None = None, *, frames: int = CAPTURED) -> None:
        """Take the depth of pictures without contact as the zero offset, in the device.

        For parameters and errors see `capture_reference`.
        """
        raise NotImplementedError

    def set_thresholds(
        self, touch_mm: float | None = None, release_mm: float | None = None, area_mm: float | None = None
    ) -> None:
        """Set thresholds, in mm; those that are None stay as they are. `load` keeps them.

        Parameters
        ----------
        touch_mm : float
            Depth above which a pixel touches, and which heights count as touched: as `threshold_mm` of a pipeline.
        release_mm : float
            Depth above which a pixel counts as touched while something touches, at most `touch_mm`. By default, if
            `touch_mm` is given, the same.
        area_mm : float
            Depth above which a pixel is in the area of the contact: as `area_threshold_mm` of a pipeline.

        Raises
        ------
        InputError
            A threshold is not accepted.
        DeviceError
        """
        raise NotImplementedError

    def depth(self, pictures: Pictures | Iterable[Picture] | None = None) -> Iterator[DeviceFrame]:
        """Send pictures and give the depth frame of each; without pictures, give what the device's camera gives.

        The frames of pictures are those of `pipeline.stream(pictures)`: light gains begin at 1 and follow the
        pictures. A picture whose depth gets lost on the line gives no frame and is counted in `lost`;
        `DeviceFrame.picture` tells which one is missing. The frames of a camera do not end.

        Parameters
        ----------
        pictures : as for a call of a pipeline, or an iterable of pictures, optional
            Full pictures of the sensor's camera, or pictures on the grid.

        Raises
        ------
        InputError
            A picture is not accepted.
        DeviceError
        """
        raise NotImplementedError

    def status(self) -> DeviceStatus:
        """Return the state of the device and of the link."""
        raise NotImplementedError
