# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/event_registers.sv: sticky bits, counters, the last latency, and the interrupt."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from tactile_depth.chip.registers.register_map import REGISTERS, WORD

STATUS, INTERRUPT_STATUS, CONTROL = REGISTERS["STATUS"], REGISTERS["INTERRUPT_STATUS"], REGISTERS["CONTROL"]

# Events have the names of events_t in hdl/td_types_pkg.sv.
FAULTS = ("row_short", "row_long", "start_missing", "start_early", "timed_out")
STICKY_EVENTS = {
    **{fault: fault for fault in FAULTS},
    "timed_out": "timeout",
    "out_of_step": "out_of_step",
    "dark": "dark",
    "depth_dropped": "depth_dropped",
    "flipped": "flipped",
    "residual": "residual",
}
"""Event to its bit of STATUS."""
INTERRUPT_EVENTS = {
    **dict.fromkeys(FAULTS, "frame_dropped"),
    **{"record_valid": "record", "flipped": "flipped", "residual": "residual"},
}
"""Event to its bit of INTERRUPT_STATUS."""
EVENT_COUNTERS = {
    "frame_in": "FRAMES_IN",
    "frame_out": "FRAMES_OUT",
    **dict.fromkeys(FAULTS, "FRAMES_DROPPED"),
    "dark": "DARK_PIXELS",
    "depth_dropped": "DEPTH_DROPPED",
    "record_lost": "RECORDS_LOST",
    "flipped": "FLIPS",
    "residual": "RESIDUALS",
}
"""Event to the register that counts it."""
STICKY_BITS = {event: STATUS.field(bit).mask for event, bit in STICKY_EVENTS.items()}
INTERRUPT_BITS = {event: INTERRUPT_STATUS.field(bit).mask for event, bit in INTERRUPT_EVENTS.items()}
EVENTS = tuple(dict.fromkeys((*STICKY_EVENTS, *INTERRUPT_EVENTS, *EVENT_COUNTERS)))
SATURATIONS, LARGEST = "SATURATIONS", "LARGEST_RESIDUAL"
COUNTERS = (*dict.fromkeys(EVENT_COUNTERS.values()), SATURATIONS)
LARGEST_COUNT = {name: REGISTERS[name].mask() for name in COUNTERS}
LATENCY = "FIRST_DEPTH_LATENCY"
ARRIVED = REGISTERS["ARRIVED"]
SELF_TEST = "SELF_TEST"
LEVELS = ("busy", "contact", "touching", "hunting", "stalled")
"""Bits of STATUS that show an input as it is."""


@dataclass
class EventRegisters:
    """State of the registers.

    Attributes
    ----------
    values : dict
        Name to word, STATUS without `LEVELS`.
    irq : bool
        The output `irq`.
    """

    values: dict[str, int] = field(default_factory=dict)
    irq: bool = False

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Set every register to 0."""
        self.irq, self._interrupts = False, 0
        self._clears = False
        self._late: tuple[bool, int | None] = False, None  # a clearing and a residual of the cycle before
        self.values.update(dict.fromkeys(("STATUS", "INTERRUPT_STATUS", LATENCY, LARGEST, *COUNTERS), 0))

    def write(self, name: str, ones: int) -> None:
        """Clear what a write of `ones` clears."""
        if name in ("STATUS", "INTERRUPT_STATUS"):
            self.values[name] &= ~ones
        elif name == "CONTROL" and ones & CONTROL.field("clear_counters").mask:
            self.values.update(dict.fromkeys(COUNTERS, 0))
            self._clears = True

    def clock(
        self,
        events: Collection[str],
        saturations: int,
        residual: int,
        first_depth_latency: int | None,
        interrupt_mask: int,
    ) -> None:
        """Take the events of one cycle, after the write of that cycle.

        Parameters
        ----------
        events : collection of str, of `EVENTS`
        saturations : int
            Number of values clipped.
        residual : int
            Of the frame of a record; it counts with the event `record_valid`.
        first_depth_latency : int or None
            None if no frame's first depth leaves.
        interrupt_mask : int
            Word of INTERRUPT_MASK before the write of this cycle.
        """
        values = self.values
        self.irq = bool(self._interrupts & interrupt_mask)
        for event in events:
            values["STATUS"] |= STICKY_BITS.get(event, 0)
            values["INTERRUPT_STATUS"] |= INTERRUPT_BITS.get(event, 0)
        if saturations:
            values["STATUS"] |= STATUS.field("saturation").mask
        for name in {EVENT_COUNTERS[event] for event in events if event in EVENT_COUNTERS}:
            values[name] = min(values[name] + 1, LARGEST_COUNT[name])
        values[SATURATIONS] = min(values[SATURATIONS] + saturations, WORD)
        clears, late = self._late
        left = 0 if clears else values[LARGEST]
        values[LARGEST] = left if late is None else max(left, late)
        self._late, self._clears = (self._clears, residual if "record_valid" in events else None), False
        if first_depth_latency is not None:
            values[LATENCY] = first_depth_latency
        self._interrupts = values["INTERRUPT_STATUS"]
