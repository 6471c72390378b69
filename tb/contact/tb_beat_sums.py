# SPDX-License-Identifier: Apache-2.0
"""beat_sums against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.beat_sums import SumsOfBeats
from tactile_depth.chip.fixed_point import joined
from tb.contact.beats import beats
from tb.contact.tb_beat_peak import STRUCTURES as STRUCTURES
from tb.lockstep import Pins, play
from tb.stream import parameters

PROTOCOL = {"least_offset greatest_offset": "count != '0"}
PROOFS = (Proof("sums are exact at any width"),)


def legal(model: SumsOfBeats, pins: Pins) -> None:
    """Leave weights of some depths alone."""
    some = pins.pop("some")
    pins["weights"] &= joined([-(some >> lane & 1) for lane in range(model.lanes)], model.width)


@cocotb.test()
async def weights(dut: Any) -> None:
    width, lanes = parameters(dut, "Width", "Lanes")
    some = [(1 << lanes) - 1, *range(1 << min(lanes, 12))]
    await play(dut, SumsOfBeats(width, lanes), {"some": some, "weights": beats(width, lanes)}, legal)
