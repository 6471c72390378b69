# SPDX-License-Identifier: Apache-2.0
"""Tables that the proofs of make formal read, with contents that no proof depends on."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tactile_depth.chip.camera.camera_setup import Entry, Kind
from tactile_depth.chip.camera.register_lists import write_list
from tactile_depth.chip.rom_files import write_nodes, write_polynomials, write_words, write_zero


def gradient_rom(folder: Path) -> None:
    """Eight pairs of slopes of one bit, every pair twice."""
    write_words(folder / "gradient.hex", [bin * 5 % 4 for bin in range(8)], 2)


def polynomial_roms(folder: Path) -> None:
    """Words of two bits, arbitrary ones, another order in every polynomial."""
    choose = random.Random(1)
    write_polynomials(folder, np.array([choose.getrandbits(2) - 2 for _ in range(60)]).reshape(2, 3, 10), 2)


def gain_rom(nodes: int) -> Callable[[Path], None]:
    """Gains of one bit."""
    return node_rom("gain", nodes, 3)


def zero_rom(folder: Path) -> None:
    """Two nodes of two bits."""
    write_zero(folder, np.array([-1, 1]), 2)


def node_rom(name: str, nodes: int, channels: int, side: int = 1) -> Callable[[Path], None]:
    """Nodes of one bit, `side` of them in a word of the memory, all channels alike; channel.hex: one of them."""

    def write(folder: Path) -> None:
        words = np.array([node % 3 & 1 for node in range(nodes)])
        write_nodes(folder, name, np.stack([words] * channels, axis=-1), 1, side)
        write_words(folder / "channel.hex", words, 1)

    return write


def camera_list(folder: Path) -> None:
    """Five entries, every kind; the first and the third are not compared."""
    kinds = (Kind.PINS, Kind.CHECK, Kind.PLAIN_WRITE, Kind.WRITE, Kind.WRITE)
    write_list(folder, [Entry(kind, 0x35CA + 77 * place, 3 + 85 * place % 250) for place, kind in enumerate(kinds)])


def transform_roms(paths: int, beats: int) -> Callable[[Path], None]:
    """Factors of 3 bits for a transform of 8 with `paths` paths: arbitrary ones, no beat like the next."""

    def write(folder: Path) -> None:
        words = [(37 * n + 9) % 512 for n in range(paths * beats)]
        packed = [sum(words[beat * paths + path] << 9 * path for path in range(paths)) for beat in range(beats)]
        for direction in ("forward", "inverse"):
            for kind in ("twiddle", "phase"):
                name = f"{kind}_{direction}{'_0' * (kind == 'twiddle')}.hex"
                write_words(folder / name, packed, 9 * paths)

    return write


def factor_rom(paths: int, beats: int, ones: int) -> Callable[[Path], None]:
    """Factors {-Im, Im, Re} of 3 bits, every field of every word another, but 1 in the paths of `ones`."""

    def factor(beat: int, path: int) -> int:
        n = beat * paths + path
        return 3 if ones >> path & 1 else (3 * n + 2) % 8 << 6 | (3 * n + 1) % 8 << 3 | 3 * n % 8

    return lambda folder: write_words(
        folder / "factors.hex",
        [sum(factor(beat, path) << 9 * path for path in range(paths)) for beat in range(beats)],
        9 * paths,
    )


def divide_rom(size: int) -> Callable[[Path], None]:
    """Words {S, M}, every one another; square.hex: M 2^S for every burst and word."""

    def write(folder: Path) -> None:
        words = [(index % 2, 1 + 3 * index) for index in range(size * (size + 1) // 2)]
        write_words(folder / "reciprocal.hex", [shift << 8 | mantissa for shift, mantissa in words], 9)
        square = []
        for p in range(size):
            for t in range(size):
                larger, smaller = max(p, t), min(p, t)
                shift, mantissa = words[larger * (larger + 1) // 2 + smaller]
                square.append(mantissa << shift)
        write_words(folder / "square.hex", square, 10)

    return write


def thomas_roms(
    rows: int, size: int, words: int, width: int, settled_width: int, shift_width: int
) -> Callable[[Path], None]:
    """Tables of arbitrary contents for thomas_table.sv; square.hex: {shift, coefficient} for every row and position."""

    def write(folder: Path) -> None:
        choose = random.Random(1)
        address_width = (words - 1).bit_length()
        settled = [position % (rows - 1) for position in range(size)]  # settled at once, later, in the last but one row
        base = [sum(settled[:position]) + position for position in range(size)]
        inner = [choose.randrange(1 << width) for _ in range(words)]
        last = [choose.randrange(1 << width) for _ in range(size)]
        shift = [choose.randrange(1 << shift_width) for _ in range(size)]
        assert base[-1] + settled[-1] < words
        write_words(folder / "down.hex", inner, width)
        index = [b << settled_width | s for b, s in zip(base, settled, strict=True)]
        write_words(folder / "down_index.hex", index, address_width + settled_width)
        ends = [s << width | c for s, c in zip(shift, last, strict=True)]
        write_words(folder / "down_last.hex", ends, shift_width + width)
        square = [inner[b + min(row, s)] for row in range(rows - 1) for b, s in zip(base, settled, strict=True)]
        write_words(folder / "square.hex", square + ends, shift_width + width)

    return write


def up_roms(pairs: int, beats: int) -> Callable[[Path], None]:
    """Tables of substitution.sv, two words of 3 bits: none is 0, and none is like that of the next pair or word.

    square.hex: the words for every pair, the first one with the first row of a frame, and beat.
    """

    def write(folder: Path) -> None:
        inner = [1 + (2 * n + 3) % 7 << 3 | 1 + 2 * n % 7 for n in range(32)]
        settled = [pairs - 1 - beat % 2 for beat in range(beats)]
        base = [sum(settled[:beat]) + beat for beat in range(beats)]
        assert base[-1] + settled[-1] < 32
        write_words(folder / "up.hex", inner, 6)
        write_words(folder / "up_index.hex", [b << 3 | s for b, s in zip(base, settled, strict=True)], 8)
        square = [inner[b + min(pair, s)] for pair in range(pairs) for b, s in zip(base, settled, strict=True)]
        write_words(folder / "square.hex", square, 7)

    return write
