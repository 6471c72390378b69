# SPDX-License-Identifier: Apache-2.0
"""packet_decode in every clock, against unpack."""

from functools import cache
from itertools import product
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.packets import TO_DEVICE, Kind, Select, unpack
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.structures import BOTH, Structure

STRUCTURES = (Structure(on=BOTH, mutants=BOTH),)
PROOFS = (Proof("the widths in use", steps=3),)


LIMITS = (  # lengths at the limits of the kinds, and near each power of two
    *(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 18, 20, 32, 33, 34, 66, 68, 129, 130, 134),
    *(257, 258, 259, 260, 513, 518, 770, 772, 773, 774, 775, 776, 777, 778, 779, 780),
)
SHORTEST = (1, 3, 4, 8, 12)  # good length of each kind to the device
SENDS = (Kind.READ, Kind.WRITE, Kind.PICTURE)


@cache
def judge(kind: int, length: int) -> str:
    """Return what a packet is by kind and length: unknown, wrong, or good."""
    if kind not in TO_DEVICE:
        return "unknown"
    return "wrong" if unpack(bytes((kind, *bytes(length - 1)))) is None else "good"


class Decode:
    """The packet whose bytes come: how many were taken, its length, and those that were taken of a select."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        self.kind = self.place = self.length = 0
        self.judged = False
        self.fields = b""
        self.pulse = {"bad": 0, "ask": 0, "select": 0}

    def clock(self, *, rst: int, in_valid: int, in_data: int, in_last: int, in_length: int, **ready: int) -> Pins:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        kind = self.kind
        out = self.pulse | {"request_valid": 0, "picture_valid": 0}
        self.pulse = {"bad": 0, "ask": 0, "select": 0}
        if kind in SENDS and in_valid:
            name = "picture" if kind == Kind.PICTURE else "request"
            out |= {f"{name}_valid": 1, f"{name}_data": in_data, f"{name}_last": in_last}
            out |= {"request_write": kind == Kind.WRITE} if name == "request" else {}
            taken = ready[f"{name}_ready"]
        else:
            taken = in_valid and (self.judged or bool(kind))
        self.judged = bool(in_valid and not kind and not self.judged)
        drops = 0
        if taken and not kind:
            verdict = judge(in_data, in_length)
            drops = verdict != "good" or in_data == Kind.ASK
            self.pulse |= {"bad": verdict == "wrong", "ask": bool(verdict == "good" and drops)}
            self.kind, self.length, self.fields = in_data, in_length, b""
        elif taken and kind == Kind.SELECT:
            self.fields += bytes((in_data,))
            if in_last:
                select = unpack(bytes((kind, *self.fields)))
                self.pulse["bad" if select is None else "select"] = 1
                if isinstance(select, Select):
                    self.pulse |= {"select_format": select.depth_format, "select_shift": select.shift}
        if in_valid:
            out["in_ready"] = taken
        if taken:
            out |= {} if rst else {"in_drop": drops}
            self.place += 1
            if drops or in_last:
                self.kind = self.place = 0
        if rst:
            self.reset()
        return out


def legal(model: Decode, pins: Pins) -> None:
    """Offer packets as packet_store does; one begins where no kind waits to be judged."""
    packet: Any = pins.pop("packet")
    if not pins["in_valid"]:
        return
    if model.place:
        pins["in_length"] = model.length
    elif not model.judged:
        pins["in_data"], pins["in_length"] = packet
    pins["in_last"] = model.place == pins["in_length"] - 1
    pins["in_length_mod3"] = pins["in_length"] % 3


@cocotb.test
async def packets(dut: Any) -> None:
    shortest = dict(zip(TO_DEVICE, SHORTEST, strict=True))
    odd = [(kind ^ (1 << bit), length) for kind, length in shortest.items() for bit in range(8)]
    choices = {
        "packet": [(Kind.SELECT, 3), *20 * [*shortest.items()], *3 * [*product(TO_DEVICE, LIMITS)], *3 * odd],
        "in_valid": 1.0,
        "in_data": [1, *4 * [*range(20)], *range(256)],
        "in_length": WORD,
        "in_last": 1.0,
        "in_length_mod3": WORD,
        "request_ready": 1.0,
        "picture_ready": 1.0,
    }
    await play(dut, Decode(), choices, legal, offers=["in"], clocks=4 * CLOCKS)
