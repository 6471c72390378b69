# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/light_gains.sv: deviations in the light of the reference, a gain for each colour.

The light of a picture differs from that of its reference by some per cent in each colour. The gain of a colour is the
light of the reference over that of the picture. Where nothing touches, ratio * gain = 1. All words are integers:

    ratio       17 bits unsigned, 15 fraction bits, I / ref of a pixel and colour
    gain        16 bits unsigned, 15 fraction bits, 1/2 <= gain < 2
    deviation   17 bits signed, 15 fraction bits, ratio * gain - 1; 0 where all three ratios of a pixel are 0

A frame moves the gains by the deviations of its pixels, the last row left out. A step of the light moves three eighths
of the pixels of a colour, or more, beyond 1/8 in one direction: then the gain moves by 1/8. Contact leaves many pixels
of all colours within 1/8: then the gain moves by their mean. A contact so large that it does neither leaves the gain as
it is. With half of the pixels in place of three eighths a light at which a third of them are near would stay as it is.

A stream has the filter of the hardware (`LightFilter`): the gains that a frame moved act on the next frame. A single
picture has the gains at which its own deviations come to rest (`settled`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_half_even, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format, joined
from tactile_depth.chip.limits import DEVIATION, LIGHT_GAIN, RATIO
from tactile_depth.chip.resources import Multiplier, Parts, Words

LATENCY = 2
NEAR_LOG2 = 3
"""-log2 of the deviation from which a pixel may be contact, and of the step of a gain."""
STEP_SHARE = 3 / 8
"""Share of the pixels of a colour, those above less those below, from which a frame is a step of the light."""
RATES = 8
"""Number of rates of the filter: a frame moves a gain by the mean over 2**rate."""
ROUNDS = 40
"""Largest number of rounds of `settled`, four times as many as light between 1/2 and 2 of the reference needs."""
QUIET_LOG2 = 5
"""-log2 of the move of a gain from which the gains do not fit the light."""
SETTLED = 2.0**-18
"""Change of a gain at which `settled` stops: an eighth of the last bit of a gain."""


@dataclass(frozen=True)
class Light:
    """The grid and the word lengths of the core."""

    rows: int
    columns: int
    ratio_width: int = RATIO.width
    ratio_fraction: int = RATIO.fraction
    gain_width: int = LIGHT_GAIN.width
    deviation: Format = DEVIATION

    @classmethod
    def of(cls, config: Configuration) -> Light:
        return cls(config.rows, config.columns)

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of hdl/gradient/light_gains.sv."""
        return {
            "Rows": self.rows,
            "Columns": self.columns,
            "RatioWidth": self.ratio_width,
            "RatioFraction": self.ratio_fraction,
            "GainWidth": self.gain_width,
            "OutWidth": self.deviation.width,
            "OutFraction": self.deviation.fraction,
        }

    @property
    def unity(self) -> int:
        """Code of a gain of 1."""
        return 1 << (self.gain_width - 1)

    @property
    def near(self) -> int:
        """Code of the deviation from which a pixel may be contact."""
        return 1 << (self.deviation.fraction - NEAR_LOG2)

    @property
    def pixels(self) -> int:
        """Pixels of a frame that move the gains: the hardware computes the move while the last row comes."""
        return (self.rows - 1) * self.columns

    def limited(self, gains: np.ndarray) -> np.ndarray:
        return gains.clip(self.unity >> 1, 2 * self.unity - 1)

    def deviations(self, ratios: np.ndarray, gains: np.ndarray, monitor: Monitor | None = None) -> np.ndarray:
        """Return deviations, int64 (..., rows, columns, 3), from ratios of the same shape and gains (..., 1, 1, 3)."""
        difference = ratios * gains - (self.unity << self.ratio_fraction)
        difference[~ratios.any(axis=-1)] = 0
        drop = self.ratio_fraction + self.gain_width - 1 - self.deviation.fraction
        return round_saturate(difference, drop, self.deviation.width, monitor, "light_gains")

    def move(self, deviations: np.ndarray, used: np.ndarray, rate: int = 0) -> np.ndarray:
        """Return what a frame takes off the gains, int64 (3,), from the deviations of all rows but its last.

        The frame has the gains `used`. Where they are below 7/8 they move half as far: in more light a gain that moved
        by the mean deviation would go beyond, and swing.
        """
        counted = deviations.reshape(-1, 3)
        above, below = counted >= self.near, counted <= -self.near
        net = np.count_nonzero(above, axis=0) - np.count_nonzero(below, axis=0)
        near = ~np.any(above | below, axis=-1)
        fine = np.zeros(3, np.int64)
        if 4 * np.count_nonzero(near) >= self.pixels:
            third = -(-2 * self.pixels // 3)
            drop = (third - 1).bit_length() + self.deviation.fraction - (self.gain_width - 1)
            slow = rate + (used < self.unity - (self.unity >> NEAR_LOG2))
            fine = round_half_even(counted[near].sum(axis=0) >> slow, drop)
        coarse = np.sign(net) << (self.gain_width - 1 - NEAR_LOG2)
        return np.where(np.abs(net) >= STEP_SHARE * self.pixels, coarse, fine)

    def is_far(self, move: np.ndarray) -> bool:
        """Return True if a gain moves so far that the gains do not fit the light."""
        return bool((move >> max(0, self.gain_width - 1 - QUIET_LOG2) != move >> self.gain_width).any())


def settled(ratios: np.ndarray, light: Light) -> np.ndarray:
    """Return the gains of single pictures, at which the light of their untouched pixels equals that of the reference.

    They are the gains to which a stream of the same picture converges, with an exact mean.

    Parameters
    ----------
    ratios : int64 array (..., rows, columns, 3)

    Returns
    -------
    int64 array (..., 3)
    """
    pictures = ratios[..., :-1, :, :].reshape(-1, light.pixels, 3)
    scaled = np.moveaxis(pictures, -1, 1).astype(np.float32) * np.float32(2.0**-light.ratio_fraction)
    gains = np.array([_settled(picture) for picture in scaled]).reshape(*ratios.shape[:-3], 3)
    return light.limited(np.rint(gains * light.unity).astype(np.int64))


def _settled(ratios: np.ndarray) -> np.ndarray:
    """Return the gains of one picture, float64 (3,), from ratios (3, pixels)."""
    gains, limit = np.ones(3), 2.0**-NEAR_LOG2
    lit = ratios[:, ratios.any(axis=0)]
    pixels = ratios.shape[1]
    blank = pixels - lit.shape[1]
    for _ in range(ROUNDS):
        deviations = lit * gains.astype(np.float32)[:, None] - np.float32(1)
        above, below = deviations >= limit, deviations <= -limit
        net = np.array(
            [np.count_nonzero(more) - np.count_nonzero(less) for more, less in zip(above, below, strict=True)]
        )
        red, green, blue = above | below
        near = ~(red | green | blue)
        count = np.count_nonzero(near) + blank
        before = gains
        if 4 * count >= pixels:
            mean = deviations.astype(np.float64) @ near.astype(np.float64) / count  # sums are exact in any order
            gains = gains / (1 + mean)
        gains = np.where(np.abs(net) >= STEP_SHARE * pixels, before - limit * np.sign(net), gains).clip(0.5, 2)
        if np.abs(gains - before).max() < SETTLED:
            break
    return gains


class LightFilter:
    """The gains of a stream, which follow its light from frame to frame.

    Attributes
    ----------
    gains : int64 array (3,)
        Gains of the next frame.
    follow : bool
        The gains move; else they stay as they are.
    rate : int
        A frame moves a gain by the mean over 2**rate.
    moves : bool
        The gains did not fit the light of the last frame.
    """

    def __init__(self, light: Light, gains: np.ndarray | None = None, follow: bool = True, rate: int = 0) -> None:
        self.light, self.follow, self.rate, self.moves = light, follow, rate, False
        self.gains = np.full(3, light.unity, np.int64) if gains is None else gains

    def take(self, ratios: np.ndarray, bad: bool = False) -> np.ndarray:
        """Return the gains of a frame of ratios (rows, columns, 3), and move them for the next unless it is bad."""
        used = self.gains
        move = self.light.move(self.light.deviations(ratios[:-1], used), used, self.rate)
        self.moves = self.light.is_far(move)
        if self.follow and not bad:
            self.gains = self.light.limited(used - move)
        return used

    def take_all(self, ratios: np.ndarray) -> np.ndarray:
        """Return the gains of frames, int64 (..., 3), that follow one another, from ratios (..., rows, columns, 3)."""
        pictures = ratios.reshape(-1, *ratios.shape[-3:])
        return np.array([self.take(picture) for picture in pictures]).reshape(*ratios.shape[:-3], 3)


class LightGains:
    """The gains, and the pixels on their way: each valid, its position, deviations, and how many of them clipped.

    Attributes
    ----------
    used : int64 array (3,)
        Gains of the frame, or of the next if none has begun.
    frame : list of int64 array (3,)
        Deviations of the frame so far.
    """

    def __init__(self, light: Light) -> None:
        self.light, self._rate = light, 0
        self._clear()

    def _clear(self) -> None:
        self._gains = self.used = np.full(3, self.light.unity)
        self.frame: list[np.ndarray] = []
        self._bad = self._clipped = 0
        self._pixels: list[tuple[int, int, Sequence[int], int]] = [(0, 0, (), 0)] * LATENCY

    def _take(self, position: int, ratios: Sequence[int]) -> tuple[int, int, Sequence[int], int]:
        """Return the pixel of these ratios."""
        monitor = Monitor()
        deviations = self.light.deviations(np.array(ratios), self.used, monitor)
        self.frame.append(deviations)
        return 1, position, deviations.tolist(), monitor.saturations.total()

    def clock(
        self, *, rst: int, en: int, follow: int, rate: int, write: int, write_gain: int, in_bad: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        (_, _, _, clips), (valid, position, deviations, _) = self._pixels
        out: dict[str, int | None] = {"out_valid": valid, "saturations": self._clipped}
        for name, gains in (("gains", self._gains), ("used", self.used)):
            out[name] = joined(gains.tolist(), self.light.gain_width)
        last = pins["in_valid"] and len(self.frame) == self.light.rows * self.light.columns - 1
        if last:
            move = self.light.move(np.array(self.frame[: self.light.pixels]), self.used, self._rate)
            out["moves"] = self.light.is_far(move)
        if valid:
            out |= zip(("out_position", "out_red", "out_green", "out_blue"), (position, *deviations), strict=True)
        self._clipped = en and clips
        if en:
            pixel: tuple[int, int, Sequence[int], int] = (0, 0, (), 0)
            self._bad |= in_bad
            if pins["in_valid"]:
                pixel = self._take(pins["in_position"], [pins[f"in_{colour}"] for colour in ("red", "green", "blue")])
            self._pixels = [pixel, *self._pixels[:-1]]
            if last:
                if follow and not self._bad:
                    self._gains = self.light.limited(self._gains - move)
                self.frame, self._bad = [], 0
        written = self.light.limited(np.array(write_gain))
        self._gains = np.where([write >> c & 1 for c in range(3)], written, self._gains)
        if rst:
            self._clear()
        if not self.frame:
            self.used, self._rate = self._gains, rate
        return out


def parts(_config: Configuration) -> Parts:
    return [Words(0), *[Multiplier(RATIO.width + 1, LIGHT_GAIN.width + 1)] * 3]
