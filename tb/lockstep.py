# SPDX-License-Identifier: Apache-2.0
"""One bench for every core whose model advances by a clock: any pins it may get, and every output in every clock."""

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tb import pins
from tb.settings import RUN

Pins = dict[str, int]

WORD: Sequence[int] = ()  # a choice: any word of the width of the pin
CLOCKS = 50_000 if RUN.full else 6_000
RESET = 8  # clocks of the first one, in which all other inputs are low
RATES: Sequence[float] = (0, 0, 0.03, 0.3, 0.7, 0.97, 1, 1)


class Episodes:
    """Pins that are high or change often, seldom or never for a while: runs, bursts and rare events all occur."""

    def __init__(self, choices: Mapping[str, Any], widths: Pins) -> None:
        self.chance, self.choices, self.widths = random.Random(cocotb.RANDOM_SEED), choices, widths
        self.now, self.rates, self.left = dict.fromkeys(choices, 0), dict.fromkeys(choices, 0.0), 0
        self.words = [pin for pin in choices if choices[pin] is WORD]

    def draw(self) -> Pins:
        """Return the pins of the next clock."""
        chance = self.chance
        if not self.left:
            calm = chance.random() < 0.4  # words stay, what is rare hardly occurs, the rest nearly always
            self.left = chance.choice((150, 600, 1500) if calm else (10, 40, 150, 600))
            for pin, choice in self.choices.items():
                word, rates = not isinstance(choice, float), RATES
                if word:
                    self.now[pin] = self.word(pin)
                if calm:
                    rates = RATES[:1] if word else RATES[-3:] if choice > 0.5 else RATES[:3]
                self.rates[pin] = chance.choice(rates)
        self.left -= 1
        for pin, choice in self.choices.items():
            if isinstance(choice, float):
                self.now[pin] = int(chance.random() < self.rates[pin] * choice)
            elif chance.random() < self.rates[pin]:
                self.now[pin] = self.word(pin)
        return {**self.now}

    def word(self, pin: str) -> int:
        """Return a value of a pin, often the first; any word is often at a limit, or one away from another pin's."""
        chance, values = self.chance, self.choices[pin]
        if values is not WORD:
            return chance.choice((values[0], chance.choice(values)))
        width = self.widths[pin]
        other = self.now[chance.choice(self.words)]
        near = chance.choice((0, -1, 1 << chance.randrange(width), chance.getrandbits(width), other))
        return (near + chance.choice((-1, 0, 0, 1))) % (1 << width)


async def play(
    dut: Any,
    model: Any,
    choices: Mapping[str, Any],
    legal: Callable[[Any, Pins], None] = lambda model, pins: None,
    offers: Sequence[str] = (),
    clocks: int = CLOCKS,
) -> None:
    """Compare every output with the model in every clock.

    Parameters
    ----------
    model : object
        Its `clock`, which gets the pins by their names, `rst` too, returns the outputs of this clock by their names,
        None where one does not count, a text of its first bits where the others do not, and advances by the clock edge
        behind it.
    choices : mapping
        What each input may be: a float is the highest probability of a bit, a sequence the values, the usual one
        first, WORD any word.
    legal : callable
        Changes pins into those that the state of the model allows, and takes out the choices that are no pins.
    offers : sequence of str
        Streams in that keep what they offer: all pins stay until a clock with valid and ready, or rst. Their names
        stand before `_valid`, or before `valid`.
    """
    choices = {"rst": 0.01, **choices} if hasattr(dut, "rst") else choices
    driven = [pin for pin in choices if hasattr(dut, pin)]
    episodes = Episodes(choices, {pin: len(getattr(dut, pin)) for pin in driven})
    edge, write, read = RisingEdge(dut.clk), pins.Driver(dut), pins.text_by_name(dut)
    pins.start_clock(dut.clk)
    write(**{pin: int(pin == "rst") for pin in driven})
    for _ in range(RESET):
        await edge
    kept: Pins = {}
    streams = [f"{name}_" if f"{name}_valid" in choices else name for name in offers]
    for clock in range(clocks):
        now = episodes.draw() | kept
        legal(model, now)
        write(**now)
        expected = model.clock(**now)
        await edge
        for pin, value in expected.items():
            if value is not None:
                got = read(pin)
                wanted = value if isinstance(value, str) else f"{value % (1 << len(got)):0{len(got)}b}"
                assert got.startswith(wanted), f"{pin} in clock {clock}: {got}, not {wanted}, with {now}"
        waits = [name for name in streams if now[f"{name}valid"] and not (now["rst"] or expected[f"{name}ready"])]
        kept = {pin: now[pin] for pin in now for name in waits if pin.startswith(name)}
