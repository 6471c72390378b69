# SPDX-License-Identifier: Apache-2.0
"""td_block_sum against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_block_sum import BlockSum
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure

NAMES = ("Rows", "Columns", "BlockLog2", "ColumnLog2", "Channels", "Width", "Signed", "SumWidth")


def built(*case: int, **runs: Any) -> Structure:
    return Structure(dict(zip(NAMES, case, strict=True)), **runs)


STRUCTURES = (
    built(21, 16, 2, 2, 1, 24, 1, 38, on=VERILATOR),
    built(5, 8, 1, 1, 3, 8, 0, 11, on=ICARUS, mutants=ICARUS),
    built(5, 4, 1, 1, 1, 4, 1, 8, on=ICARUS),
    built(7, 4, 1, 0, 2, 5, 1, 10, on=ICARUS, mutants=ICARUS),
    built(8, 16, 1, 1, 3, 8, 0, 24),
    built(16, 16, 3, 3, 1, 12, 1, 24),
    built(21, 16, 3, 1, 1, 24, 1, 38),
)
REFUSED = {
    "BlockLog2_must_be_at_least_1": "BlockLog2=0",
    "Columns_must_be_a_power_of_two": "Columns=96",
    "two_blocks_a_row_and_one_a_column_are_needed": "Columns=8, Rows=7",
    "SumWidth_must_be_more_than_Width_plus_ColumnLog2": "SumWidth=27",
}
PROOFS = tuple(
    Proof(
        "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width",
        {"Signed": signed, "ColumnLog2": column_log2},
    )
    for signed, column_log2 in ((0, 1), (1, 1), (1, 0))
)


def legal(model: BlockSum, pins: Pins) -> None:
    """Mark the first word of a frame."""
    if pins["in_valid"]:
        pins["in_frame_start"] = model.place == 0


@cocotb.test
async def sums(dut: Any) -> None:
    bits = dict.fromkeys(("in_valid", "in_frame_start", "in_first_frame", "in_last_frame"), 1.0)
    model = BlockSum(**dict(zip(NAMES, parameters(dut, *NAMES), strict=True)))
    await play(dut, model, {**bits, "in_data": WORD, "read_sums": WORD}, legal)
