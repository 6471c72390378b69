# SPDX-License-Identifier: Apache-2.0
"""status_packet against packets.Status: each request makes a packet of the fields of the clock in which it begins."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.link.depth_formats import DepthFormat
from tactile_depth.chip.link.packets import Status
from tb.axis import PROFILES, profile
from tb.stream import parametrize, start_clock
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live & ~reset", "status_data status_last": "counts & status_valid"}
PROOFS = (
    Proof(
        "fields leave alike; three bytes of them",
    ),
)


PROFILES["rarely"] = lambda rng: (rng.random() < 0.2 for _ in iter(int, 1))
CLOCKS = 3000


def random_body(chance: random.Random) -> bytes:
    """Return a packet of random fields: those of a status, or any bits."""
    grid = chance.randint(1, 4096), chance.randint(1, 4096)
    shape = chance.getrandbits(16), *grid, chance.randint(1, 32), chance.random() < 0.5, chance.random() < 0.5
    counts = (chance.getrandbits(32) for _ in range(3))
    body = Status(*shape, DepthFormat(chance.randrange(4)), chance.randint(0, 16), *counts).pack()
    return body if chance.random() < 0.5 else body[:2] + chance.randbytes(len(body) - 2)


async def play(dut: Any, requests: float, resets: float, accepts: str) -> int:
    """Compare every output in every clock with what the packets so far ask for; return how many packets were sent."""
    chance, ready, edge = random.Random(cocotb.RANDOM_SEED), profile(accepts), RisingEdge(dut.clk)
    dut.rst.value, dut.request.value, dut.status_ready.value, dut.fields.value = 1, 0, 0, 0
    start_clock(dut.clk)
    for _ in range(2):
        await edge
    due, left, sent, was_reset, body = False, b"", 0, True, b""
    for clock in range(CLOCKS):
        body_now, reset = random_body(chance), chance.random() < resets
        pins = chance.random() < requests, next(ready)
        dut.rst.value, dut.request.value, dut.status_ready.value = reset, *pins
        dut.fields.value = int.from_bytes(body_now[2:], "little")
        await edge
        body = left or (body_now if due else b"")
        assert bool(dut.status_valid.value) == bool(body), f"status_valid in clock {clock}"
        if body:
            assert int(dut.status_data.value) == body[0], f"status_data in clock {clock}"
            assert bool(dut.status_last.value) == (len(body) == 1), f"status_last in clock {clock}"
        request, begins = pins[0], bool(body) and not left and pins[1]
        if body and pins[1]:
            left = body[1:]
            sent += not left
        due = request or was_reset or (due and not begins)
        if reset:
            due, left = False, b""
        was_reset = reset
    return sent


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(accepts=["none", "random", "rarely", "long"], requests=[0.005, 0.05, 0.5])
async def packets(dut: Any, accepts: str, requests: float) -> None:
    """Send packets one after another and far apart."""
    assert await play(dut, requests, 0.0, accepts) > 5, "the test is void"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(accepts=["none", "random"])
async def resets(dut: Any, accepts: str) -> None:
    """Send a packet after each reset, whatever was on its way."""
    assert await play(dut, 0.01, 0.02, accepts) > 5, "the test is void"
