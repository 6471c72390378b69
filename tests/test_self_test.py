# SPDX-License-Identifier: Apache-2.0
"""Self-test of each preset: a flipped bit of a table that its picture reads changes the signature."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

from commands.common.run_request import of_values
from commands.hardware import synthesis
from commands.run import bench
from tactile_depth.chip.common.signature import signature
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_offset import no_zero
from tactile_depth.chip.gradient.flat_field import pixel_gains, reference_gains
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes
from tactile_depth.chip.gradient.light_gains import Light
from tactile_depth.chip.gradient.polynomial_gradient import (
    coefficient_map,
    correction_codes,
    correction_entries,
    polynomial_words,
)
from tactile_depth.chip.limits import CORRECTION_BITS, CORRECTION_WIDTH, POLYNOMIAL
from tactile_depth.chip.poisson import elimination, spectral_divide, substitution
from tactile_depth.chip.poisson.thomas_table import PackedTable, thomas_table
from tactile_depth.chip.poisson.transform import dst_forward, dst_inverse, fft
from tactile_depth.chip.poisson.transform.twiddle import phase_factors, twiddle, twiddle_factors
from tactile_depth.chip.poisson.tridiagonal_solver import tables as solver_tables
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.self_test import built_in, self_test
from tactile_depth.chip.tactile_depth import Tables, slope_tables, slopes_and_light
from tactile_depth.chip.video.test_picture import picture
from tactile_depth.sensor.sensor import Sensor

SEED, FLIPS = 61, 200
SHARES = {"published": {"gradient": 0.97}, "sensor": {"corrections": 0.88}, "chip": {"corrections": 0.89}}
"""Entries of tables of colours that pixels read, and that no clipped slope hides."""
ROMS = ("twiddle", "phase", "reciprocal", "down", "up", "index", "last")


def signed(words: Any, width: int) -> Any:
    return ((words & (1 << width) - 1) ^ 1 << width - 1) - (1 << width - 1)


def multiply(re: np.ndarray, im: np.ndarray, factors: np.ndarray, *formats: Any, **named: Any) -> Any:
    """Multiply by words {-Im, Im, Re} of a ROM, of which a flip changes one."""
    if factors.shape[1] == 2:
        return twiddle(re, im, factors, *formats, **named)
    real = twiddle(re, im, np.stack([factors[:, 0], -factors[:, 2]], axis=-1), *formats, **named)[0]
    return real, twiddle(re, im, factors[:, :2], *formats, **named)[1]


def unpacked(table: PackedTable, count: int) -> np.ndarray:
    """Return the first rows of a table, (count, positions); its index may point behind its end."""
    index = table.base + np.minimum(np.arange(count)[:, None], table.settled)
    return table.words[np.minimum(index, len(table.words) - 1)]


@dataclass
class Preset:
    """The models of a preset, with any word of its tables replaced."""

    config: Configuration
    sensor: Sensor

    @cached_property
    def tables(self) -> Tables:
        return slope_tables(self.sensor, self.config)

    @cached_property
    def right(self) -> int:
        return built_in(self.sensor, self.config)

    @cached_property
    def words(self) -> dict[str, tuple[np.ndarray, int]]:
        """Words and width of each table."""
        config, sensor = self.config, self.sensor
        width, words = config.coefficient.width, {}
        if config.polynomials:
            words["coefficients"] = polynomial_words(sensor, config), POLYNOMIAL.width
            corrections = correction_entries(sensor, config)
            assert corrections is not None
            words["corrections"] = corrections, CORRECTION_WIDTH
            words["gains"] = reference_gains(sensor, config), config.gain.width
            words["zero"] = no_zero(config), config.depth.width
        else:
            words["gradient"] = gradient_codes(sensor, config), config.gradient.width
        for inverse in (False, True):
            factors = {"phase": phase_factors(config.columns, inverse, width)}
            for stage in fft.stages(config.columns, inverse):
                if not stage.delay:
                    factors[f"twiddle {stage.block}"] = twiddle_factors(stage.block, inverse, width)
            for name, pair in factors.items():
                words[f"{name} {inverse}"] = np.column_stack([pair, -pair[:, 1]]), width
        if config.solver == "spectral":
            shift_width = spectral_divide.reciprocals(config).shift_width
            words["reciprocal"] = spectral_divide.reciprocal_rom(config), width + shift_width
        else:
            table = thomas_table(config)
            for name, packed in zip(("down", "up"), solver_tables(config), strict=True):
                words |= {name: (packed.words, width), f"index {name}": (packed.index, packed.index_width)}
            last = table.last_shift << width | table.last & (1 << width) - 1
            words["last"] = last, width + table.last_shift_width
        return words

    def read(self, name: str) -> np.ndarray:
        """Return the words of a table that the picture reads, of colours those that no clipped slope hides."""
        config, frame = self.config, picture(self.config.rows, self.config.columns)
        if name not in ("gradient", "corrections"):
            return np.arange(self.words[name][0].size)
        gains = np.full((1, 3), Light.of(config).unity)
        (slopes,), _ = slopes_and_light(frame[None], config, self.tables, light=gains)
        bits, colours = config.bits_per_channel, frame
        if config.polynomials:
            assert self.tables.gains is not None
            ratios = self.tables.gains.ratios(frame)
            bits, colours = CORRECTION_BITS, correction_codes(Light.of(config).deviations(ratios, gains[0]))
        red, green, blue = np.moveaxis(colours.astype(int) >> 8 - bits, -1, 0)
        entry, limit = (red << bits | green) << bits | blue, 1 << config.gradient.width - 1
        inside = (-limit < slopes) & (slopes < limit - 1)
        return np.concatenate([2 * np.unique(entry[inside[..., axis]]) + axis for axis in (0, 1)])

    def signature(self, name: str, words: np.ndarray) -> int:
        """Return the signature with a table replaced."""
        tables, zero = self.tables, None
        if name == "coefficients":
            tables = replace(tables, slopes=coefficient_map(words, self.config))
        elif name == "gradient":
            tables = replace(tables, slopes=words)
        elif name == "corrections":
            tables = replace(tables, corrections=words)
        elif name == "gains":
            tables = replace(tables, gains=pixel_gains(words, self.config))
        elif name == "zero":
            zero = words
        with contextlib.ExitStack() as stack:
            for module, function, value in self._replaced(name, words):
                stack.enter_context(mock.patch.object(module, function, value))
            return self_test(self.config, tables, zero)

    def hides(self, name: str, at: int, mask: int) -> bool:
        """Return True if the signature is right with bits of a word flipped."""
        words, width = self.words[name]
        changed, is_signed = words.copy(), name.split()[0] not in ("gains", "reciprocal", "index", "last")
        word = changed.flat[at] ^ mask
        changed.flat[at] = signed(word, width) if is_signed else word & (1 << width) - 1
        return self.signature(name, changed) == self.right

    def _replaced(self, name: str, words: np.ndarray) -> list[tuple[Any, str, Any]]:
        """Return what a ROM replaces: modules, their functions, and others."""
        width, kind = self.config.coefficient.width, name.split()[0]
        transforms: list[Any] = [dst_forward, dst_inverse]
        products = [(module, "twiddle", multiply) for module in (fft, *transforms)]
        if kind == "twiddle":

            def twiddles(block: int, inverse: bool, width: int) -> np.ndarray:
                return words if name == f"twiddle {block} {inverse}" else twiddle_factors(block, inverse, width)

            return [*products, (fft, "twiddle_factors", twiddles)]
        if kind == "phase":
            transform = transforms[name.endswith("True")]
            return [*products, (transform, "phase_factors", lambda *_: words)]
        if kind == "reciprocal":
            table, lower = spectral_divide.reciprocals(self.config), np.tril_indices(self.config.columns)
            mantissa, shift = table.mantissa.copy(), table.shift.copy()
            for whole, part in ((mantissa, signed(words, width)), (shift, words >> width)):
                whole[lower] = whole.T[lower] = part
            flipped = replace(table, mantissa=mantissa, shift=shift)
            return [(spectral_divide, "reciprocals", lambda _: flipped)]
        if kind not in ROMS:
            return []
        if kind == "last":
            thomas = replace(thomas_table(self.config), last=signed(words, width), last_shift=words >> width)
            return [(elimination, "thomas_table", lambda _: thomas)]
        down, up = solver_tables(self.config)
        packed = up if "up" in name else down
        bits = packed.settled_width
        if kind == "index":
            packed = replace(packed, base=words >> bits, settled=words & (1 << bits) - 1)
        else:
            packed = replace(packed, words=words)
        rows, columns = self.config.rows, self.config.columns
        if "up" in name:
            pairs = unpacked(packed, (rows - 1) // 2)[:, :, ::-1]  # (pairs, clocks, upper and lower row)
            ahead = np.moveaxis(pairs, 2, 1).reshape(-1, columns)[rows % 2 :]
            return [(substitution, "ahead_rows", lambda _: ahead)]
        last = elimination.coefficient_rows(self.config, rows)[-1:]
        inner = np.concatenate((unpacked(packed, rows - 1).reshape(-1, columns), last))
        return [(elimination, "coefficient_rows", lambda *_: inner)]


def preset_of(name: str) -> Preset:
    _, sensor, config = synthesis.design(of_values({"PRESET": name}, frames=""))
    return Preset(config, sensor)


@pytest.mark.parametrize("name", SHARES)
def test_flipped_bits_are_found(name: str) -> None:
    """Flip bits, in each table as often: all of the upper half of a word show, and 90 % of all.

    Words of ROMs that no picture shows do not count, such as imaginary parts where a transform puts out a real one:
    those that change nothing with all their bits flipped.
    """
    preset, random = preset_of(name), np.random.default_rng(SEED)
    shares = {table: len(preset.read(table)) / preset.words[table][0].size for table in SHARES[name]}
    assert all(shares[table] > share for table, share in SHARES[name].items()), shares
    missed, flips = [], 0
    while flips < FLIPS:
        table = str(random.choice([*preset.words]))
        width = preset.words[table][1]
        at, bit = int(random.choice(preset.read(table))), int(random.integers(width))
        if table.split()[0] in ROMS and preset.hides(table, at, (1 << width) - 1):
            continue
        flips += 1
        if preset.hides(table, at, 1 << bit):
            missed.append((table, at, bit, width))
    assert not [(table, at, bit) for table, at, bit, width in missed if 2 * bit >= width], "upper half"
    assert len(missed) <= FLIPS // 10, f"seed {SEED}: {missed}"


@pytest.mark.parametrize("name", SHARES)
def test_rtl_has_the_signature(name: str, tmp_path: Path) -> None:
    """Write CONTROL once behind a reset, with the tables of the build; the frame behind the test is as ever."""
    preset = preset_of(name)
    config, frame = preset.config, picture(preset.config.rows, preset.config.columns)
    pause = bench.entry("idle", 4 * config.rows * config.columns)
    played = bench.play(
        "verilator",
        config,
        preset.sensor,
        np.concatenate([[pause], bench.frame_entries(frame[None])]),
        tmp_path,
        clocks=16 * config.rows * config.columns,
        total_frames=1,
        registers={"CONTROL": REGISTERS["CONTROL"].pack(self_test=1)},
    )
    counts = played.registers
    assert (counts["self_test"], counts["frames_in"], counts["frames_out"]) == (preset.right, 1, 1)
    assert signature(played.codes.tolist()) == preset.right
