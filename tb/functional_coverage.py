# SPDX-License-Identifier: Apache-2.0
"""Bins of the fault list, and the monitor that counts them in a run of tactile_depth.

A bin is "cover point: value, value, ..". The monitor drives and compares nothing. It reads signals inside the device
only where pins do not show a state (position of the guard, filler, frames in flight). With HDL_COVERAGE=1 it writes its
counts to the run folder; commands/verify/coverage.py adds the counts of all runs.
"""

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import frame_latency
from tactile_depth.chip.limits import COLUMNS, ROWS
from tactile_depth.chip.registers.register_map import MAP
from tactile_depth.chip.video.frame_guard import FAULTS
from tb import structs
from tb.axis import PROFILES
from tb.settings import RUN

FILE = "functional_coverage.json"

SOLVERS = tuple(COLUMNS)
PLACES = ("first pixel", "first row", "middle", "last row", "end of a row", "last pixel")
PHASES = ("idle", "taking", "filling", "waiting", "putting out", "stalled")
INPUTS, OUTPUTS = ("idle", "accept", "stalled"), ("idle", "taken", "held")
RESETS = (1, 2, 16)  # clocks
PAUSES = ("0", "1", "many")  # idle clocks between frames
SILENCES = ("off", "waited for", "given up")
WRITTEN = {register.offset: register.name for register in MAP if register.writable}
# Frames between their last pixel and their first depth, at the smallest grid.
SMALLEST = [
    Configuration(columns=least, rows=0 if name == "spectral" else ROWS[0], solver=name)
    for name, (least, _) in COLUMNS.items()
]
MOST_WAIT = {config.solver: -(-frame_latency(config) // (config.rows * config.columns)) for config in SMALLEST}
POINTS = {
    "fault, place": (FAULTS, PLACES),
    "fault, frame before, frame after": (FAULTS, ("good", "bad"), ("good", "bad")),
    "pause between frames": (PAUSES,),
    "gaps, stalls": (tuple(PROFILES), tuple(PROFILES)),
    "input, output": (INPUTS, OUTPUTS),
    "reset clocks, phase": (RESETS, PHASES),
    "register written, phase": (tuple(WRITTEN.values()), PHASES),
    "silence inside a frame": (SILENCES,),
    "clipped": (("no", "yes"),),
    "contact": (("rises", "is held", "is cleared"),),
    "start in a stall": (("between frames", "inside a frame"),),
    "depth dropped, word that waits": (("a frame", "the rest of a frame"), ("first of a frame", "another")),
    "frames that wait": (tuple(range(1, max(MOST_WAIT.values()) + 1)),),
}


def label(point: str, *values: object) -> str:
    return f"{point}: {', '.join(map(str, values))}"


def impossible(point: str, solver: str, values: Sequence[Any]) -> str | None:
    """Return the reason why a bin cannot be hit, or None."""
    if point == "fault, place":
        fault, place = values
        ends = place in ("end of a row", "last pixel")
        if fault == "row_short" and ends:
            return "a row that ends in its last column is not short"
        if fault == "row_long" and not ends:
            return "a row is long once its last column has no tlast"
        if fault == "start_missing" and place != "first pixel":
            return "a start is missing where a frame begins"
        if fault in ("start_early", "timed_out") and place == "first pixel":
            return "no frame has begun"
    if point == "fault, frame before, frame after":
        fault, before, _ = values
        if fault == "start_missing" and before == "bad":
            return "what follows a broken frame without a start is its rest"
    if point == "frames that wait" and values[0] > MOST_WAIT[solver]:
        return "the first depth is due earlier, on every grid"
    return None


def bins() -> dict[str, str | None]:
    """Return every bin with the reason why it is impossible, or None."""
    return {
        label(point, solver, *values): impossible(point, str(solver), values)
        for point, axes in POINTS.items()
        for solver, *values in product(SOLVERS, *axes)
    }


def place_of(row: int, column: int, rows: int, columns: int) -> str:
    if row == column == 0:
        return "first pixel"
    if column == columns - 1:
        return "last pixel" if row == rows - 1 else "end of a row"
    return {0: "first row", rows - 1: "last row"}.get(row, "middle")


class FunctionalCoverage:
    """Counts bins, clock by clock."""

    def __init__(self, dut: Any, config: Configuration, offers: str, accepts: str) -> None:
        self.dut, self.config, self.offers, self.accepts = dut, config, offers, accepts
        self.hits: Counter[str] = Counter()
        self.forget()

    def forget(self) -> None:
        """Forget what came before a reset."""
        self.frames: list[str] = []  # outcomes of the frames: "good", or the fault
        self.since_start = self.pause = self.quiet = 0  # words since a start of frame, clocks without a word
        self.offered = self.clipped = self.contact = self.answered = False  # in the previous cycle
        self.in_phases: list[str] = []

    def hit(self, point: str, *values: object) -> None:
        self.hits[label(point, self.config.solver, *values)] += 1

    def phases(self, held: bool, taken: bool) -> Iterator[str]:
        """Yield the phases of the pipeline, which may take a frame while it puts another one out."""
        filling, inside = self.dut.u_video.u_guard.filling.value, not self.dut.u_video.u_guard.origin.value
        if filling:
            yield "filling"
        elif inside:
            yield "taking"
        if held:
            yield "stalled"
        elif taken:
            yield "putting out"
        elif not filling and not inside:
            yield "waiting" if structs.unpack("levels_t", int(self.dut.u_registers.levels.value))["busy"] else "idle"

    async def watch(self) -> None:
        """Count until the end of the test, then add the counts to those of the file."""
        try:
            await RisingEdge(self.dut.clk)  # before it Icarus has no value of the pins
            while True:
                await self.watch_until_reset()
        finally:
            file = Path(FILE)
            before = Counter(json.loads(file.read_text()) if file.exists() else {})
            file.write_text(json.dumps(before + self.hits, indent=0, sort_keys=True))

    async def watch_until_reset(self) -> None:
        """Count until a reset, and the clocks of the reset."""
        dut, edge = self.dut, RisingEdge(self.dut.clk)
        while dut.rst.value:
            await edge
        self.forget()
        await edge
        while not dut.rst.value:
            out_valid, out_ready = bool(dut.m_axis_tvalid.value), bool(dut.m_axis_tready.value)
            taken, held = out_valid and out_ready, out_valid and not out_ready
            self.in_phases = list(self.phases(held, taken))
            self.count_input(held, ("taken" if out_ready else "held") if out_valid else "idle")
            self.count_frames()
            self.count_output(taken)
            self.count_registers()
            await edge
        clocks = 1
        while dut.rst.value:
            await edge
            clocks += bool(dut.rst.value)
        for phase in self.in_phases if clocks in RESETS else ():
            self.hit("reset clocks, phase", clocks, phase)

    def count_input(self, held: bool, output: str) -> None:
        """Count pauses, silence and starts of frames on s_axis."""
        dut = self.dut
        valid, ready = bool(dut.s_axis_tvalid.value), bool(dut.s_axis_tready.value)
        self.hit("input, output", ("accept" if ready else "stalled") if valid else "idle", output)
        inside = not dut.u_video.u_guard.origin.value
        start = valid and bool(dut.s_axis_tuser.value)
        if start and held and not self.offered:
            self.hit("start in a stall", "inside a frame" if inside else "between frames")
        if valid and ready:
            if start and self.since_start == self.config.rows * self.config.columns:
                self.hit("pause between frames", PAUSES[min(self.pause, 2)])
            self.since_start, self.pause = 1 if start else self.since_start + 1, 0
        elif not valid:
            self.pause += 1
        self.offered = valid and not ready
        if valid:
            if inside and self.quiet > self.config.columns:
                self.hit("silence inside a frame", "waited for" if int(dut.timeout.value) else "off")
            self.quiet = 0
        elif inside:
            self.quiet += 1

    def count_frames(self) -> None:
        """Count faults, by place and between which frames, and frames that wait in the solver."""
        dut, guard = self.dut, self.dut.u_video.u_guard
        fault = next((name for name in FAULTS if getattr(guard, name).value), None)
        if fault:
            row, column = int(guard.row.value), int(guard.column.value)
            self.hit("fault, place", fault, place_of(row, column, self.config.rows, self.config.columns))
            if fault == "timed_out":
                self.hit("silence inside a frame", "given up")
                self.quiet = 0
        # A whole frame is reported one cycle after its last pixel, so it may coincide with a fault of the next frame.
        frame_in = structs.unpack("events_t", int(dut.events.value))["frame_in"]
        ends = ["good"] * frame_in + ([fault] if fault else [])
        for end in ends:
            self.frames.append(end)
            if len(self.frames) > 2 and self.frames[-2] != "good":
                before, broken, after = self.frames[-3:]
                sides = ("good" if name == "good" else "bad" for name in (before, after))
                self.hit("fault, frame before, frame after", broken, *sides)
        if dut.u_depth.tags_held.value:
            self.hit("frames that wait", int(dut.u_depth.u_tags.full.value).bit_count())

    def count_output(self, taken: bool) -> None:
        """Count frames that leave, frames that are dropped, and changes of `contact`."""
        dut, events = self.dut, structs.unpack("events_t", int(self.dut.events.value))
        self.clipped |= events["saturations"] != 0
        if taken and dut.m_axis_tuser.value:
            self.hit("gaps, stalls", self.offers, self.accepts)
            self.hit("clipped", "yes" if self.clipped else "no")
            self.clipped = False
            settings = structs.unpack("contact_settings_t", int(dut.contact_settings.value))
            if self.contact and dut.contact.value and settings["hold_contact"]:
                self.hit("contact", "is held")
        was, self.contact = self.contact, bool(dut.contact.value)
        if self.contact != was:
            self.hit("contact", "rises" if self.contact else "is cleared")
        if events["depth_dropped"]:
            self.hit(
                "depth dropped, word that waits",
                "a frame" if dut.u_contact.depth_starts.value else "the rest of a frame",
                "first of a frame" if dut.m_axis_tuser.value else "another",
            )

    def count_registers(self) -> None:
        """Count writes of registers, by phase."""
        answers = bool(self.dut.s_axil_bvalid.value)
        if answers and not self.answered:
            register = WRITTEN.get(int(self.dut.u_registers.write_offset.value))
            for phase in self.in_phases if register else ():
                self.hit("register written, phase", register, phase)
        self.answered = answers


def start(dut: Any, config: Configuration, offers: str, accepts: str) -> None:
    """Count from now to the end of the test, in a run that counts coverage."""
    if RUN.coverage:
        cocotb.start_soon(FunctionalCoverage(dut, config, offers, accepts).watch())
