# SPDX-License-Identifier: Apache-2.0
"""contact_debounce against its model in every cycle: areas at the minimum, every debounce, resets."""

import random
from collections.abc import Iterable
from typing import Any, NamedTuple

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.contact_debounce import BEGAN, ENDED, TOUCHING, ContactDebounce
from tb.stream import REGRESS, drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("AreaWidth")
STRUCTURES = (
    built(15, on=VERILATOR),
    built(5, on=ICARUS, mutants=True),
    built(21),
)
PROOFS = (
    Proof(
        "touching changes after `debounce` frames in a row that speak against it, and for no other reason",
        "areas are only compared; a count of four frames",
        depth=20,
    ),
)


class Frame(NamedTuple):
    area: int
    minimum_area: int
    debounce: int


async def check(dut: Any, frames: Iterable[Frame | None], gap: float = 0.5) -> list[int]:
    """Send frames, with random pins in the idle cycles between them, and None for a reset; return the status of
    each."""
    (area_width,) = parameters(dut, "AreaWidth")
    chance = random.Random(cocotb.RANDOM_SEED)
    stimuli: list[dict[str, int]] = []

    def noise() -> dict[str, int]:
        pins = {"area": area_width, "minimum_area": chance.choice([1, 32]), "debounce": chance.choice([1, 8])}
        return {pin: chance.getrandbits(bits) for pin, bits in pins.items()}

    for frame in frames:
        while chance.random() < gap:
            stimuli.append({"rst": 0, "area_valid": 0, **noise()})
        if frame is None:
            stimuli.append({"rst": 1, "area_valid": chance.getrandbits(1), **noise()})
        else:
            stimuli.append({"rst": 0, "area_valid": 1, **frame._asdict()})
    stimuli += [{"rst": 0, "area_valid": 0, **noise()} for _ in range(2)]
    outputs = await drive(dut, stimuli, ["touching", "touching_next", "began", "ended"])

    model, status, every = ContactDebounce(), None, []
    for clock, pins in enumerate(stimuli):
        assert bool(outputs["touching"][clock]) == model.touching, f"touching in clock {clock}"
        if status is not None:
            assert bool(outputs["began"][clock]) == bool(status & BEGAN), f"began in clock {clock}"
            assert bool(outputs["ended"][clock]) == bool(status & ENDED), f"ended in clock {clock}"
        if pins["rst"]:
            model.reset()
            status = None
            continue
        if pins["area_valid"]:
            status = model.frame(pins["area"], pins["minimum_area"], pins["debounce"])
            every.append(status)
        assert bool(outputs["touching_next"][clock]) == model.touching, f"touching_next in clock {clock}"
    return every


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def random_frames(dut: Any) -> None:
    """Send areas near the minimum and at the limits, with a debounce that changes from frame to frame."""
    (area_width,) = parameters(dut, "AreaWidth")
    chance, largest = random.Random(cocotb.RANDOM_SEED), (1 << area_width) - 1
    frames: list[Frame | None] = []
    for _ in range(800):
        area = chance.choice([0, 1, largest, chance.getrandbits(area_width)])
        minimum = chance.choice([0, 1, area, area, max(area - 1, 0), area + 1, area + 1, largest + 1, 2**32 - 1])
        frames.append(Frame(area, minimum, chance.choice([0, 1, 2, 3])))
        if chance.random() < 0.01:
            frames.append(None)
    status = await check(dut, frames)
    assert sum(bool(bits & (BEGAN | ENDED)) for bits in status) > len(status) // 20, "the test is void: few changes"


@cocotb.test(timeout_time=10, timeout_unit="ms")
@parametrize(debounce=[0, 1, 2, 5, 255 if REGRESS else 20])
async def debounce(dut: Any, debounce: int) -> None:
    """Begin and end contact with exactly `debounce` frames in a row; one frame less has no effect, and another frame
    restarts the count."""
    pressed, free, needed = Frame(1, 1, debounce), Frame(0, 1, debounce), max(debounce, 1)
    frames: list[Frame | None] = []
    expected: list[int] = []
    for one, other, state in ((pressed, free, 0), (free, pressed, TOUCHING)):
        frames += [one] * (needed - 1) + [other] * (needed > 1) + [one] * needed
        expected += [state] * (2 * needed - 2 + (needed > 1)) + [ENDED if state else TOUCHING | BEGAN]
    assert await check(dut, frames) == expected


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_debounce_that_is_lowered(dut: Any) -> None:
    """Lower the debounce: the count is kept, so the next frame that differs changes the state."""
    assert await check(dut, [Frame(1, 1, frames) for frames in (9, 9, 9, 9, 2)]) == [0, 0, 0, 0, TOUCHING | BEGAN]


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def large_minima(dut: Any) -> None:
    """Set minima beyond any area, in each bit: no frame reaches them. Every frame reaches 0."""
    (area_width,) = parameters(dut, "AreaWidth")
    largest = (1 << area_width) - 1
    frames: list[Frame | None] = [Frame(largest, 1 << bit, 1) for bit in range(area_width, 32)]
    frames += [Frame(largest, largest, 1), Frame(0, 1, 1), Frame(0, 0, 1)]
    assert (await check(dut, frames))[-3:] == [TOUCHING | BEGAN, ENDED, TOUCHING | BEGAN]
