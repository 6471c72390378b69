# SPDX-License-Identifier: Apache-2.0
"""The clock, and functions that read a pin as a number, and write it where it changes, for what happens in every clock.

The objects that cocotb makes of a value take several times as long as the read itself. A function raises ValueError if
a bit is unknown.
"""

from collections import deque
from collections.abc import Callable
from functools import cache, partial
from typing import Any

from cocotb.clock import Clock

CLOCK_NS = 6
Read = Callable[[], int]


def start_clock(clock: Any) -> None:
    """Start a clock, low at first, of the period that all testbenches of one clock have."""
    Clock(clock, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)


def unsigned(handle: Any) -> Read:
    """Return the function that reads a pin as an unsigned number."""
    text = handle._handle.get_signal_val_binstr
    return lambda: int(text(), 2)


def signed(handle: Any, lane: int = 0, lanes: int = 1) -> Read:
    """Return the function that reads one of the words in a pin, the first in the lowest bits, as a signed number."""
    text, width = handle._handle.get_signal_val_binstr, len(handle) // lanes
    begin, end, sign = len(handle) - (lane + 1) * width, len(handle) - lane * width, 1 << width - 1

    def read() -> int:
        return (int(text()[begin:end], 2) ^ sign) - sign

    return read


def value(handle: Any) -> Callable[[], Any]:
    """Return the function that reads a pin as cocotb does, bits that are unknown too; equal values are one object."""
    text, make = handle._handle.get_signal_val_binstr, type(handle.value)
    values: dict[str, Any] = {}

    def read() -> Any:
        bits = text()
        if bits not in values:
            values[bits] = make(bits)
        return values[bits]

    return read


def text_by_name(dut: Any) -> Callable[[str], str]:
    """Return the function that reads the bits of a pin of a device by its name; it finds each pin once."""
    text = cache(lambda name: getattr(dut, name)._handle.get_signal_val_binstr)
    return lambda name: text(name)()


def by_name(dut: Any) -> Callable[[str], int]:
    """Return the function that reads a pin of a device by its name, as an unsigned number."""
    text = text_by_name(dut)
    return lambda name: int(text(name), 2)


class Driver:
    """Writer of pins by their names, for those that nobody else writes; a pin is written where its value changes."""

    def __init__(self, dut: Any) -> None:
        self.pin = cache(partial(getattr, dut))
        self.driven: dict[str, int] = {}  # values at the pins

    def __call__(self, **pins: int) -> None:
        for name, value in pins.items():
            if self.driven.get(name) != value:  # a write costs more than a read
                self.pin(name).value = self.driven[name] = int(value)


class Late:
    """Value of a pin some cycles ago, 0 in the first ones; it is read once in each cycle."""

    def __init__(self, handle: Any, cycles: int) -> None:
        self.read, self.cycles = unsigned(handle), cycles
        self.clear()

    def clear(self) -> None:
        self.values = deque([0] * self.cycles)

    def __call__(self) -> int:
        self.values.append(self.read())
        return self.values.popleft()
