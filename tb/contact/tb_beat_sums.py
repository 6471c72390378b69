# SPDX-License-Identifier: Apache-2.0
"""beat_sums against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.beat_sums import SumsOfBeats
from tactile_depth.chip.fixed_point import joined, split
from tb.contact.beats import beats
from tb.contact.tb_beat_peak import STRUCTURES as STRUCTURES
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters

PROOFS = (Proof("sums are exact at any width"),)


def legal(model: SumsOfBeats, pins: Pins) -> None:
    """Weigh what is above, and nothing else."""
    weights = split(pins["weights"], model.lanes, model.width)
    above = split(pins["above"], model.lanes, 1)
    pins["weights"] = joined([(weight or 1) * bit for weight, bit in zip(weights, above, strict=True)], model.width)


@cocotb.test()
async def weights(dut: Any) -> None:
    width, lanes = parameters(dut, "Width", "Lanes")
    await play(dut, SumsOfBeats(width, lanes), {"above": WORD, "weights": beats(width, lanes)}, legal)
