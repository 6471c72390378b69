# SPDX-License-Identifier: Apache-2.0
"""The configuration of the camera block, from which every number of it follows: formats, window, ratio, latency."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from tactile_depth.base.errors import Argument, InputError, former_names, one_of
from tactile_depth.chip.camera.block_weights import pixels_of
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.resampling import WHOLE, Share, crop_origin, ratio

LARGEST_PICTURE = 4096  # rows and columns
GAIN = Format(16, 12)  # unsigned
SAMPLE_MARGIN = 2  # bits of a sample above full scale, sign included
CHROMA_FRACTION = 12  # of the coefficients of BT.601
PHASES = ("rggb", "grbg", "gbrg", "bggr")
"""Colours of the first two pixels of the first row, then of the second. The place is the code: bit 0 the first column
has blue pixels, bit 1 the first row has."""


@dataclass(frozen=True)
class PixelFormat:
    """A pixel format of a camera.

    Attributes
    ----------
    name : str
    bits : int
        2**bits is full scale of a sample. YUYV: two fraction bits below 8 bits.
    bayer : bool
        A pixel has one colour, by its position in a pattern of 2 x 2.
    words : int
        Words of the stream at the input for each pixel: 2 where single bytes arrive.
    """

    name: str
    bits: int
    bayer: bool = False
    words: int = 1

    @property
    def code(self) -> int:
        """`Format` of hdl/camera/pixel_format.sv."""
        return tuple(FORMATS).index(self.name)

    @property
    def is_yuyv(self) -> bool:
        """Two neighbours of a row share their chroma."""
        return self.name.startswith("yuyv")

    @property
    def least_ratio(self) -> int:
        """Camera pixels per grid pixel that are needed: below 2 some blocks of a Bayer pattern lack a colour."""
        return 2 if self.bayer else 1


FORMATS = {
    form.name: form
    for form in (
        PixelFormat("rgb888", 8),
        PixelFormat("rgb565", 8),
        PixelFormat("rgb565_bytes", 8, words=2),
        PixelFormat("yuyv", 10),
        PixelFormat("yuyv_bytes", 10, words=2),
        PixelFormat("raw8", 8, bayer=True),
        PixelFormat("raw10", 10, bayer=True),
        PixelFormat("raw10_lsb", 10, bayer=True),
        PixelFormat("raw12", 12, bayer=True),
        PixelFormat("raw12_lsb", 12, bayer=True),
    )
}
"""The formats, in the order of `camera_format_e` of registers/camera.rdl. `_bytes`: single bytes, as `dvp_receive`
delivers them; `_lsb`: at the bottom of a word of 16 bits in place of its top."""


def check_format(pixel_format: str, phase: str) -> None:
    """Raise InputError unless this is a pixel format, and a phase that it accepts."""
    one_of(Argument("pixel_format", pixel_format), FORMATS)
    one_of(Argument("phase", phase), PHASES)
    if phase != PHASES[0] and not FORMATS[pixel_format].bayer:
        patterns = ", ".join(name for name, form in FORMATS.items() if form.bayer)
        raise InputError(
            *(Argument("phase", phase), " with ", Argument("pixel_format", pixel_format)),
            remedy=f"it goes with {patterns}",
        )


@dataclass(frozen=True)
class CameraChoice:
    """A camera whose picture size is not known yet; see `CameraConfiguration`."""

    pixel_format: str
    phase: str = PHASES[0]
    window: tuple[int, int, int, int] | None = None

    def __post_init__(self) -> None:
        check_format(self.pixel_format, self.phase)

    def on(self, picture: tuple[int, int], grid: tuple[int, int], share: Share = WHOLE) -> CameraConfiguration:
        """Return the camera for pictures and a grid, (rows, columns) each; its default window is in a share of them."""
        window = window_of(picture, grid, share) if self.window is None else self.window
        return CameraConfiguration(picture, grid, self.pixel_format, self.phase, window)


@former_names(
    byte_serial="pixel_format='rgb565_bytes' or 'yuyv_bytes'", msb_aligned="pixel_format='raw10_lsb' or 'raw12_lsb'"
)
@dataclass(frozen=True)
class CameraConfiguration:
    """The choices that define a camera block, and the numbers that follow from them.

    Raises InputError if the block cannot be built.

    Attributes
    ----------
    picture : (rows, columns) of the camera's pictures
    grid : (rows, columns) of the pipeline
    pixel_format : str
        A name of `FORMATS`.
    phase : str
        A name of `PHASES`; Bayer formats only.
    window : (x, y, width, height), or None
        The part of the picture that is averaged to the grid; None: the centred crop of `resampling`.
    black_level : int
        Subtracted from every sample, in units of 2**-bits of full scale.
    gains : (red, green, blue)
        Factors of the samples less the black level, multiples of 2**-12.
    """

    picture: tuple[int, int]
    grid: tuple[int, int]
    pixel_format: str = "rgb888"
    phase: str = PHASES[0]
    window: tuple[int, int, int, int] | None = None
    black_level: int = 0
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        check_format(self.pixel_format, self.phase)
        rows, columns = self.picture
        if not all(2 <= length <= LARGEST_PICTURE for length in self.picture):
            raise InputError(f"a picture of {columns} x {rows}: accepted are 2 to {LARGEST_PICTURE} columns and rows")
        if self.format.is_yuyv and columns % 2:
            raise InputError(f"a picture of {columns} columns: two share a chroma in yuyv: give an even number")
        if not 0 <= self.black_level < 1 << self.bits:
            raise InputError(Argument("black_level", self.black_level), accepted=range(1 << self.bits))
        if len(self.gains) != 3 or not all(0 <= code < 1 << GAIN.width for code in self.gain_codes):
            accepted = ("three factors", f"each below {1 << GAIN.width - GAIN.fraction}")
            raise InputError(Argument("gains", self.gains), accepted=accepted)
        self._place_window()
        least = self.format.least_ratio
        if self.ratio < least:
            width, height = self.crop[2:]
            reason = "below it some blocks lack a colour: " if self.format.bayer else ""
            raise InputError(
                f"a window of {width} x {height} pixels of {self.pixel_format} for a grid of {self.grid[1]} x "
                f"{self.grid[0]} (columns x rows) is {float(self.ratio):.3g} pixels for each of the grid: {least} are "
                f"needed: {reason}give a larger picture or window, or a smaller grid"
            )

    def _place_window(self) -> None:
        rows, columns = self.picture
        if self.window is None:
            object.__setattr__(self, "window", window_of(self.picture, self.grid))
            return
        x, y, width, height = self.window
        window_given = (Argument("window", self.window), " (x, y, width, height)")
        if min(x, y) < 0 or min(width, height) < 1 or x + width > columns or y + height > rows:
            raise InputError(*window_given, f" is not inside the picture of {columns} x {rows} pixels")
        covered = _covered(self.grid, self.ratio)
        if covered != (width, height):
            raise InputError(
                *window_given,
                f" has not the aspect ratio of the grid of {self.grid[1]} x {self.grid[0]} (columns x rows)",
                remedy=f"give {covered[0]} x {covered[1]} pixels",
            )

    @property
    def format(self) -> PixelFormat:
        return FORMATS[self.pixel_format]

    @property
    def bits(self) -> int:
        """2**bits is full scale of a sample."""
        return self.format.bits

    @property
    def sample_width(self) -> int:
        """Bits of a signed sample."""
        return self.bits + SAMPLE_MARGIN

    @property
    def crop(self) -> tuple[int, int, int, int]:
        """The window: x, y, width, height."""
        assert self.window is not None
        return self.window

    @property
    def ratio(self) -> Fraction:
        """Camera pixels per grid pixel."""
        _, _, width, height = self.crop
        return ratio((height, width), self.grid)

    @property
    def phase_code(self) -> int:
        return PHASES.index(self.phase)

    @property
    def words_per_pixel(self) -> int:
        """Words of the stream at the input for each pixel."""
        return self.format.words

    @property
    def last_word(self) -> int:
        """Position in a picture of the last word that the frame depends on.

        That is the last word of the window's last pixel; in YUYV that of its pair.
        """
        x, y, width, height = self.crop
        pixels = x + width + (self.format.is_yuyv and (x + width) % 2)
        return ((y + height - 1) * self.picture[1] + pixels) * self.words_per_pixel - 1

    @property
    def centre_shift(self) -> tuple[int, int]:
        """Columns and rows from the centred crop of the window's size to the window."""
        x, y, width, height = self.crop
        rows, columns = self.picture
        return x - (columns - width) // 2, y - (rows - height) // 2

    @property
    def gain_codes(self) -> tuple[int, int, int]:
        red, green, blue = (round(gain * (1 << GAIN.fraction)) for gain in self.gains)
        return red, green, blue


def window_of(picture: tuple[int, int], grid: tuple[int, int], share: Share = WHOLE) -> tuple[int, int, int, int]:
    """Return the centred crop of the grid's aspect ratio in whole pixels of a share of a picture: x, y, width, height.

    Parameters
    ----------
    picture, grid : (rows, columns)
    """
    rows, columns = (round(length * part) for length, part in zip(picture, share, strict=True))
    top, left = crop_origin((rows, columns), grid)
    covered = _covered(grid, ratio((rows, columns), grid))
    return (picture[1] - columns) // 2 + left, (picture[0] - rows) // 2 + top, *covered


def _covered(grid: tuple[int, int], scale: Fraction) -> tuple[int, int]:
    """Return width and height of the camera pixels that a grid covers, in part at least."""
    rows, columns = (pixels_of(length, scale.numerator, scale.denominator) for length in grid)
    return columns, rows
