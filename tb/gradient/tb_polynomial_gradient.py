# SPDX-License-Identifier: Apache-2.0
"""polynomial_gradient against its model in every clock."""

import random
from pathlib import Path
from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import polynomial_roms
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.polynomial_gradient import PolynomialGradient, gradient_parameters
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_polynomials
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters, raster
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, change_over, choices, pack

WORDS = (2, 3, 10)  # axes, colours, terms


def any_words(width: int, seed: int = 1) -> Any:
    return np.random.default_rng(seed).integers(-(1 << width - 1), 1 << width - 1, WORDS)


NAMES = ["Width", "DeviationWidth", "CoeffWidth", "WordWidth", "FineBits", "CorrectionWidth", "CorrectionUnit", "Drop"]


def built(*values: int, **runs: Any) -> Structure:
    word = values[NAMES.index("WordWidth")]
    return Structure(
        dict(zip(NAMES, values, strict=True)),
        roms=lambda folder: write_polynomials(folder, any_words(word), word),
        **runs,
    )


STRUCTURES = (
    built(*gradient_parameters(Configuration(columns=16)).values(), on=VERILATOR),
    built(3, 3, 3, 5, 1, 2, 5, 3, on=ICARUS, mutants=ICARUS),
    built(*gradient_parameters(Configuration(columns=16, data_width=12, coefficient_width=10)).values()),
    built(14, 4, 5, 9, 2, 3, 20, 0),
    built(*gradient_parameters(Configuration(columns=16, data_width=32, gradient_limit=2.0**-6)).values()),
    built(6, 4, 4, 4, 0, 4, 9, 1),
    built(10, 4, 5, 9, 3, 4, 3, -2),
    built(12, 4, 5, 9, 1, 4, 31, -2),
)
PROOFS = tuple(
    Proof(
        f"frames of any size; additions are exact at any width; each colour, both axes; {ROUNDING}",
        {"Polynomial": polynomial},
        steps=3,
        roms=polynomial_roms,
    )
    for polynomial in (0, 4, 2)
)


SHAPES = ((2, 8), (3, 8), (2, 9), (9, 8))  # rows and columns; in the lowest bit a carry of rows counts late


@cocotb.test()
async def frames(dut: Any) -> None:
    chance, left = random.Random(cocotb.RANDOM_SEED), list[int]()
    lines = [line for p in range(6) for line in Path(f"polynomial_{p}.hex").read_text().split()]
    entries = at_power_up([int(line, 16) for line in lines])

    def legal(model: PolynomialGradient, pins: Pins) -> None:
        """Place each pixel in a frame, which may be cut; write nothing that arrives in a change-over."""
        if pins.pop("cut") or not model.started:
            left.clear()
        if pins["in_valid"]:
            if not left:
                left.extend(raster(*chance.choice(SHAPES)))
            pins["in_position"] = left.pop(0) if pins["en"] else left[0]
        change_over(model.tables[-1], pins, bool(model.port.write))
        pins["table_write"] &= model.tables[-1].settled(pins["table_bank"])
        pins["table_read"] &= not pins["table_write"]
        pins |= {"table_index": chance.randrange(len(entries)), "table_low": chance.getrandbits(32)}
        pack(pins)

    pins = {**choices(TABLES["coefficients"]), "table_bank": (0,), "commit": 0.3, "cut": 0.001, "rst": 0.003}
    pins |= {"en": 1.0, "in_valid": 1.0, "in_position": range(16)}
    words = ("in_red", "in_green", "in_blue", "correction_gx", "correction_gy")
    model = PolynomialGradient(entries, np.max(SHAPES, axis=0), dict(zip(NAMES, parameters(dut, *NAMES), strict=True)))
    await play(dut, model, pins | dict.fromkeys(words, WORD), legal)
