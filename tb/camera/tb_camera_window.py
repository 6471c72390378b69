# SPDX-License-Identifier: Apache-2.0
"""camera_window against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.camera.camera_window import CameraWindow
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Mutants, Structure


def built(width: int, height: int, words: int, pairs: int, count_width: int, **runs: Any) -> Structure:
    """With few bits for columns and rows, small pictures reach every bit."""
    window = {"WindowColumns": width, "WindowRows": height, "CountWidth": count_width}
    return Structure({**window, "WordsPerPixel": words, "PixelPairs": pairs}, **runs)


STRUCTURES = (
    built(4, 3, 1, 0, 13, on=VERILATOR),
    built(4, 3, 1, 0, 5, on=ICARUS, mutants=ICARUS),
    built(3, 2, 2, 1, 5, on=ICARUS, mutants=ICARUS),
    built(2, 2, 1, 1, 13),
    built(5, 4, 2, 0, 13),
    built(3, 2, 2, 1, 13),
)
PROTOCOL = {
    "counts": "live & ~reset",
    "out_data out_inside out_odd_row out_odd_column": "counts & out_valid",
    "out_row_start out_frame_start": "counts & out_valid & out_inside",
}
MUTANTS = Mutants(repeats=2)
PROOFS = tuple(
    Proof("rows and columns are only counted and compared", {"WordsPerPixel": words, "PixelPairs": pairs})
    for words, pairs in ((1, 0), (1, 1))
)


@cocotb.test
async def pictures(dut: Any) -> None:
    width, height, words, pairs, bits = parameters(
        dut, "WindowColumns", "WindowRows", "WordsPerPixel", "PixelPairs", "CountWidth"
    )
    chance = random.Random(cocotb.RANDOM_SEED)
    beside = [1, 0, 2, -1, *range(3, 9), *(1 << bit for bit in range(bits))]
    pins = {
        "en": 1.0,
        "columns": beside,
        "rows": beside,
        "window_x": [1, 0, *range(28), (1 << bits) - 1],
        "window_y": [1, 0, *range(28), (1 << bits) - 1],
        "s_valid": 1.0,
        "s_data": WORD,
        "s_last": 0.1,
        "s_user": 0.1,
    }

    def legal(core: CameraWindow, pins: Pins) -> None:
        """Set sizes, as far beyond the window as the choice says, and marks, wrong where it says so.

        A tenth of the starts is missing.
        """
        pins["columns"] = (pins["window_x"] + width + pins["columns"]) % (1 << bits)
        pins["rows"] = (pins["window_y"] + height + pins["rows"]) % (1 << bits)
        pins["s_valid"] &= core.before is not None
        pins["s_user"] ^= core.now is None and chance.random() < 0.9
        pins["s_last"] ^= core.row_ends

    await play(dut, CameraWindow((width, height), words, bool(pairs)), pins, legal, clocks=max(CLOCKS, 18_000))
