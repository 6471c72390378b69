# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/flat_field.sv: colours relative to the reference frame.

The reference (the frame without contact) is kept as gains, 1 / reference, on a coarse grid of block means. The gains
are interpolated between the centres of the blocks (td_node_map). Lighting is smooth, so the interpolation causes no
visible error. A pixel takes one multiplication for each colour and no division. All words are integers:

    pixel       8 bits unsigned
    gain        unsigned, 2**(W + 3) / reference in a word of W bits, by default 24; at the nodes, and at the pixels
    code        8 bits unsigned, 128 I / ref, for the table: 128 equals the reference, saturated at 255
    deviation   17 bits signed, 15 fraction bits, I / ref - 1, for the models of polynomials, saturated at 2
    ratio       17 bits unsigned, 15 fraction bits, I / ref, for the light gains, saturated at 4

A pixel is dark where all its colours are below `dark_level` (0: no pixel is), or where the reference of any colour is
below 16 grey levels, which sets the top bit of its gain. The output of a dark pixel repeats the output of the pixel
before it in its row; a dark first pixel of a row reads flat, or as ratios of 0. Every dark pixel is counted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tactile_depth.base.errors import Argument, InputError, Part
from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.td_block_sum import block_sum
from tactile_depth.chip.common.td_node_map import node_map
from tactile_depth.chip.common.td_round_saturate import Monitor, round_half_even, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format, split
from tactile_depth.chip.limits import DARKEST_LOG2, DEVIATION, RATIO
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.resources import Multiplier, Parts, Words, banks, delay_line

LATENCY = td_node_map.latency(1, 1) + 3

PIXEL_MARKS = 1 + 4  # dark, and the position: they travel with a pixel through td_node_map
FLAT_CODE = 128
CODE_WIDTH = 8
CODE = Format(CODE_WIDTH, FLAT_CODE.bit_length() - 1)
"""Format of a code, unsigned."""
REFERENCE = Argument("reference")


def unit_gains(config: Configuration) -> np.ndarray:
    """Return the gains at power-up, those of a reference of 128 everywhere: codes equal the pixels.

    Returns
    -------
    int64 array (node rows, node columns, 3)
    """
    return np.full((*config.reference_nodes, 3), (1 << config.gain.fraction) // FLAT_CODE, np.int64)


def flat_field_parameters(config: Configuration, output: Format) -> dict[str, int]:
    """Parameters of hdl/gradient/flat_field.sv, whose output is `CODE`, `DEVIATION` or `RATIO`."""
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "GainWidth": config.gain.width,
        "Drop": config.gain.fraction - output.fraction,
        "Offset": 1 << output.fraction if output == DEVIATION else 0,
        "OutWidth": output.width,
        "Flat": FLAT_CODE if output == CODE else 0,
    }


def reference_gains(calibration: Calibration, config: Configuration) -> np.ndarray:
    """Return the gains of a calibration's reference frame, int64 (node rows, node columns, 3)."""
    if calibration.reference is None:
        return unit_gains(config)
    return captured_gains(calibration.reference.reshape(-1, *calibration.reference.shape[-3:]), config)


def captured_gains(frames: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the gains from frames without contact.

    A gain is 2**gain_fraction over the mean of a block over all frames, rounded with ties up, and saturated.

    Parameters
    ----------
    frames : uint8 array (2**k, rows, columns, 3)

    Returns
    -------
    int64 array (node rows, node columns, 3)
    """
    count = len(frames)
    assert count.bit_count() == 1, "a power of two of frames"
    log2 = config.reference_block_log2
    total = block_sum(frames.astype(np.int64), log2).sum(axis=0)
    return gains_of(total, np.int64(2 * count << (config.gain.fraction + 2 * log2)), config.gain.width)


def gains_of(sums: np.ndarray, dividend: int | np.int64, width: int) -> np.ndarray:
    """Return half of the dividend over each sum, rounded with ties up, and saturated."""
    return np.minimum((dividend // np.maximum(sums, 1) + 1) >> 1, (1 << width) - 1)


@dataclass(frozen=True)
class PixelGains:
    """Gains of every pixel, computed once by `pixel_gains` for all frames that use the same nodes.

    Attributes
    ----------
    gains : int64 array (rows, columns, 3)
    dead : bool array (rows, columns)
        True where the reference of any colour is too dark, so that the pixel is dark in every frame.
    config : Configuration
    """

    gains: np.ndarray
    dead: np.ndarray
    config: Configuration

    def dark(self, frames: np.ndarray, dark_level: int = 0) -> np.ndarray:
        """Return the dark pixels, which repeat the pixel before them: bool (..., rows, columns)."""
        if not dark_level:  # no colour is below 0
            return np.broadcast_to(self.dead, frames.shape[:-1])
        return np.logical_or((frames < dark_level).all(axis=-1), self.dead)

    def colours(self, frames: np.ndarray, dark_level: int = 0, monitor: Monitor | None = None) -> np.ndarray:
        """Return the colours of frames relative to the reference, as the gradient model of the configuration takes
        them."""
        own = (self.ratios if self.config.light_gains else self.deviations) if self.config.polynomials else self.codes
        return own(frames, dark_level, monitor)

    def codes(self, frames: np.ndarray, dark_level: int = 0, monitor: Monitor | None = None) -> np.ndarray:
        """Return the codes 128 I / ref of frames: uint8 (..., rows, columns, 3) to uint8 of the same shape."""
        return self._relative(frames, dark_level, monitor, CODE, FLAT_CODE).astype(np.uint8)

    def ratios(self, frames: np.ndarray, dark_level: int = 0, monitor: Monitor | None = None) -> np.ndarray:
        """Return the codes of I / ref, `RATIO`, of frames: uint8 (..., rows, columns, 3) to int64, same shape."""
        return self._relative(frames, dark_level, monitor, RATIO, 0)

    def _relative(
        self, frames: np.ndarray, dark_level: int, monitor: Monitor | None, output: Format, flat: int
    ) -> np.ndarray:
        """Return unsigned codes of I / ref."""
        code = round_half_even(frames * self.gains, self.config.gain.fraction - output.fraction)
        dark, largest = self.dark(frames, dark_level), (1 << output.width) - 1
        if monitor is not None:
            monitor.clipped("flat_field", int(np.count_nonzero((code > largest) & ~dark[..., None])))
        return hold_dark(np.minimum(code, largest), dark, flat)

    def deviations(self, frames: np.ndarray, dark_level: int = 0, monitor: Monitor | None = None) -> np.ndarray:
        """Return the codes of I / ref - 1, `DEVIATION`: uint8 (..., rows, columns, 3) to int64 of the same shape."""
        dark, fraction = self.dark(frames, dark_level), self.config.gain.fraction
        ratio = np.where(dark[..., None], 0, frames) * self.gains  # saturation is not counted at dark pixels
        ratio -= 1 << fraction
        code = round_saturate(ratio, fraction - DEVIATION.fraction, DEVIATION.width, monitor, "flat_field")
        return hold_dark(code, dark, 0)


def pixel_gains(gains: np.ndarray, config: Configuration) -> PixelGains:
    """Interpolate the gains of the nodes (node rows, node columns, 3), and find the dead pixels."""
    interpolated = node_map(gains, config)
    dead = np.bitwise_or.reduce(interpolated, axis=-1) >> (config.gain.width - 1) != 0
    return PixelGains(interpolated, dead, config)


def untouched_of(gains: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the picture without contact that gains are of, uint8 (rows, columns, 3)."""
    levels = (1 << config.gain.fraction) / np.maximum(pixel_gains(gains, config).gains, 1)
    return np.rint(levels).clip(0, 255).astype(np.uint8)


def require_light(gains: np.ndarray, config: Configuration, name: Part = REFERENCE) -> None:
    """Raise InputError, which names the reference, if it is too dark for more than half of the pixels."""
    dead = pixel_gains(gains, config).dead
    if 2 * np.count_nonzero(dead) > dead.size:
        raise InputError(
            *(name, f": under {1 << (DARKEST_LOG2 + 1)} grey levels in a colour at {100 * dead.mean():.0f} % of the "),
            "pixels, from which nothing can be read",
            remedy="take it with the lights on and with a longer exposure",
        )


def hold_dark(codes: np.ndarray, dark: np.ndarray, flat: int) -> np.ndarray:
    """Replace each dark pixel by the last pixel before it in its row that is not dark, or by `flat` if all are dark."""
    if not dark.any():
        return codes
    columns = np.arange(dark.shape[-1])
    last = np.maximum.accumulate(np.where(dark, -1, columns), axis=-1)[..., None]
    return np.where(last < 0, flat, np.take_along_axis(codes, np.maximum(last, 0), axis=-2))


class FlatField:
    """Gains, and the pixels behind them: each valid, its position, dark, its colours, and how many of them clip."""

    def __init__(self, config: Configuration, parameters: Mapping[str, int], entries: Sequence[int | None]) -> None:
        self.map = td_node_map.NodeMap(config, entries, TABLES["reference"], 3, 1, 0)
        self.drop, self._parameters, self._level = parameters["Drop"], parameters, 0
        self._clear()
        self._out: list[int | None] = [None] * 3

    def _clear(self) -> None:
        self._pixels: list[tuple] = [(0, 0, 0, [None] * 3, 0)] * 3
        self._dark: int | None = 0
        self._clipped: int | None = 0

    def _relative(self, pixel: int, gains: int | None) -> tuple:
        """Return whether a pixel is dark, its colours, and how many of them clip; None without known gains."""
        dim, colours = pixel >> 24, [pixel >> place & 255 for place in (16, 0, 8)]
        if gains is None:
            return None, [None] * 3, None
        words = split(gains, 3, self.map.width)
        width, half, out = self._parameters["OutWidth"], (1 << self.drop) // 2, []
        for colour, gain in zip(colours, words, strict=True):
            product = colour * gain - (self._parameters["Offset"] << self.drop)
            out.append((product + half - (product >> self.drop & 1 ^ 1)) >> self.drop)
        high = (1 << width - (self._parameters["Offset"] != 0)) - 1
        limited = [min(max(colour, -high - 1), high) for colour in out]
        dark = dim or any(gain >> self.map.width - 1 for gain in words)
        return dark, limited, 0 if dark else sum(map(int.__ne__, out, limited))

    def clock(
        self, *, dark_level: int, capture_gains: int, in_pixel: int, in_position: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        _, last, (valid, position, *_) = self._pixels
        out = dict(zip(("out_red", "out_green", "out_blue"), self._out if valid else [None] * 3, strict=True))
        out |= {"out_valid": valid, "out_position": position if valid else None}
        out |= {"dark": self._dark, "saturations": self._clipped}
        level = dark_level if in_position & 3 == 3 else self._level
        dim = level > max(in_pixel >> place & 255 for place in (0, 8, 16))
        data, start = (in_position << 1 | dim) << 24 | in_pixel, in_position & 3 == 3
        nodes = self.map.clock(**pins, capture_words=capture_gains, in_frame_start=start, in_data=data)
        out |= {name: nodes[name] for name in ("table_answer", "table_in_use")}
        out["capture_read_gains"] = nodes["capture_read_words"]
        self._dark = self._clipped = 0
        if pins["en"]:
            if pins["in_valid"]:
                self._level = level
            if last[0]:
                self._dark, self._clipped = last[2], last[4]
                if last[2] is None:
                    self._out = [None] * 3
                elif not last[2] or last[1] & 2:
                    self._out = [self._parameters["Flat"]] * 3 if last[2] else last[3]
            pixel = (0, 0, 0, [None] * 3, 0)
            if nodes["out_valid"]:
                data = nodes["out_data"]
                pixel = (1, data >> 25, *self._relative(data & (1 << 25) - 1, nodes["out_words"]))
            self._pixels = [pixel, *self._pixels[:-1]]
        if pins["rst"]:
            self._clear()
        return out


def parts(config: Configuration) -> Parts:
    """Return the tables of gains, and the products of a node by its row weight, of a colour by its gain."""
    gain, log2, (rows, columns) = config.gain_width, config.reference_block_log2, config.reference_nodes
    return [
        Words(gain),
        *[Multiplier(gain + 1, log2 + 2), Multiplier(gain + 1, 9)] * 3,
        *banks(gain, rows * columns) * 3,
        *delay_line(3 * 8 + PIXEL_MARKS, td_node_map.latency(1, log2)),
    ]
