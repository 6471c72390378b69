# SPDX-License-Identifier: Apache-2.0
"""A device with the pipeline on a host: calibration, captures, thresholds, registers, and depth frames in mm."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, MutableMapping
from contextlib import AbstractContextManager, closing, contextmanager, nullcontext
from itertools import chain

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, is_number, one_of, require_flag, warn
from tactile_depth.base.npy import Bytes
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2
from tactile_depth.chip.gradient.frame_marks import slope_limit
from tactile_depth.chip.gradient.reference_capture import largest_log2_frames
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormatName, span_of
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.registers.table_signatures import NOT_KNOWN
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.depth.result import Recorder, Result, thresholds_of
from tactile_depth.depth.twin import PICTURES, require_flat_field, require_zero_offset
from tactile_depth.device import captures, held, sent
from tactile_depth.device.addresses import open_channel
from tactile_depth.device.camera_frame import dead_pixels, of_camera
from tactile_depth.device.channel import Arrival, Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.exchange import Exchange, camera_frames, last_begun
from tactile_depth.device.frame import DeviceFrame, seen_as
from tactile_depth.device.registers import Registers, read_words, write_words
from tactile_depth.device.self_test import expected_signature, signature_of
from tactile_depth.device.status import DeviceStatus, status_of
from tactile_depth.device.tables import camera_doubts, load_tables, require_same, wait_in_use
from tactile_depth.pictures.doubts import Warned, tell
from tactile_depth.pictures.frames import GREY
from tactile_depth.pictures.pictures import Picture, Pictures
from tactile_depth.sensor.sensor import TOO_DARK

LIGHT, DARK_LEVEL = REGISTERS["LIGHT"], "DARK_LEVEL"
CAPTURED = 8
"""Pictures of the device's camera that a capture takes the mean of."""


class Device(AbstractContextManager["Device"]):
    """Device with the pipeline, on a serial line, in a simulator or in a Zynq. Several may be open at once.

    After a DeviceError the next call works if its cause is gone. A device that was unplugged is opened anew. After a
    reset of the device, or a loss of its power, call `load` again: its settings are those of power-up. Other tables and
    settings than those of the pipeline, or of the device's own captures, are refused.

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

    Warns
    -----
    InputWarning
        The reference or the zero offset in use comes from a capture before this program: it holds for the camera alone.
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
        self._tables = held.signatures_of(pipeline)  # that the device is to use
        self._loaded = self._tables.copy()  # of the pipeline at the last load, or capture in the device
        self._unseen: dict[str, captures.Unseen] = {}  # those of a capture whose pictures it did not send
        self._told = Warned()  # of the device's camera
        self._is_closed = self._is_busy = False
        self._last_old = 0  # number of the last frame of the device's camera that may have other tables or thresholds
        self._is_set = False  # the settings are those of this program
        self._dark_level = TOO_DARK  # of the device's camera; 0 for pictures that are sent, which the host checks
        self._line: Channel | None = self._connect()
        self._use(pipeline.copy())
        try:
            self._accept_captures(self._line)
        except BaseException:
            self.close()
            raise

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
            The device has another configuration than the pipeline, or a `depth` has not ended.
        DeviceError
        """
        with self._alone(), self._open_line() as line:
            require_same(line, self.pipeline)
            self._use(self.pipeline.copy())
            self._tables = held.signatures_of(self.pipeline)
            self._loaded = self._tables.copy()
            self._unseen.clear()
            write_words(line, [(LIGHT.name, LIGHT.pack(follow=1))])
            with Exchange(line) as exchange, captures.unity_light(line):

                def untouched() -> None:
                    exchange.depth_of(self._untouched)

                load_tables(line, self.pipeline, untouched)
                self._settings = self.pipeline.settings(**self._thresholds_mm)
                write_words(line, list(self._words.items()))
                wait_in_use(line, untouched)
            self._is_set = True
            held.require_tables(line, self._tables)

    def capture_reference(self, pictures: Pictures | None = None, *, frames: int = CAPTURED) -> None:
        """Take the mean of pictures without contact as the reference, in the device.

        The zero offset does not change: call `capture_zero` next. With pictures the device's reference is then the one
        that `pipeline.capture_reference` computes of them; the pipeline itself does not change. Without
        pictures the table that the device's camera gave is read back and checked.

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
        require_flat_field(self.pipeline.config)
        if pictures is None:
            self._capture_of_camera("reference", frames, largest_log2_frames(self.pipeline.config))
            return
        twin = self._twin.copy()
        twin.capture_reference(pictures)
        taken = twin.sensor.reference
        assert taken is not None
        with self._capturing("reference", twin) as line:
            captures.capture_of_pictures(line, "reference", taken)

    def capture_zero(self, pictures: Pictures | None = None, *, frames: int = CAPTURED) -> None:
        """Take the depth of pictures without contact as the zero offset, in the device.

        Those of the device's camera are taken once its light gains stand still. For parameters and errors see
        `capture_reference`.
        """
        require_zero_offset(self.pipeline.config)
        if pictures is None:
            self._capture_of_camera("zero", frames, LARGEST_LOG2)
            return
        self._require_seen(self._unseen.keys() - {"zero"})
        twin = self._twin.copy()
        twin.capture_zero(pictures)
        taken = np.stack([frame for _, frame in twin.reader.pictures(pictures, PICTURES)[0]])
        gains = twin.twin.light(taken)
        with self._capturing("zero", twin) as line:
            captures.capture_of_pictures(line, "zero", taken, None if gains is None else gains.tolist())

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
        limit_mm = ((1 << self.pipeline.config.depth.width - 1) - 1) * lsb_mm
        for name, depth_mm in given.items():
            lowest_mm, least = (lsb_mm, "above 0, up") if name == "touch_mm" else (0.0, "of 0")
            if depth_mm is not None and not (is_number(depth_mm) and lowest_mm <= depth_mm < limit_mm):
                raise InputError(Argument(name, depth_mm), accepted=f"a depth {least} to {limit_mm:.3g} mm")
        thresholds_mm = self._thresholds_mm | {name: depth for name, depth in given.items() if depth is not None}
        settings = self.pipeline.settings(**thresholds_mm)
        if settings.off_threshold > settings.on_threshold:
            touch = settings.on_threshold * lsb_mm
            raise InputError(Argument("release_mm", release_mm), accepted=f"at most touch_mm, {touch:.3g}")
        with self._open_line() as line:
            write_words(line, list(thresholds_of(settings).items()))
            self._thresholds_mm, self._settings = thresholds_mm, settings
            self._last_old = last_begun(line)

    def depth(
        self, pictures: Pictures | Iterable[Picture] | None = None, *, stream: bool | None = None
    ) -> Iterator[DeviceFrame]:
        """Send pictures and give the depth frame of each; without pictures, give what the device's camera gives.

        Pictures as a call of a pipeline takes them give the frames of `pipeline(pictures)`: each stands for itself. The
        host sets the light gains of each, and sends it twice, so that its contact does not depend on the one before.
        Those of an iterator, as of a camera, give the frames of `pipeline.stream(pictures)`: light gains begin at 1 and
        follow the pictures. The host computes the same and compares; frames have the warnings of the pipeline.

        A picture whose depth gets lost on the line gives no frame and is counted in `lost`; `DeviceFrame.picture` tells
        which one is missing. The frames of a camera do not end; their warnings are those that the flags of the device
        and the depth give. Those of before the call, or `set_thresholds`, are left out.

        Parameters
        ----------
        pictures : as for a call of a pipeline, or an iterable of pictures, optional
            Full pictures of the sensor's camera.
        stream : bool, optional
            True: the pictures are a stream, whatever holds them. False: each stands for itself.

        Raises
        ------
        InputError
            A picture is not accepted, or another `depth` has not ended. A stream leaves out and counts a picture that
            is refused once one was accepted.
        DeviceError
            The device needs `load`: it has other tables or settings, or computes another depth. Or it does not answer.

        Warns
        -----
        InputWarning
            The heights of a picture are uncertain; of a stream once for each kind of doubt. The reference is not from
            the device's own camera, once.
        """
        if stream is not None:
            require_flag(Argument("stream", stream))
        if pictures is None and stream is False:
            raise InputError(Argument("stream", stream), ": without pictures", remedy="give pictures")
        with self._alone(), self._open_line() as line:
            held.require_same_pipeline(self.pipeline, self._loaded, self._tables, self._unseen)
            light = self._require_held(line)
            self._set_dark_level(line, is_camera=pictures is None)
            if pictures is None:
                doubts = [*camera_doubts(line, self.pipeline), *held.reference_doubts(self.pipeline, self._unseen)]
                tell(self._told.new(doubts))
                warned, known = Warned(), (*self._twin.doubts, *chain(*(each.doubts for each in self._unseen.values())))
                self._last_old = last_begun(line)
                for arrival in camera_frames(line, lambda: self._last_old, lambda: self._require_held(line)):
                    yield of_camera(self._frame(arrival), arrival.frame.shift, self._twin, known, self._dead, warned)
                return
            self._require_seen(self._unseen)
            if stream or (stream is None and not sent.are_whole(pictures)):
                frames = sent.streamed(line, self._twin, pictures, light)
            else:
                frames = sent.single(line, self._twin, pictures)
            with closing(frames), self._restoring():
                yield from (self._frame(arrival, index, result) for index, arrival, result in frames)

    def self_test(self) -> None:
        """Let the device compute the depth of a picture of its own, and compare that with the pipeline's.

        It finds entries of tables and logic that differ; the pictures of a camera wait for the time of one.

        Raises
        ------
        DeviceError
            The device computes something else, or it does not answer.
        """
        with self._open_line() as line:
            held.require_tables(line, self._tables)
            self._require_seen(name for name, each in self._unseen.items() if each.entries is None)
            dark_level = read_words(line, [DARK_LEVEL])[DARK_LEVEL]
            with self._restoring():
                shown = signature_of(line)
        wanted = expected_signature(self._twin, self._unseen, dark_level)
        if shown != wanted:
            problem = f"the device computes something else: SELF_TEST is {shown:#010x}, not {wanted:#010x}"
            raise DeviceError(problem, remedy="call load(); if it stays, the device is built differently or faulty")

    def status(self) -> DeviceStatus:
        """Return the state of the device and of the link."""
        with self._open_line() as line:
            return status_of(line)

    # The line.

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Raise InputError while `depth` gives frames, or tables change: each would take frames of the other."""
        if self._is_busy:
            raise InputError("a depth(), load() or capture has not ended", remedy="end its loop, or close() it")
        self._is_busy = True
        try:
            yield
        finally:
            self._is_busy = False

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

    def _capture_of_camera(self, table: str, count: int, largest_log2: int) -> None:
        accepted = [1 << power for power in range(largest_log2 + 1)]
        if count not in accepted:
            raise InputError(Argument("frames", count), accepted=[str(number) for number in accepted])
        with self._capturing(table) as line:
            tell(self._told.new(camera_doubts(line, self.pipeline)))

            def untouched() -> None:
                line.send(self._untouched)

            captures.capture_of_camera(line, table, count, untouched)
            entries = captures.read_captured(line, table, untouched)
            if table == "reference":
                doubts, self._dead = captures.check_reference_of_camera(self.pipeline, entries)
            else:
                doubts = captures.check_zero_of_camera(self.pipeline, entries)
            self._tables |= held.read_signatures(line, [table])
        self._unseen[table] = captures.Unseen(doubts, entries)

    @contextmanager
    def _capturing(self, table: str, twin: Pipeline | None = None) -> Iterator[Channel]:
        """Give the line for the capture of a table, which is then that of `twin`."""
        with self._alone(), self._open_line() as line:
            others = {name: word for name, word in self._tables.items() if name != table}
            held.require_tables(line, others, is_settled=False)
            self._tables[table] = NOT_KNOWN  # until it has ended
            self._set_dark_level(line, is_camera=twin is None)
            with self._restoring(), captures.unity_light(line) if table == "reference" else nullcontext():
                yield line
        self._loaded[table] = held.signatures_of(self.pipeline)[table]
        if twin is not None:
            self._use(twin)
            self._tables[table] = held.signatures_of(twin)[table]
            self._unseen.pop(table, None)

    @contextmanager
    def _restoring(self) -> Iterator[None]:
        """Let the next call write the settings anew if the device fails in the context, which changes some."""
        try:
            yield
        except (DeviceError, KeyboardInterrupt):
            self._is_set = False
            raise

    def _use(self, twin: Pipeline) -> None:
        """Take a pipeline for one with what the device holds."""
        self._twin, self._dead = twin, dead_pixels(twin.twin.tables.gains)

    def _accept_captures(self, line: Channel) -> None:
        """Take tables of the device's own captures, such as of an earlier program, for right, and say so."""
        if not (names := [name for name in held.captured(line) if name in self._tables]):
            return
        words = held.read_signatures(line, names)
        names = [name for name in names if words[name] not in (NOT_KNOWN, self._tables[name])]
        self._tables |= {name: words[name] for name in names}
        self._unseen |= dict.fromkeys(names, captures.Unseen())
        if names:
            problem = f"the {' and the '.join(names)} of the device comes from a capture before this program"
            warn(InputWarning(problem, remedy="call load() for those of the pipeline"))

    def _require_seen(self, tables: Iterable[str]) -> None:
        """Raise DeviceError if there are tables whose content this host does not know."""
        for table in sorted(tables):
            problem = f"the {table} of the device is not known to this program"
            raise DeviceError(problem, remedy="call load() first, or capture from pictures")

    def _require_held(self, line: Channel) -> int:
        """Return the word of `LIGHT`; raise DeviceError unless tables and other settings are those of this host.

        Settings of before this program are overwritten, once.
        """
        held.require_tables(line, self._tables)
        words = read_words(line, [*self._words, LIGHT.name])
        if not self._is_set:
            words |= self._words | {LIGHT.name: words[LIGHT.name] | LIGHT.field("follow").mask}
            write_words(line, list(words.items()))
            self._is_set = True
        differing = [
            name for name, word in self._words.items() if (words[name] ^ word) & REGISTERS[name].fields[0].mask
        ]
        if differing:
            problem = f"settings of the device are not those of this program ({', '.join(differing)})"
            raise DeviceError(problem, remedy="call load() first")
        return words[LIGHT.name]

    @property
    def _words(self) -> dict[str, int]:
        """Words of the registers that depth, contact and flags depend on."""
        steepest = slope_limit(self.pipeline.sensor, self.pipeline.config)
        return thresholds_of(self._settings) | {"SLOPE_LIMIT": steepest, DARK_LEVEL: self._dark_level}

    def _set_dark_level(self, line: Channel, is_camera: bool) -> None:
        """Let black pixels of the device's camera count as dark, and those of pictures that are sent as the host's."""
        level = TOO_DARK * is_camera
        if level != self._dark_level:
            write_words(line, [(DARK_LEVEL, level)])
            self._dark_level = level

    def _frame(self, arrival: Arrival, picture: int | None = None, result: Result | None = None) -> DeviceFrame:
        pipeline, frame = self.pipeline, arrival.frame
        recorder = Recorder.of(pipeline.config, self._settings)
        pitch_mm = span_of(frame.depth_format) * pipeline.pixel_pitch_mm
        units = pipeline.depth_lsb_mm, pitch_mm, pipeline.sensor.pixel_aspect
        counts = frame.number, arrival.time_s, arrival.lost
        form = self.depth_format, (pipeline.config.rows, pipeline.config.columns)
        made = DeviceFrame(frame.codes, frame.record, *counts, picture, recorder, *units, *form)
        return made if result is None else seen_as(made, result)
