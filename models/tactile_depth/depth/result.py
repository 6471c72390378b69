# SPDX-License-Identifier: Apache-2.0
"""Depth maps in millimetres, with slopes and contacts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.errors import Argument, InputError, InputWarning, is_number, warn
from tactile_depth.base.npy import Codes, Flags, Floats
from tactile_depth.chip.configuration import STORED, WIDTHS, WORDS, Configuration
from tactile_depth.chip.contact.centroid import FRACTION
from tactile_depth.chip.contact.contact_debounce import TOUCHING
from tactile_depth.chip.contact.contact_events import ContactEvents, Record, Settings
from tactile_depth.depth.regions import regions
from tactile_depth.pictures.doubts import Doubt, doubt, tell
from tactile_depth.sensor.presets import AREA_THRESHOLD_MM
from tactile_depth.sensor.sensor import HeightError

*_, RANGE = WORDS  # of depth, as an argument
LIGHTEST_MM, LIGHTEST_BALL_MM = 0.12, 4.0
"""Lightest contact that is seen for sure: the depth of a ball of this diameter."""
COARSE_STEP_MM, COARSE_STEP = 0.02, 0.07
"""Step of a stored mode of depth from which heights are warned of, in mm and over the pitch of the grid. Peaks of 6
real presses differ from double precision by up to 5 % at 0.02 mm, 7 % at 0.022, 23 % at 0.044, 47 % at 0.11, 74 % at
0.22; on finer grids by up to 5 % at 0.053 of the pitch, 12 % at 0.105, 43 % at 0.17 and more. The default is far
below."""
SMALLEST_MM2 = 0.1
"""Least area of a contact whatever the threshold: a disc with a diameter of 0.36 mm, 4 pixels of a usual grid."""
MOST_AT_REST = 0.02
"""Share of untouched pixels above a threshold: 0 at 0.07 mm on a GelSight Mini, 0.01 at 0.01 mm, 0.05 at 0.005 mm."""
MOSTLY_EMPTY = 0.5
"""Share of the bounding box: 0.73 and more in 45 real presses, 0.39 for two drawn balls side by side."""


def least_area_mm2(threshold_mm: float) -> float:
    """Return the least area above a threshold that is a contact: half of that of the lightest ball.

    At 0.07 mm it is 13 pixels of 0.1585 mm. Untouched gel of a GelSight Mini has up to 9 in 1,000 frames, with 2 grey
    levels of noise in them and in the reference; the ball, drawn with the same noise, 21 and more.
    """
    return max(SMALLEST_MM2, math.pi * LIGHTEST_BALL_MM * (LIGHTEST_MM - threshold_mm) / 2)


def settings_of(
    touch_mm: float, release_mm: float, area_mm: float, lsb_mm: float, pixel_mm2: float, at_rest: np.ndarray
) -> Settings:
    """Return the settings of the hardware for thresholds in mm, with the least area for the first of them.

    Parameters
    ----------
    at_rest : int array (rows, columns)
        Depth codes of the untouched sensor. A contact has at least twice the pixels that these have above the
        threshold: with noise they are up to 1.1 times as many, where a grid ends within a block of the zero offset.

    Warns
    -----
    InputWarning
        The untouched sensor reads more than `touch_mm` at so many pixels that contacts are not seen.
    """
    touch, release, area = (round(depth_mm / lsb_mm) for depth_mm in (touch_mm, release_mm, area_mm))
    above = int(np.count_nonzero(at_rest > touch))
    if above > MOST_AT_REST * at_rest.size:
        problem = (
            f"a threshold of {touch_mm:.2g} mm: {100 * above / at_rest.size:.0f} % of the untouched gel is above it"
        )
        enough_mm = float(np.quantile(at_rest, 1 - MOST_AT_REST / 2)) * lsb_mm
        warn(InputWarning(problem, ", and contacts of less are not seen", remedy=f"give {enough_mm:.2g} mm or more"))
    least = max(1, round(least_area_mm2(touch_mm) / pixel_mm2), 2 * above)
    return Settings(touch, release, area, least, debounce=1)


def require_thresholds(threshold_mm: float, area_threshold_mm: float, config: Configuration, pitch_mm: float) -> None:
    """Raise InputError unless two thresholds of contacts are depths that the registers hold."""
    lsb_mm, deepest_mm = config.depth_lsb_px * pitch_mm, config.depth_limit_px * pitch_mm
    if not is_number(threshold_mm) or not 0 < threshold_mm / lsb_mm < 2 ** (config.depth.width - 1):
        accepted = f"a depth above 0 and within the depth range of {deepest_mm:.3g} mm"
        raise InputError(Argument("threshold_mm", threshold_mm), accepted=accepted)
    if not is_number(area_threshold_mm) or not 0 <= area_threshold_mm < max(deepest_mm, AREA_THRESHOLD_MM):
        accepted = f"a depth of 0 or more and within the depth range of {deepest_mm:.3g} mm"
        raise InputError(Argument("area_threshold_mm", area_threshold_mm), accepted=accepted)


def check_steps(config: Configuration, pitch_mm: float, arithmetic: str) -> tuple[Doubt, ...]:
    """Warn, and return a doubt, if words of the solver have steps that pictures of a fingertip are too flat for."""
    if arithmetic != "chip":
        return ()
    modes = config.column_inverse if config.solver == "spectral" else config.elimination_store
    step_mm, range_mm = modes.lsb * config.depth_limit_px * pitch_mm, config.deepest_px * pitch_mm
    coarse_mm = min(COARSE_STEP_MM, COARSE_STEP * pitch_mm)
    if step_mm <= coarse_mm:
        return ()
    shallower = Argument(RANGE, f"{0.95 * range_mm * coarse_mm / step_mm:.2g}")
    enough = config.depth.width + math.ceil(math.log2(step_mm / coarse_mm))
    wider = (" or ", Argument(STORED, enough)) if enough <= WIDTHS[STORED].accepted[1] else ()
    words = (Argument(STORED, config.depth.width), f" and a depth range of {range_mm:.3g} mm")
    text = f" have steps of {step_mm:.2g} mm inside, so heights may be wrong by 10 % and more"
    doubts = (doubt("coarse steps", *words, text, remedy=("give ", shallower, *wider)),)
    tell(doubts)
    return doubts


def thresholds_of(settings: Settings) -> dict[str, int]:
    """Return the words of the registers that hold settings."""
    registers = "THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE"
    return dict(zip(registers, settings, strict=True))


def steeper(slopes: np.ndarray, fitted_slope: float, dark: np.ndarray) -> Flags:
    """Return the pixels that are not dark, and whose slope (.., 2) is steeper than the fit of a calibration saw."""
    return ~dark & (np.hypot(slopes[..., 0], slopes[..., 1]) > fitted_slope)


@dataclass(frozen=True, eq=False)
class Contact(ByValue):
    """Contact of one frame, as the hardware records it, or one of several (`Result.contacts`).

    Two contacts are equal if all their values are.

    Attributes
    ----------
    record : Record
        Words of the hardware: depth in codes, positions in grid pixels.
    mask : bool array (rows, columns)
        Pixels whose depth is above the threshold, rows from the top of the picture; of one of several its pixels.
    untouched_mm : float
        Mean depth of untouched pixels, which a height is counted from, in mm; NaN without any.
    depth_lsb_mm, pixel_pitch_mm : float
    pixel_aspect : float
        Width of a grid pixel over its height, `pixel_pitch_mm`.
    grid : tuple of int, or None
        Rows and columns that positions count on; None: those of `mask`.
    """

    record: Record
    mask: Flags
    untouched_mm: float
    depth_lsb_mm: float
    pixel_pitch_mm: float
    pixel_aspect: float = 1.0
    grid: tuple[int, int] | None = None

    def __repr__(self) -> str:
        peak = f"peak {self.peak_mm:.3g} mm at {self.peak_px}, area {self.area_mm2:.3g} mm^2"
        return f"Contact({peak if self.touching else 'none'})"

    @property
    def touching(self) -> bool:
        """True if this frame has a contact: as many pixels above the threshold as `minimum_area` says."""
        return bool(self.record.status & TOUCHING)

    @property
    def peak_mm(self) -> float:
        """Largest depth above the threshold, in mm; 0 without contact."""
        return self.record.peak * self.depth_lsb_mm * self.touching

    @property
    def peak_height_mm(self) -> float:
        """Height of the peak above the untouched surface, in mm; 0 without contact."""
        return self.peak_mm - self.untouched_mm if self.touching else 0.0

    @property
    def peak_px(self) -> tuple[int, int]:
        """Row and column of the peak on the grid."""
        return self.record.peak_position

    @property
    def area_threshold_mm(self) -> float:
        """Depth above which a pixel of this frame is in the area, in mm."""
        return self.record.area_threshold * self.depth_lsb_mm

    @property
    def area_mm2(self) -> float:
        """Area whose depth is above `area_threshold_mm`, in mm^2; 0 without contact, or if it does not reach that."""
        return self.record.area * self._pixel_mm2 * self.touching

    @property
    def is_mostly_empty(self) -> bool:
        """True if the area fills less than half of its bounding box: it is long, hollow, or of several contacts."""
        return self.area_mm2 > 0 and self.record.box_share < MOSTLY_EMPTY

    @property
    def volume_mm3(self) -> float:
        """Sum of the depths in the area times the area of a pixel, in mm^3; 0 without contact."""
        return self.record.volume * self.depth_lsb_mm * self._pixel_mm2 * self.touching

    @property
    def centroid_px(self) -> tuple[float, float]:
        """Row and column of the area's centre on the grid, weighted by depth above `area_threshold_mm`, to 1/16 pixel.

        Of a contact without area the peak.
        """
        row, column = self.record.centroid
        return row / 2**FRACTION, column / 2**FRACTION

    @property
    def peak_position_mm(self) -> tuple[float, float] | None:
        """Row and column of the peak from the upper left corner of the grid, in mm; None without contact."""
        return self._from_the_corner(self.peak_px)

    @property
    def centroid_mm(self) -> tuple[float, float] | None:
        """Row and column of the centroid from the upper left corner of the grid, in mm; None without contact."""
        return self._from_the_corner(self.centroid_px)

    def _from_the_corner(self, index: tuple[float, float]) -> tuple[float, float] | None:
        """Return a position on the depth map in mm.

        The centre of a pixel is half a pixel from its corner, and depth lies half a pixel up and to the left of it: so
        index 0 is on the edge of the grid.
        """
        if not self.touching:
            return None
        row, column = index
        return row * self.pixel_pitch_mm, column * self.pixel_pitch_mm * self.pixel_aspect

    @property
    def _pixel_mm2(self) -> float:
        return self.pixel_pitch_mm**2 * self.pixel_aspect

    @property
    def is_central(self) -> bool:
        """True if the area lies wholly in the middle square, where `Result.height_error` was measured."""
        shape = self.grid or self.mask.shape
        side = min(shape)
        bounds = zip(shape, self.record.least, self.record.greatest, strict=True)
        return all((length - side) // 2 < least <= most < (length + side) // 2 - 1 for length, least, most in bounds)


@dataclass(frozen=True)
class Recorder:
    """Makes the record of a picture by itself, which is that of a picture that stands still in a stream.

    Attributes
    ----------
    settings : Settings
    width : int
        Bits of a depth code.
    bottom_first : bool
        The bottom row leaves the hardware first.
    """

    settings: Settings
    width: int
    bottom_first: bool

    @classmethod
    def of(cls, config: Configuration, settings: Settings) -> Recorder:
        """Return the recorder of a configuration."""
        return cls(settings, config.depth.width, config.solver == "tridiagonal")

    def events(self, at_rest: np.ndarray) -> ContactEvents:
        """Return the state before the first picture of a stream: after codes without contact (rows, columns)."""
        rows, columns = at_rest.shape
        events = ContactEvents(rows, columns, self.width, self.bottom_first)
        self.next(at_rest, events)
        events.frames = 0
        return events

    def next(self, codes: np.ndarray, events: ContactEvents) -> Record:
        """Return the record of the next picture of a stream, from codes in the order of the picture."""
        return events.whole_frame(codes[::-1] if self.bottom_first else codes, self.settings, time=0)

    def record(self, codes: np.ndarray) -> Record:
        """Return the record of codes (rows, columns) in the order of the picture."""
        return self.next(codes, self.events(codes))

    def contacts(self, codes: np.ndarray, untouched: int) -> list[tuple[Flags, Record]]:
        """Return pixels and record of each contact in codes (rows, columns), that with most pixels first.

        Parameters
        ----------
        untouched : int
            Depth code of the untouched surface, from which heights count: a deep contact lowers it.
        """
        above = self.settings.off_threshold
        threshold = above + untouched
        settings = self.settings._replace(on_threshold=threshold, off_threshold=threshold)
        recorder, lowest = replace(self, settings=settings), np.iinfo(np.int32).min
        masks = regions(codes.astype(np.int64) - untouched, above, self.settings.minimum_area)
        return [(mask, recorder.record(np.where(mask, codes, lowest))) for mask in masks]


@dataclass(frozen=True, eq=False)
class Result(ByValue):
    """Depth of one frame or of several frames.

    For several frames every array has a first axis of frames; `result[i]` is the result of one frame, `result[i:j]`
    that of some, and a loop gives one after another. `np.asarray` takes the arrays, such as `height_mm`, not the
    result. Rows are in the order of the picture. Depth is positive where the gel is pressed in. The depth map is
    shifted by half a pixel up and to the left, because slopes are differenced backwards. Two results are equal if all
    their values are.

    Attributes
    ----------
    codes : int32 array (rows, columns)
        Depth codes of the hardware.
    depth_mm : float64 array (rows, columns)
        `codes` times `depth_lsb_mm`; not rounded with float arithmetic.
    slopes : float64 array (rows, columns, 2)
        dz/dx along the columns and dz/dy down the rows, without unit.
    dark : bool array (rows, columns)
        Pixels without light, whose colour was taken from the pixel before them.
    light_gains : float64 array (3,) or None
        Light of the reference over that of the picture, of red, green and blue; None without light gains.
    saturations : dict of str to int
        Number of values clipped in all frames, by node of the pipeline; empty without any.
    recorder : Recorder
        Makes the records.
    depth_lsb_mm, pixel_pitch_mm : float
    fitted_slope : float
        Largest slope in the presses of the calibration.
    calibration_error : HeightError or None
        Error of the calibration, measured on presses that were not fitted and lay wholly in the picture's middle
        square; None if not measured. It holds for contacts that are central (`Contact.is_central`).
    streamed : tuple of Record, or None
        Records of the frames of a stream, which depend on the frames before.
    warnings : tuple of str, or tuple of such tuples
        Texts that say why the heights are uncertain; for several frames a tuple for each.
    pixel_aspect : float
        Width of a grid pixel over its height, `pixel_pitch_mm`.
    captured_at : float, float64 array (frames,) or None
        When the picture was captured, in seconds since the epoch, if the call or the stream was told.
    """

    codes: Codes
    depth_mm: Floats
    slopes: Floats
    dark: Flags
    light_gains: Floats | None
    saturations: dict[str, int]
    recorder: Recorder
    depth_lsb_mm: float
    pixel_pitch_mm: float
    fitted_slope: float
    calibration_error: HeightError | None
    streamed: tuple[Record, ...] | None = None
    warnings: tuple[str, ...] | tuple[tuple[str, ...], ...] = ()
    pixel_aspect: float = 1.0
    captured_at: float | Floats | None = None

    def __repr__(self) -> str:
        *frames, rows, columns = self.codes.shape
        number = f"{frames[0]} x " if frames else ""
        return f"Result({number}{columns}x{rows}, depth up to {self.depth_mm.max(initial=-math.inf):.3g} mm)"

    def __bool__(self) -> bool:
        return True

    def __len__(self) -> int:
        """Return the number of frames; raise TypeError for the result of a single picture, as numpy does."""
        self._require_frames()
        return len(self.codes)

    def __iter__(self) -> Iterator[Result]:
        """Give the result of each frame."""
        return (self[index] for index in range(len(self)))

    def __getitem__(self, index: int | slice) -> Result:
        """Return the result of one frame of several, or of a slice of them; `saturations` stays that of all."""
        if not isinstance(index, int | np.integer | slice):
            raise TypeError(f"result[{index!r}]: accepted is the number of a frame, or a slice")
        self._require_frames()
        arrays = {name: getattr(self, name)[index] for name in ("codes", "depth_mm", "slopes", "dark")}
        gains = None if self.light_gains is None else self.light_gains[index]
        captured = self.captured_at[index] if isinstance(self.captured_at, np.ndarray) else None
        frames = range(len(self))[index] if isinstance(index, slice) else (index,)
        streamed = None if self.streamed is None else tuple(self.streamed[frame] for frame in frames)
        warned: Any = self.warnings and self.warnings[index]
        return replace(self, streamed=streamed, warnings=warned, light_gains=gains, captured_at=captured, **arrays)

    def _require_frames(self) -> None:
        if self.codes.ndim == 2:
            raise TypeError("the result of a single picture has no frames: use its attributes")

    @property
    def height_error(self) -> HeightError | None:
        """Error of the heights, `calibration_error`; None if it was not measured, or if a frame has a warning."""
        return None if any(self.warnings) else self.calibration_error

    @cached_property
    def records(self) -> tuple[Record, ...]:
        """One record per frame, from which `contact` is made; computed on first use, except for a stream."""
        if self.streamed is not None:
            return self.streamed
        return tuple(map(self.recorder.record, self.codes if self.codes.ndim == 3 else self.codes[None]))

    @property
    def threshold(self) -> int:
        """Depth code above which a pixel touches."""
        return self.recorder.settings.on_threshold

    @property
    def threshold_mm(self) -> float:
        """Depth above which a pixel touches, in mm."""
        return self.threshold * self.depth_lsb_mm

    @cached_property
    def mask(self) -> Flags:
        """Pixels whose depth is above the threshold, bool, as `codes`."""
        return self.codes > self.threshold

    @cached_property
    def untouched_mm(self) -> Floats:
        """Mean of the depths that are not above the threshold, of each frame, in mm; NaN without such a pixel."""
        untouched = ~self.mask
        count = untouched.sum(axis=(-2, -1))
        depths_mm = np.where(untouched, self.depth_mm, 0).reshape(*untouched.shape[:-2], -1)  # added in one order
        total = depths_mm.sum(axis=-1)
        return np.where(count, total / np.maximum(count, 1), np.nan)

    @cached_property
    def height_mm(self) -> Floats:
        """Depth above the untouched surface: `depth_mm` minus `untouched_mm`."""
        return self.depth_mm - self.untouched_mm[..., None, None]

    @cached_property
    def outside(self) -> Flags:
        """Pixels whose slope exceeds `fitted_slope`, bool, as `codes`."""
        return steeper(self.slopes, self.fitted_slope, self.dark)

    @property
    def contact(self) -> Contact:
        """Contact of a single picture, the record of the hardware; for several frames use `result[i].contact`.

        With several contacts its peak is that of the deepest one; area, volume and bounding box are of all together,
        and the centroid is their common one, where none may lie. `contacts` has each by itself.
        """
        if self.codes.ndim != 2:
            raise AttributeError("several frames have several contacts: use result[i].contact")
        return self._contact(self.records[0], self.mask)

    @cached_property
    def contacts(self) -> list[Any]:
        """Contacts of a single picture, that with most pixels first; of several frames a list for each.

        A contact is a region of at least `recorder.settings.minimum_area` pixels that are higher than the threshold
        above the untouched surface. Where the height between two summits falls by a fifth of the lower one, and by half
        the threshold, they are two contacts. Without `contact.touching` the list is empty. Computed on first use, in
        software, from `codes`.
        """
        if self.codes.ndim != 2:
            return [each.contacts for each in self]
        if not self.contact.touching:
            return []
        untouched = round(float(np.nan_to_num(self.untouched_mm)) / self.depth_lsb_mm)
        return [self._contact(record, mask) for mask, record in self.recorder.contacts(self.codes, untouched)]

    def _contact(self, record: Record, mask: Flags) -> Contact:
        pixel = (self.pixel_pitch_mm, self.pixel_aspect)
        return Contact(record, mask, float(self.untouched_mm), self.depth_lsb_mm, *pixel)
