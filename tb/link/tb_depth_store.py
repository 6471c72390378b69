# SPDX-License-Identifier: Apache-2.0
"""depth_store against its model in every clock: a writer and a reader of any speed."""

import random
from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.contact.contact_events import WORDS
from tactile_depth.chip.link.depth_store import DepthStore
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns DataWidth Lanes")
STRUCTURES = (
    built(5, 8, 24, 2, on=VERILATOR),
    built(3, 4, 12, 1, on=ICARUS, mutants=ICARUS),
    built(3, 4, 5, 2, on=ICARUS, mutants=ICARUS),
    built(6, 16, 20, 4),
    built(2, 2, 8, 1),
)
MUTANTS = Mutants(repeats=4, flat=False)
PROOFS = tuple(
    Proof(
        f"values and words are only stored, and an arbitrary one is followed; {WORD_FREE}",
        {"Rows": 2, "Columns": 2 * lanes, "Lanes": lanes},
    )
    for lanes in (1, 2)
)


@cocotb.test
async def frames(dut: Any) -> None:
    chance = random.Random(cocotb.RANDOM_SEED)
    rows, columns, width, lanes = parameters(dut, "Rows", "Columns", "DataWidth", "Lanes")
    pins = dict.fromkeys(("keep", "s_axis_tvalid", "s_event_tvalid", "frame_take", "value_read"), 1.0)
    pins |= {"s_axis_tuser": 0.03, "s_event_tlast": 0.03, "frame_done": 0.1}
    words = dict.fromkeys(("s_axis_tdata", "s_event_tdata", "value_address", "record_word"), WORD)

    def legal(core: DepthStore, pins: Pins) -> None:
        """A record comes whole between the ends of two frames, a reader reads what it has taken."""
        pins["s_axis_tuser"] ^= not core.in_frame or (core.last_beat and chance.random() < 0.1)
        if core.last_beat and not pins["s_axis_tuser"]:
            pins["s_axis_tvalid"] &= not core.awaited and not core.word
            pins["s_event_tvalid"] &= not pins["s_axis_tvalid"]
        pins["s_event_tlast"] = core.word == WORDS - 1 or (pins["s_event_tlast"] and not core.awaited)
        reads = core.banks.read is not None
        pins["frame_done"] &= reads
        pins["frame_take"] &= pins["keep"] and core.banks.ready is not None and (not reads or pins["frame_done"])
        pins["value_read"] &= reads and not pins["frame_done"]
        pins["value_address"] = chance.randrange(rows * columns)
        pins["record_word"] %= WORDS
        for pin in ("s_axis_tdata", "s_event_tdata"):
            pins[pin] ^= chance.getrandbits(len(getattr(dut, pin)))

    await play(dut, DepthStore(rows, columns, width, lanes), pins | words, legal, clocks=max(CLOCKS, 12_000))
