# SPDX-License-Identifier: Apache-2.0
"""Writes the $readmemh files of a configuration: one line per word, with fixed names in one folder,
and CRCS, by which a simulation checks them.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.elimination import down_positions
from tactile_depth.chip.poisson.spectral_divide import reciprocal_rom, reciprocals
from tactile_depth.chip.poisson.thomas_table import thomas_table
from tactile_depth.chip.poisson.transform.commutator import positions
from tactile_depth.chip.poisson.transform.fft import path_factors, stages
from tactile_depth.chip.poisson.transform.twiddle import phase_factors
from tactile_depth.chip.poisson.tridiagonal_solver import tables

CRCS = "tables.crc"


def table_files(folder: Path) -> list[str]:
    """Return the names of the files in a folder that a simulation reads."""
    return sorted(path.name for path in folder.iterdir() if path.suffix == ".hex" or path.name == CRCS)


def write_crcs(folder: Path) -> int:
    """Write the CRC-32 of each table in a folder, as hdl/td_tables_pkg.sv reads them, and return that of the list."""
    tables = sorted(folder.glob("*.hex"))
    listed = "".join(f"{zlib.crc32(path.read_bytes()):08x} {path.name}\n" for path in tables).encode()
    (folder / CRCS).write_bytes(listed)
    return zlib.crc32(listed)


def write_words(path: Path, words: Iterable[int], width: int, parity: bool = False) -> None:
    """Write non-negative words of `width` bits, with `parity` the parity of each on top of it.

    Raises
    ------
    ValueError
        A word does not fit; nothing is written.
    """
    words = [int(word) for word in words]
    if words and not 0 <= min(words) <= max(words) < 1 << width:
        raise ValueError(f"{path.name}: words from {min(words)} to {max(words)} do not fit {width} unsigned bits")
    digits = (width + parity + 3) // 4
    whole = (word | (parity and word.bit_count() % 2) << width for word in words)
    path.write_text("".join(f"{word:0{digits}x}\n" for word in whole), newline="\n")


def pack(fields: Iterable[np.ndarray], width: int) -> list[int]:
    """Pack signed fields of `width` bits into words, the first on top; Python integers, because some exceed 64 bits."""
    words: list[int] = []
    for row in zip(*(unsigned(field, width).tolist() for field in fields), strict=True):
        word = 0
        for value in row:
            word = word << width | value
        words.append(word)
    return words


def unsigned(words: np.ndarray, width: int) -> np.ndarray:
    """Return the two's complement of signed words of `width` bits, int64 of the same shape.

    Raises
    ------
    ValueError
        A word does not fit.
    """
    words = np.asarray(words)
    half = 1 << width - 1
    if words.size and not -half <= words.min() <= words.max() < half:
        raise ValueError(f"words from {words.min()} to {words.max()} do not fit {width} signed bits")
    return words & (2 * half - 1)


def write_factors(path: Path, factors: np.ndarray, width: int, parity: bool = False) -> None:
    """Write complex factors (beats, paths, 2) as twiddle.sv reads them: {-Im, Im, Re} of each path, path 0 lowest."""
    re, im = np.moveaxis(factors[:, ::-1], -1, 0)
    fields = np.stack((-im, im, re), axis=-1).reshape(len(re), -1)
    write_words(path, pack(fields.T, width), fields.shape[1] * width, parity)


def write_direction(folder: Path, size: int, paths: int, inverse: bool, width: int, parity: bool = False) -> None:
    """Write the ROMs of fft.sv in one direction, and the phases of the transform around it."""
    direction = "inverse" if inverse else "forward"
    blocks = sorted({s.block for s in stages(size, inverse) if s.delay == 0}, reverse=True)
    for pair, block in enumerate(blocks):
        factors = path_factors(size, paths, block, inverse, width)
        write_factors(folder / f"twiddle_{direction}_{pair}.hex", factors, width, parity)
    phases = phase_factors(size, inverse, width)
    write_factors(folder / f"phase_{direction}.hex", phases[positions(size, paths, 0)], width, parity)


def write_gradient(path: Path, codes: np.ndarray, width: int, parity: bool = False) -> None:
    """Write slope codes (bins, 2) as gradient_lookup.sv reads them: {gy, gx}."""
    write_words(path, pack((codes[:, 1], codes[:, 0]), width), 2 * width, parity)


def write_gains(folder: Path, gains: np.ndarray, width: int, parity: bool = False) -> None:
    """Write gains (node rows, node columns, 3) as flat_field.sv reads them."""
    write_nodes(folder, "gain", gains, width, parity=parity)


def write_zero(folder: Path, zero: np.ndarray, width: int, side: int = 1, parity: bool = False) -> None:
    """Write depth codes (node rows, node columns) as zero_offset.sv reads them."""
    write_nodes(folder, "zero", unsigned(zero, width)[..., None], width, side, parity)


def write_nodes(folder: Path, name: str, nodes: np.ndarray, width: int, side: int = 1, parity: bool = False) -> None:
    """Write words (node rows, node columns, channels) as td_node_map.sv reads them.

    Each channel has `side` files, and each of these the words of every side-th node.
    """
    for file, words in enumerate(np.asarray(nodes).reshape(-1, side * np.shape(nodes)[-1]).T):
        write_words(folder / f"{name}_{file}.hex", words, width, parity)


def write_polynomials(folder: Path, words: np.ndarray, width: int, parity: bool = False) -> None:
    """Write words (2, 3, 10) as the tables of polynomial_gradient.sv read them: one file for each polynomial."""
    for polynomial, terms in enumerate(words.reshape(-1, words.shape[-1])):
        write_words(folder / f"polynomial_{polynomial}.hex", pack((terms,), width), width, parity)


def write_thomas(folder: Path, config: Configuration) -> None:
    """Write the ROMs of the two tables of tridiagonal_solver.sv, the coefficients of a clock side by side in a word."""
    width, table = config.coefficient.width, thomas_table(config)
    last = down_positions(config)
    for name, packed in zip(("down", "up"), tables(config), strict=True):
        count = packed.words.shape[1]
        write_words(folder / f"{name}.hex", pack(packed.words.T[::-1], width), count * width, config.parity)
        write_words(folder / f"{name}_index.hex", packed.index, packed.index_width, config.parity)
    words = []
    for shift, word in zip(table.last_shift[last], pack(table.last[last].T[::-1], width), strict=True):
        shifts = 0
        for each in shift[::-1].tolist():
            shifts = shifts << table.last_shift_width | each
        words.append(shifts << last.shape[1] * width | word)
    bits = last.shape[1] * (table.last_shift_width + width)
    write_words(folder / "down_last.hex", words, bits, config.parity)


def write_solver(folder: Path, config: Configuration) -> None:
    """Write the ROMs of the solver."""
    width = config.coefficient.width
    for inverse, paths in enumerate((config.down_words, config.up_paths)):
        write_direction(folder, config.columns, paths, bool(inverse), width, config.parity)
    if config.solver == "tridiagonal":
        write_thomas(folder, config)
    else:
        bits = width + reciprocals(config).shift_width
        write_words(folder / "reciprocal.hex", reciprocal_rom(config), bits, config.parity)
