# SPDX-License-Identifier: Apache-2.0
"""A device with the pipeline on a host: calibration, captures, thresholds, registers, and depth frames in mm."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, MutableMapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from typing import cast

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, Part, is_number, one_of, require_flag, warn
from tactile_depth.base.npy import Bytes
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2
from tactile_depth.chip.gradient.flat_field import captured_gains, reference_gains, require_light
from tactile_depth.chip.gradient.reference_capture import largest_log2_frames
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormatName, span_of
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.depth.pipeline import PICTURES, Pipeline, require_flat_field, require_zero_offset
from tactile_depth.depth.result import Recorder, thresholds_of
from tactile_depth.device import captures
from tactile_depth.device.addresses import open_channel
from tactile_depth.device.channel import Arrival, Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.exchange import Exchange, camera_frames
from tactile_depth.device.frame import DeviceFrame
from tactile_depth.device.registers import Registers, read_words, write_words
from tactile_depth.device.status import COUNTERS, DeviceStatus
from tactile_depth.device.tables import load_tables, require_same, wait_in_use, window_doubt
from tactile_depth.pictures.doubts import UnusablePicture
from tactile_depth.pictures.frames import GREY
from tactile_depth.pictures.picture_check import check_picture
from tactile_depth.pictures.pictures import Picture, Pictures, is_array
from tactile_depth.pictures.reader import power_of_two_of
from tactile_depth.pictures.reference_check import check_reference, check_zero

CAPTURED = 8
"""Pictures of the device's camera that a capture takes the mean of."""


class Device(AbstractContextManager["Device"]):
    """Device with the pipeline, on a serial line, in a simulator or in a Zynq. Several may be open at once.

    After a DeviceError the next call works if its cause is gone. A device that was unplugged is opened anew. After a
    reset of the device, or a loss of its power, call `load` again: its settings are those of power-up.

    Parameters
    ----------
    address : str
        `serial:PATH`, `serial:PATH@BAUD` (3000000 by default) or `serial:NUMBER`, the USB serial number; a bare
        `/dev/ttyUSB0` is a path. `sim` simulates the device of the pipeline's configuration, from a clone of the
        repository, and `sim:pins` with the pins of its serial line. `uio:REGISTERS,VDMA,BUFFER` names the files of a
        Zynq whose camera gives the pictures; a bare `uio` is `uio:/dev/uio0,/dev/uio1,/dev/udmabuf0`.
    pipeline : Pipeline
        Pipeline with the arithmetic of the hardware. Its configuration is that of the device; it gives calibration,
        reference, zero offset, thresholds and units.
    depth_format : str
        Format in which the device sends depth. `words`, the default: whole depth codes. `16-bit`: codes whose lowest
        bits are rounded away, so that 16 are left. `averaged`: in 16 bits the mean of 2 x 2 codes, half the rows and
        columns. Contacts are those of the whole grid in each. `uio` has words alone.

    Attributes
    ----------
    address : str
    pipeline : Pipeline
    depth_format : str
    registers : mapping of str to int
        Registers of the device by name, as `registers["FRAMES_OUT"]`, and their fields, as
        `registers["CONTROL.hold_contact"]`. Each access goes to the device; assignment writes.
        docs/generated/registers.md lists them. A register with a signed value gives a signed number.

    Raises
    ------
    InputError
        The address, the pipeline or the format is not accepted, there is no such port, or the device has another
        configuration, or speaks another version of the link.
    DeviceError
        The port is in use or cannot be opened, the device does not answer, or pyserial or the simulator is missing.
    """

    def __init__(self, address: str, pipeline: Pipeline, *, depth_format: DepthFormatName = "words") -> None:
        if not isinstance(pipeline, Pipeline):
            problem = f" is a {type(pipeline).__name__}"
            raise InputError(Argument("pipeline"), problem, accepted="a Pipeline, as Pipeline(sensor, ..) makes it")
        if pipeline.arithmetic != "chip":
            arithmetic = Argument("arithmetic", pipeline.arithmetic)
            remedy = ("make the pipeline with ", Argument("arithmetic", "chip"))
            raise InputError(arithmetic, ": a device has the arithmetic of the hardware", remedy=remedy)
        one_of(Argument("depth_format", depth_format), tuple(FORMATS))
        self.address, self.pipeline, self.depth_format = address, pipeline, depth_format
        self.registers: MutableMapping[str, int] = Registers(self._open_line)
        self._thresholds_mm = {
            "touch_mm": pipeline.threshold_mm,
            "release_mm": pipeline.threshold_mm,
            "area_mm": pipeline.area_threshold_mm,
        }
        self._settings = pipeline.settings(**self._thresholds_mm)
        self._reference_gains: np.ndarray | None = None  # of the device, if they are known
        self._is_closed = self._is_window_checked = False
        self._line: Channel | None = self._connect()

    def __exit__(self, *raised: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the link. Further calls raise DeviceError; closing twice does nothing."""
        self._is_closed = True
        line, self._line = self._line, None
        if line is not None:
            line.close()

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
        config = self.pipeline.config
        with self._open_line() as line:
            require_same(line, self.pipeline)
            with Exchange(line) as exchange:

                def untouched() -> None:
                    exchange.depth_of(self._untouched)

                load_tables(line, self.pipeline, untouched)
                self._settings = self.pipeline.settings(**self._thresholds_mm)
                write_words(line, list(thresholds_of(self._settings).items()))
                wait_in_use(line, untouched)
        self._reference_gains = reference_gains(self.pipeline.sensor, config) if config.flat_field else None

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
        config = self.pipeline.config
        require_flat_field(config)
        largest = largest_log2_frames(config)
        if pictures is None:
            self._capture_of_camera("reference", frames, largest)
            self._reference_gains = None
            return
        images, taken = self.pipeline.reader.reference(pictures, PICTURES, largest)
        check_reference(self.pipeline.reader.sensor, images, PICTURES, self.pipeline.reader.share)
        gains = captured_gains(taken, config)
        require_light(gains, config, PICTURES)
        with self._open_line() as line:
            captures.capture_of_pictures(line, "reference", taken)
        self._reference_gains = gains

    def capture_zero(self, pictures: Pictures | None = None, *, frames: int = CAPTURED) -> None:
        """Take the depth of pictures without contact as the zero offset, in the device.

        For parameters and errors see `capture_reference`.
        """
        config = self.pipeline.config
        require_zero_offset(config)
        if pictures is None:
            self._capture_of_camera("zero", frames, LARGEST_LOG2)
            return
        taken = np.stack([frame for _, frame in self.pipeline.reader.pictures(pictures, PICTURES)[0]])
        power_of_two_of(len(taken), LARGEST_LOG2, PICTURES)
        check_zero(taken, self.pipeline.rest, PICTURES)
        gains = None
        if config.light_gains and self._reference_gains is not None:
            gains = captures.gains_of(taken, self._reference_gains, config)
        with self._open_line() as line:
            captures.capture_of_pictures(line, "zero", taken, gains)

    def set_thresholds(
        self, touch_mm: float | None = None, release_mm: float | None = None, area_mm: float | None = None
    ) -> None:
        """Set thresholds, in mm, and the least area of a contact, which follows from `touch_mm`; `load` keeps them.

        Those that are None stay as they are.

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
        release_mm = touch_mm if release_mm is None else release_mm
        given = {"touch_mm": touch_mm, "release_mm": release_mm, "area_mm": area_mm}
        lsb_mm = self.pipeline.depth_lsb_mm
        for name, depth_mm in given.items():
            lowest_mm = lsb_mm if name == "touch_mm" else 0.0
            if depth_mm is not None and not (is_number(depth_mm) and lowest_mm <= depth_mm < self._limit_mm):
                accepted = f"a depth above 0, up to {self._limit_mm:.3g} mm"
                raise InputError(Argument(name, depth_mm), accepted=accepted)
        thresholds_mm = self._thresholds_mm | {name: depth for name, depth in given.items() if depth is not None}
        settings = self.pipeline.settings(**thresholds_mm)
        if settings.off_threshold > settings.on_threshold:
            touch = settings.on_threshold * lsb_mm
            raise InputError(Argument("release_mm", release_mm), accepted=f"at most touch_mm, {touch:.3g}")
        with self._open_line() as line:
            write_words(line, list(thresholds_of(settings).items()))
        self._thresholds_mm, self._settings = thresholds_mm, settings

    def depth(
        self, pictures: Pictures | Iterable[Picture] | None = None, *, stream: bool = True
    ) -> Iterator[DeviceFrame]:
        """Send pictures and give the depth frame of each; without pictures, give what the device's camera gives.

        The frames of pictures are those of `pipeline.stream(pictures)`: light gains begin at 1 and follow the
        pictures. With `stream=False` they are those of `pipeline(pictures)`: each picture stands for itself.

        A picture whose depth gets lost on the line gives no frame and is counted in `lost`; `DeviceFrame.picture` tells
        which one is missing. The frames of a camera do not end.

        Parameters
        ----------
        pictures : as for a call of a pipeline, or an iterable of pictures, optional
            Full pictures of the sensor's camera.
        stream : bool
            False: the host computes the light gains of each picture, and sends it twice, so that its contact does not
            depend on the picture before. The device must have a reference that the host knows: by `load`, or by
            `capture_reference` with pictures.

        Raises
        ------
        InputError
            A picture is not accepted.
        DeviceError
        """
        require_flag(Argument("stream", stream))
        has_gains = self.pipeline.config.light_gains
        if not stream and (pictures is None or (has_gains and self._reference_gains is None)):
            problem = ": without pictures" if pictures is None else ": the reference of the device is not known"
            remedy = "give pictures" if pictures is None else "call load() first, or capture_reference(pictures)"
            raise InputError(Argument("stream", stream), problem, remedy=remedy)
        with ExitStack() as stack:
            line = stack.enter_context(self._open_line())
            if pictures is None:
                self._check_window(line)
                yield from (self._frame(arrival, None) for arrival in camera_frames(line))
                return
            exchange = stack.enter_context(Exchange(line))
            if has_gains and not stream:
                stack.enter_context(captures.held_light(line))
            elif has_gains:
                captures.write_gains(line, [captures.UNITY] * len(captures.GAINS))
            for index, pixels in self._usable(pictures, line):
                if has_gains and not stream:
                    assert self._reference_gains is not None
                    gains = captures.gains_of(pixels[None], self._reference_gains, self.pipeline.config)
                    captures.write_gains(line, gains[0])
                arrival = exchange.depth_of(pixels)
                if arrival is not None and not stream:
                    arrival = exchange.depth_of(pixels)
                if arrival is not None:
                    yield self._frame(arrival, index)

    def status(self) -> DeviceStatus:
        """Return the state of the device and of the link."""
        with self._open_line() as line:
            status = line.ask()
            words = read_words(line, [*COUNTERS, "STATUS"])
            counts = line.bad_packets, line.delivered, line.lost
        levels = REGISTERS["STATUS"].unpack(words.pop("STATUS"))
        *grid, _ = status.shape
        sent = status.resets, status.sent, status.skipped, status.bad_packets
        return DeviceStatus._make(
            (*grid, *sent, *counts, *words.values(), bool(levels["touching"]), bool(levels["busy"]))
        )

    # The line.

    def _connect(self) -> Channel:
        """Open the line, and compare the device with the pipeline."""
        line = open_channel(self.address, self.pipeline, self.depth_format)
        try:
            grid = line.status.rows, line.status.columns
            if grid != tuple(self.pipeline.grid):
                problem = f", but the device has {grid}, rows and columns"
                remedy = ("make the pipeline with ", Argument("grid", grid), ", or build the device for it")
                raise InputError(Argument("grid", tuple(self.pipeline.grid)), problem, remedy=remedy)
            require_same(line, self.pipeline)
        except BaseException:
            line.close()
            raise
        return line

    @contextmanager
    def _open_line(self) -> Iterator[Channel]:
        """Give the line, opened anew if it was gone; raise what has happened since the last call."""
        if self._is_closed:
            raise DeviceError(f"{self.address} is closed", remedy="open it with Device(..)")
        if self._line is None:
            self._line = self._connect()
        line = self._line
        try:
            line.check()
            yield line
        except Exception:
            if line.broken:
                self._line = None
                line.close()
            raise

    # Pictures.

    @property
    def _untouched(self) -> Bytes:
        """Picture of the untouched sensor on the grid, uint8 (rows, columns, 3); grey for a pipeline without one."""
        reference = self.pipeline.sensor.reference
        if reference is None:
            return np.full((*self.pipeline.grid, 3), GREY, np.uint8)
        return reference.reshape(-1, *self.pipeline.grid, 3)[-1]

    def _usable(self, pictures: Pictures | Iterable[Picture], line: Channel) -> Iterator[tuple[int, Bytes]]:
        """Give pictures on the grid, each with its number; leave out and count what gives no right depth."""
        rest, failed = self.pipeline.rest, False
        for index, (name, frame) in enumerate(self._on_grid(pictures)):
            try:
                check_picture(frame, rest, name)
            except UnusablePicture as error:
                if not failed:
                    warn(InputWarning("left out and counted: ", *error.parts))
                failed = True
                line.count_lost()
                continue
            yield index, frame

    def _on_grid(self, pictures: Pictures | Iterable[Picture]) -> Iterator[tuple[Part, Bytes]]:
        """Give pictures on the grid, each with its name; those of an iterable one by one."""
        if is_array(pictures) or isinstance(pictures, str | Path | Sequence) or not isinstance(pictures, Iterable):
            yield from self.pipeline.reader.pictures(cast(Pictures, pictures), PICTURES)[0]
            return
        for index, picture in enumerate(pictures):
            yield from self.pipeline.reader.pictures(picture, f"picture {index}")[0]

    def _capture_of_camera(self, table: str, count: int, largest_log2: int) -> None:
        accepted = [1 << power for power in range(largest_log2 + 1)]
        if count not in accepted:
            raise InputError(Argument("frames", count), accepted=[str(number) for number in accepted])
        with self._open_line() as line:
            self._check_window(line)
            captures.capture_of_camera(line, table, count, lambda: line.send(self._untouched))

    def _check_window(self, line: Channel) -> None:
        """Warn once if what the device takes of its camera's pictures is not what the calibration is for."""
        if not self._is_window_checked and (doubt := window_doubt(line, self.pipeline)):
            warn(doubt)
        self._is_window_checked = True

    def _frame(self, arrival: Arrival, picture: int | None) -> DeviceFrame:
        pipeline, frame = self.pipeline, arrival.frame
        recorder = Recorder.of(pipeline.config, self._settings)
        pitch_mm = span_of(frame.depth_format) * pipeline.pixel_pitch_mm
        units = pipeline.depth_lsb_mm, pitch_mm, pipeline.sensor.pixel_aspect
        counts = frame.number, arrival.time_s, arrival.lost
        form = self.depth_format, (pipeline.config.rows, pipeline.config.columns)
        return DeviceFrame(frame.codes, frame.record, *counts, picture, recorder, *units, *form)

    @property
    def _limit_mm(self) -> float:
        """Largest depth code in mm."""
        return ((1 << self.pipeline.config.depth.width - 1) - 1) * self.pipeline.depth_lsb_mm
