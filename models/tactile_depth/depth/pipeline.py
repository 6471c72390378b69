# SPDX-License-Identifier: Apache-2.0
"""Computes depth maps in millimetres from camera pictures, as the hardware does or in double precision."""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from tactile_depth.base.errors import Argument, InputError, Part, is_whole, one_of, require_flag
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration, ExactConfiguration
from tactile_depth.chip.contact.contact_events import Settings
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2
from tactile_depth.chip.depth.zero_offset import exact_zero, no_zero
from tactile_depth.chip.gradient.flat_field import captured_gains, reference_gains, require_light
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.gradient.reference_capture import largest_log2_frames
from tactile_depth.chip.hardware_files import write_hardware
from tactile_depth.chip.limits import BOUNDARIES, LIGHT_GAIN, Boundary, Model, Solver, is_grid_of_hardware
from tactile_depth.chip.poisson.cores import fastest
from tactile_depth.chip.tactile_depth import zeroed
from tactile_depth.depth.make_words import Sources, make_words
from tactile_depth.depth.result import Recorder, Result, check_steps, require_thresholds, settings_of, thresholds_of
from tactile_depth.depth.stream import Stream, require_stream, timed, times
from tactile_depth.depth.twin import PICTURES, Twin, require_flat_field, require_zero_offset
from tactile_depth.pictures.blocks import Rest
from tactile_depth.pictures.doubts import Doubt, Warned, of_verdict, tell, unexplained
from tactile_depth.pictures.frames import camera_scale
from tactile_depth.pictures.light_check import doubts_of, least_clipped
from tactile_depth.pictures.picture_check import Checked, check_picture
from tactile_depth.pictures.pictures import Picture, Pictures, each_of
from tactile_depth.pictures.reader import Reader, default_grid, power_of_two_of
from tactile_depth.pictures.reference_check import check_reference, check_zero, earlier_zero
from tactile_depth.sensor.presets import AREA_THRESHOLD_MM, SENSOR, THRESHOLD_MM
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import Crop, shown

ARITHMETICS = ("chip", "float")
Arithmetic = Literal["chip", "float"]
REFERENCE = Argument("reference")


class Pipeline:
    """Pipeline for one sensor; a call with pictures returns their depth maps. Its attributes are read-only.

    Parameters
    ----------
    sensor : Sensor
        See `load`, `fit` and `sample`.
    reference : a picture or 2**k pictures, as for a call, optional
        Pictures of the sensor without contact. A real sensor needs them.
    crop : str, float or (width, height), optional
        What `reference` and pictures show of the sensor's full picture: `none`, all of it; a share, as 0.8; `gs_sdk` or
        `gsrobotics`, what that software leaves. By default they show what the calibration's pictures show
        (`sensor.view`). What they show beyond that is cut off; if they show less, depth is that of what they show. It
        completes a sensor whose view is unknown.
    grid : (rows, columns), optional
        Size of the depth map; by default `default_grid`, which covers the full picture. Columns are a power of two,
        except with `arithmetic="float"`, which takes any grid up to the size of the pictures.
    solver : str
        `tridiagonal` or `spectral`.
    boundary : str
        `neumann`, zero slope at the edge, or `dirichlet`, zero depth at the edge.
    model : str
        Gradient model, `lut`, `quadratic` or `cubic`; "": the best model of the sensor.
    data_width, coefficient_width, gain_width : int
        Bits of a stored word, of a coefficient, and of a gain of the flat field.
    depth_range_mm : float, optional
        Depth that the formats are sized for; by default a quarter of the shorter side.
    zero_offset : bool
        Subtract the depth that is read without contact. It is first captured from `reference`.
    light_gains : bool, optional
        A gain for each colour undoes the difference of the light between picture and reference; by default with the
        models `quadratic` and `cubic`.
    parity : bool
        A parity bit in each word of the memories of the hardware, by which a device sees a flipped bit.
    self_check : bool
        The hardware puts the depth of each frame into the equation, by which a device sees an error of its solver.
    arithmetic : str
        `chip`, bit-accurate as in the hardware, or `float`, double precision.
    threshold_mm : float
        Depth above which a pixel touches. A frame touches if an area of half that of a ball of 4 mm, 0.12 mm deep, is
        above it, and at least 0.1 mm^2.
    area_threshold_mm : float
        Depth above which a pixel is in the area of the contact, whose centroid, limits and volume are recorded. Half
        the peak of the frame before counts where that is less, but never less than `threshold_mm`. A picture that is
        not of a stream counts as the frame before itself.

    Raises
    ------
    InputError
        An argument is not accepted, or the reference is missing, too dark or of another camera.
    """

    def __init__(
        self,
        sensor: Sensor,
        reference: Pictures | None = None,
        *,
        crop: Crop | None = None,
        grid: tuple[int, int] | None = None,
        solver: Solver = SENSOR.solver,
        boundary: Boundary = SENSOR.boundary,
        model: Model | Literal[""] = "",
        data_width: int = Configuration.data_width,
        coefficient_width: int = Configuration.coefficient_width,
        gain_width: int = Configuration.gain_width,
        depth_range_mm: float | None = None,
        zero_offset: bool = SENSOR.zero_offset,
        light_gains: bool | None = None,
        parity: bool = Configuration.parity,
        self_check: bool = Configuration.self_check,
        arithmetic: Arithmetic = "chip",
        threshold_mm: float = THRESHOLD_MM,
        area_threshold_mm: float = AREA_THRESHOLD_MM,
    ) -> None:
        if not isinstance(sensor, Sensor):
            problem = f" is a {type(sensor).__name__}"
            raise InputError(Argument("sensor"), problem, accepted="a Sensor, as load(..) returns it")
        if grid is not None and not (len(np.shape(grid)) == 1 and len(grid) == 2 and all(map(is_whole, grid))):
            raise InputError(Argument("grid", grid), accepted=("(rows, columns)", "whole numbers"))
        numbers = {"data_width": data_width, "coefficient_width": coefficient_width, "gain_width": gain_width}
        if wrong := next((each for each in numbers.items() if not is_whole(each[1])), None):
            raise InputError(Argument(*wrong), accepted="a whole number, of type int")
        flags = {"zero_offset": zero_offset, "parity": parity, "self_check": self_check}
        for name, flag in (flags if light_gains is None else flags | {"light_gains": light_gains}).items():
            require_flag(Argument(name, flag))
        one_of(Argument("arithmetic", arithmetic), ARITHMETICS)
        one_of(Argument("boundary", boundary), BOUNDARIES)
        self._sources = Sources(sensor, crop, zero_offset)
        sensor, share = shown(sensor, crop)
        sensor.require_reference(reference is not None)
        rows, columns = self._grid = default_grid(sensor, solver) if grid is None else (int(grid[0]), int(grid[1]))
        self._arithmetic, self._is_of_hardware = arithmetic, is_grid_of_hardware(rows, columns, solver)
        kind = Configuration if self._is_of_hardware or arithmetic == "chip" else ExactConfiguration
        shape: dict[str, Any] = {"columns": columns, "rows": rows, "solver": solver, "neumann": boundary == "neumann"}
        self._reader = Reader(sensor, self._grid, share)
        self._zero_doubts: tuple[Doubt, ...] = ()
        pitch_mm = sensor.pixel_pitch_mm * camera_scale(sensor, kind(**shape))
        rest, doubts = (None, ()) if reference is None else self._rest_of(reference, REFERENCE, LARGEST_LOG2)
        self._sensor = replace(sensor, pixel_pitch_mm=pitch_mm, reference=rest)
        self._config = self.sensor.configuration(
            model,
            kind=kind,
            **shape,
            **numbers,
            depth_range_px=None if depth_range_mm is None else self.sensor.depth_range_px(depth_range_mm),
            zero_offset=zero_offset,
            light_gains=light_gains,
            parity=parity,
            self_check=self_check,
        )
        require_thresholds(threshold_mm, area_threshold_mm, self.config, self.pixel_pitch_mm)
        self._fixed_doubts = (*of_verdict(sensor.verdict), *check_steps(self.config, self.pixel_pitch_mm, arithmetic))
        self._threshold_mm, self._area_threshold_mm = threshold_mm, area_threshold_mm
        self._zero, self._exact_zero = no_zero(self.config), np.zeros(self.grid)
        self._key, self._captures = secrets.token_hex(), 0  # of its streams
        self._use_reference(rest, doubts)
        if reference is not None and rest is not None:
            self._sources.take_reference(reference)
            if zero_offset:
                self._use_zero(rest)
                self._sources.take_zero(reference)
        self._settle(rest)

    def __call__(
        self,
        pictures: Pictures,
        stream: Stream | None = None,
        name: str = "",
        captured_at: float | Sequence[float] | np.ndarray | None = None,
    ) -> Result:
        """Return the depth of pictures.

        Parameters
        ----------
        pictures : uint8 array (rows, columns, 3) or (frames, rows, columns, 3), RGB, or a path, or a sequence of them
            Pictures of the sensor's camera, which show what `crop` says, of any size. PIL images and other
            objects that numpy takes as arrays are arrays. A path names a picture (PNG, JPEG), a `.npy` of one or of
            several, or a folder of pictures.
        stream : Stream, optional
            The stream, `new_stream`, to which the pictures belong, in their order; by default each picture stands for
            itself.
        name : str
            Names the pictures in errors and warnings.
        captured_at : float, or one for each picture, optional
            When they were captured, in seconds since the epoch, for `Result.captured_at`.

        Returns
        -------
        Result
            Arrays have a first axis of frames if the pictures have one.

        Warns
        -----
        InputWarning
            The heights of a picture are uncertain.
        """
        frames, checked, single = self._checked(pictures, name or PICTURES)
        captured = times(captured_at, len(frames))
        result = replace(self.result_of(frames, checked, require_stream(stream)), captured_at=captured)
        return result[0] if single else result

    def result_of(self, frames: np.ndarray, checked: Sequence[Checked], stream: Stream | None) -> Result:
        """Return the depth of frames on the grid, uint8 (frames, rows, columns, 3), and warn, as a call does."""
        if stream is not None:
            stream.require(self._key)
            if stream.captures != self._captures:
                stream.begin_as(self.new_stream())
            stream.accepted = True
        monitor = Monitor()
        slopes, depth, gains = self._solved(frames, monitor, None if stream is None else stream.light)
        codes, depth_mm = np.rint(depth).astype(np.int32), depth * self.depth_lsb_mm
        streamed = None if stream is None else tuple(self._recorder.next(frame, stream.events) for frame in codes)
        return Result(
            codes,
            depth_mm,
            slopes if self.sensor.pixel_aspect == 1 else slopes / (self.sensor.pixel_aspect, 1),
            self._twin.dark(frames),
            None if gains is None else gains * LIGHT_GAIN.lsb,
            dict(monitor.saturations),
            self._recorder,
            self.depth_lsb_mm,
            self.pixel_pitch_mm,
            self.sensor.steepest(self.config),
            self.sensor.height_errors.get(self.config.gradient_model),
            streamed,
            self._warned(checked, gains, depth_mm, slopes, monitor, None if stream is None else stream.warned),
            self.sensor.pixel_aspect,
        )

    def stream(
        self, pictures: str | Path | Iterable[Picture | tuple[Picture, float]], stream: Stream | None = None
    ) -> Iterator[Result]:
        """Give the depth of the pictures of a stream, as the hardware does.

        Light gains act on the next picture, and half the peak of a contact bounds the area of the next. A picture that
        gives no right depth is left out and counted. At a capture the stream begins afresh, its records too.

        Parameters
        ----------
        pictures : path, or iterable of pictures, each as for a call, or of pairs of a picture and its `captured_at`
        stream : Stream, optional
            The stream, `new_stream`, that the pictures continue.

        Raises
        ------
        InputError
            A picture is not accepted, and none was before it.

        Warns
        -----
        InputWarning
            Once for each kind of doubt, and for the first picture that is left out.
        """
        stream = require_stream(stream) or self.new_stream()
        for item in each_of(pictures):
            stream.taken += 1
            try:
                picture, captured_at = timed(item)
                result = self(picture, stream, f"picture {stream.taken - 1}", captured_at)
            except InputError as error:
                stream.leave_out(error)
                continue
            yield result

    def new_stream(self) -> Stream:
        """Return the state of a stream before its first picture: light gains of 1, untouched gel."""
        light = LightFilter(Light.of(self.config)) if self.config.light_gains else None
        return Stream(self._key, self._captures, light, self._recorder.events(self._at_rest))

    def copy(self) -> Pipeline:
        """Return a copy, with captures of its own."""
        other = copy(self)
        other._key, other._sources = secrets.token_hex(), copy(self._sources)
        return other

    def __repr__(self) -> str:
        rows, columns = self.grid
        choices = f"{self.config.gradient_model}, {self.config.solver}, {self.arithmetic}"
        return f"Pipeline({self.sensor.name!r}, {columns}x{rows}, {choices})"

    @property
    def sensor(self) -> Sensor:
        """Sensor on the grid, with the reference in use."""
        return self._sensor

    @property
    def reader(self) -> Reader:
        """Reader of pictures onto the grid."""
        return self._reader

    @property
    def twin(self) -> Twin:
        """Both arithmetics, on frames of the grid."""
        return self._twin

    @property
    def rest(self) -> Rest | None:
        """The sensor without contact, with which pictures are compared; None without a reference."""
        return self._rest

    @property
    def config(self) -> Configuration:
        """Configuration, which models and RTL share."""
        return self._config

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of the depth map."""
        return self._grid

    @property
    def arithmetic(self) -> Arithmetic:
        """`chip` or `float`."""
        return self._arithmetic

    @property
    def pixel_pitch_mm(self) -> float:
        """Height of a grid pixel, in mm; its width is `sensor.pixel_aspect` times that."""
        return self.sensor.pixel_pitch_mm

    @property
    def depth_lsb_mm(self) -> float:
        """Depth of code 1, in mm."""
        return self.config.depth_lsb_px * self.pixel_pitch_mm

    @property
    def threshold_mm(self) -> float:
        """Depth above which a pixel touches."""
        return self._threshold_mm

    @property
    def area_threshold_mm(self) -> float:
        """Depth above which a pixel is in the area of the contact."""
        return self._area_threshold_mm

    def settings(self, touch_mm: float, release_mm: float, area_mm: float) -> Settings:
        """Return the settings of the hardware for thresholds in mm: depth codes, and the least area in pixels."""
        pixel_mm2 = self.pixel_pitch_mm**2 * self.sensor.pixel_aspect
        return settings_of(touch_mm, release_mm, area_mm, self.depth_lsb_mm, pixel_mm2, self._at_rest)

    @property
    def zero_codes(self) -> np.ndarray:
        """Zero offset at its nodes, depth codes in the order of the stream, int64 (node rows, node columns)."""
        return self._zero

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """Why all heights are uncertain: by the calibration, word lengths, the reference and the zero offset."""
        return (*self._fixed_doubts, *self._doubts, *self._zero_doubts)

    def capture_reference(self, pictures: Pictures) -> None:
        """Take the mean of pictures without contact as the reference, as the hardware's capture does.

        The zero offset does not change, and heights are doubted: call `capture_zero` next.

        Parameters
        ----------
        pictures : as for a call
            1, 2, 4, .. pictures, as many as the hardware can average.

        Raises
        ------
        InputError
            The number of pictures is not accepted, they are too dark, or the pipeline takes colours as sent.
        """
        require_flat_field(self.config)
        self._use_reference(*self._rest_of(pictures, PICTURES, largest_log2_frames(self.config)))
        self._zero_doubts = earlier_zero(self.config)
        self._sources.take_reference(pictures)
        self._settle(self.sensor.reference)

    def capture_zero(self, pictures: Pictures) -> None:
        """Take the depth of pictures without contact as the zero offset, as the hardware's capture does.

        Raises
        ------
        InputError
            The number of pictures is not 1, 2, 4, .. 256, or the pipeline has no zero offset.
        """
        require_zero_offset(self.config)
        frames, *_ = self._checked(pictures, PICTURES)
        power_of_two_of(len(frames), LARGEST_LOG2, PICTURES)
        doubts = check_zero(frames, self._rest, PICTURES)
        self._use_zero(frames)
        self._zero_doubts = doubts
        self._sources.take_zero(pictures)
        self._settle(frames)

    def hardware(self, folder: str | Path, *, quiet: bool = False) -> Path:
        """Write the parameters of the top module and the tables, with which the RTL computes the same depth.

        It prints the variables with which `make wrap NAME=..` writes the same, unless it is `quiet`.

        Parameters
        ----------
        folder : path
            Created if it is missing. Its `parameters.json` holds the parameters of hdl/tactile_depth.sv, the fields of
            Config by name, the contact thresholds for the registers, units, and the names of the $readmemh files.
            Software in C loads the same tables with its `tactile_depth_tables.h`.

        Returns
        -------
        Path of parameters.json

        Raises
        ------
        InputError
            The folder cannot be written, or the hardware cannot have the grid.
        """
        if not self._is_of_hardware:
            remedy = ("make the pipeline with ", Argument("arithmetic", "chip"), " and a grid that it takes")
            raise InputError(Argument("grid", self.grid), " is for double precision alone", remedy=remedy)
        thresholds = thresholds_of(self._recorder.settings)
        index = write_hardware(Path(folder), self.sensor, self.config, self._zero, self._gains, thresholds)
        if not quiet:
            print(f"make words: {make_words(self.config, self.pixel_pitch_mm, self._sources.words())}")
        return index

    def _use_reference(self, frames: np.ndarray | None, doubts: tuple[Doubt, ...]) -> None:
        """Use frames without contact and their doubts; of those that are refused nothing stays."""
        if frames is not None:
            require_light(captured_gains(frames, self.config), self.config)
        sensor = self.sensor if frames is None else replace(self.sensor, reference=frames)
        twin, gains = Twin(sensor, self.config, cores=fastest()), reference_gains(sensor, self.config)
        _ = twin.tables, twin.exact_tables  # now, because they may refuse the sensor
        self._sensor, self._twin, self._gains, self._doubts = sensor, twin, gains, doubts
        self._rest = None if frames is None else Rest.of(frames)

    def _use_zero(self, frames: np.ndarray) -> None:
        twin = self._twin
        if self._is_of_hardware:
            self._zero = twin.captured_zero(frames)
        depth = twin.upright(twin.solved(twin.exact_slopes(frames, twin.light(frames))) / self.config.depth_lsb_px)
        self._exact_zero = twin.upright(-exact_zero(np.zeros(self.grid), depth, self.config))

    def _settle(self, frames: np.ndarray | None) -> None:
        """Measure what the last of some frames without contact reads; the least area of a contact follows from it."""
        self._captures += 1
        self._at_rest = np.zeros(self.grid, np.int32)
        if frames is not None:
            self._at_rest = np.rint(self._solved(frames[-1:], Monitor(), None)[1][0]).astype(np.int32)
        settings = self.settings(self.threshold_mm, self.threshold_mm, self.area_threshold_mm)
        self._recorder = Recorder.of(self.config, settings)

    def _solved(
        self, frames: np.ndarray, monitor: Monitor, followed: LightFilter | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Return slopes, depth in codes, which double precision does not round, and light gains of frames."""
        twin = self._twin
        if self.arithmetic == "chip":
            slope_codes, streamed_codes, gains = twin.chip(frames, monitor, followed)
            depth = twin.upright(zeroed(streamed_codes, self.config, monitor, self._zero))
            return slope_codes * self.config.gradient_lsb, depth, gains
        gains = twin.light(frames, followed)
        slopes = twin.exact_slopes(frames, gains)
        return slopes, twin.solved(slopes) / self.config.depth_lsb_px - self._exact_zero, gains

    def _rest_of(self, pictures: Pictures, name: Argument, largest_log2: int) -> tuple[np.ndarray, tuple[Doubt, ...]]:
        """Return pictures without contact on the grid, uint8 (frames, rows, columns, 3), and their doubts."""
        images, frames = self._reader.reference(pictures, name, largest_log2)
        return frames, check_reference(self._reader.sensor, images, name, self._reader.share)

    def _checked(self, pictures: Pictures, name: Part) -> tuple[np.ndarray, list[Checked], bool]:
        """Return frames on the grid, uint8 (frames, rows, columns, 3), their checks, and True for a single picture."""
        read, single = self._reader.pictures(pictures, name)
        frames, checked = [], []
        for each, frame in read:
            frames.append(frame)
            checked.append(check_picture(frame, self._rest, each))
        return np.stack(frames), checked, single

    def _warned(
        self,
        checked: Sequence[Checked],
        gains: np.ndarray | None,
        depth_mm: np.ndarray,
        slopes: np.ndarray,
        monitor: Monitor,
        warned: Warned | None,
    ) -> tuple[tuple[str, ...], ...]:
        """Return for each picture why its heights are uncertain; warn of it, and in a stream only of what is new."""
        light = [None] * len(checked) if gains is None else gains * LIGHT_GAIN.lsb
        least = least_clipped(self.config.depth.width, self._zero) if monitor.saturations else np.inf
        texts = []
        for each, gain, depth, slope in zip(checked, light, depth_mm, slopes, strict=True):
            clipped = int((np.abs(depth) >= least * self.depth_lsb_mm).sum())
            # A contact in the zero offset would be a part of the slopes that no surface has.
            steps = slope * self.pixel_pitch_mm if self.config.neumann and not self._zero_doubts else None
            doubts = unexplained(doubts_of(each, gain, depth, self.threshold_mm, steps, clipped), self._doubts)
            tell(doubts if warned is None else warned.new(doubts))
            texts.append(tuple(map(str, (*self.doubts, *doubts))))
        return tuple(texts)
