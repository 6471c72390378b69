# SPDX-License-Identifier: Apache-2.0
"""Monitor of `contact` in every cycle and of the records of contact events; it compares both with their models."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from cocotb.triggers import RisingEdge

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.contact_events import ContactEvents, Settings, record
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.contact.threshold_comparator import ThresholdComparator
from tactile_depth.chip.latency import last_pixel_to_first_depth
from tactile_depth.chip.registers.register_map import MAP, REGISTERS
from tb.pins import unsigned
from tb.register_mirror import RegisterMirror

CONTROL = REGISTERS["CONTROL"]
SETTINGS = ("THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE")
RECORD = [register.name for register in MAP if register.name.startswith("RECORD_")]


class ContactWatch:
    """Models of the contact unit beside the device.

    Attributes
    ----------
    raised : list of int
        Clocks in which `contact` rose.
    packets : list of list of int
        Records that left, in words.
    takes : iterator of bool
        Profile of the sink of records.
    """

    def __init__(self, dut: Any, config: Configuration, takes: Iterator[bool]) -> None:
        self.dut, self.config, self.takes = dut, config, takes
        self.pixels = config.rows * config.columns
        self.comparator = ThresholdComparator()
        self.events = ContactEvents(config.rows, config.columns, config.data_width, config.solver == "tridiagonal")
        self.registers = RegisterMirror(dut, *SETTINGS, "CONTROL")
        self.late = dict(self.registers.words)  # of the cycle before
        self.raised: list[int] = []
        self.packets: list[list[int]] = []
        self.settings: list[Settings] = []  # cycle in which the first depth of each frame left
        self.drops: list[tuple[int, bool, int, bool]] = []  # cycle, contact, threshold, hold, while drop_frames is set

    def forget(self) -> None:
        """Clear the records of what left."""
        self.raised.clear()
        self.packets.clear()
        self.settings.clear()

    def setting(self, register: str) -> int:
        """Return the value of a register that the cores use in this cycle; a threshold counts a cycle later."""
        if "THRESHOLD" in register:
            return (self.late[register] ^ 1 << 31) - (1 << 31)
        return self.registers.words[register]

    @property
    def depth_bits(self) -> int:
        """Return the width of a depth on m_axis."""
        return 8 * ((self.config.data_width + 7) // 8)

    def signed(self, data: Any) -> int:
        """Return the depth code of a depth on m_axis."""
        return (int(data) ^ 1 << self.depth_bits - 1) - (1 << self.depth_bits - 1)

    def depths(self, data: Any) -> list[int]:
        """Return the depth codes of a beat on m_axis."""
        beat, mask = int(data), (1 << self.depth_bits) - 1
        return [self.signed(beat >> lane * self.depth_bits & mask) for lane in range(self.config.lanes)]

    def watch_contact(self) -> Iterator[None]:
        """Compare `contact` with the model, which takes the beats and the registers of the previous cycle."""
        dut, model = self.dut, self.comparator
        contact_pin, rst, valid, ready = map(unsigned, (dut.contact, dut.rst, dut.m_axis_tvalid, dut.m_axis_tready))
        words, hold, threshold, drops = dict(self.late), False, 0, False  # registers, and what they say
        yield
        clock, was = 1, False
        while True:
            yield
            clock += 1
            contact = bool(contact_pin())
            if rst():
                model.reset()
                self.registers.reset()
                was = False
                continue
            if self.late is not words:
                self.late = words
                threshold = self.setting("THRESHOLD")
            self.registers.clock()
            if words != self.registers.words:
                words = dict(self.registers.words)
                control = CONTROL.unpack(words["CONTROL"])
                hold, drops = bool(control["hold_contact"]), bool(control["drop_frames"])
            if drops:  # depth that is dropped counts too: see `check_with_drops`
                self.drops.append((clock, contact, threshold, hold))
                continue
            assert contact == model.contact, f"contact is {contact} in clock {clock}"
            if contact and not was:
                self.raised.append(clock)
            was = contact
            if not (valid() and ready()):
                model.idle(hold)
                continue
            user = dut.m_axis_tuser.value
            if user:
                self.settings.append(Settings(*map(self.setting, SETTINGS)))
            for lane, depth in enumerate(self.depths(dut.m_axis_tdata.value)):
                model.beat(depth, bool(user) and not lane, threshold, hold)

    def check_with_drops(self, codes: np.ndarray, last_taken: Sequence[int]) -> None:
        """Compare `contact` where frames were dropped: depth counts in the cycle in which it would leave without a
        stall.

        Parameters
        ----------
        codes : int64 array (frames, rows, columns)
            Depth of the frames sent while CONTROL.drop_frames was set, all of them well-formed.
        last_taken : sequence of int
            Clock of the last pixel of each.
        """
        first = [end + last_pixel_to_first_depth(self.config) for end in last_taken]
        beats = defaultdict(list)
        for begin, frame in zip(first, codes, strict=True):
            for place, code in enumerate(frame.flat):
                beats[begin + place // self.config.lanes].append((int(code), place == 0))
        for clock, contact, threshold, hold in self.drops:
            assert contact == self.comparator.contact, f"contact is {contact} in clock {clock}"
            for depth in beats.get(clock, ()):
                self.comparator.beat(*depth, threshold, hold)
            if clock not in beats:
                self.comparator.idle(hold)

    async def watch_events(self) -> None:
        """Collect packets. Each word stays the same until it is taken, and only a reset ends a packet early."""
        dut, edge = self.dut, RisingEdge(self.dut.clk)
        while True:
            await RisingEdge(dut.m_event_tvalid)
            words, held = [], None
            await edge
            while dut.m_event_tvalid.value and not dut.rst.value:
                word = int(dut.m_event_tdata.value), bool(dut.m_event_tlast.value)
                assert held in (None, word), "a word of a record changed before it was taken"
                held = word
                if dut.m_event_tready.value:
                    held = None
                    words.append(word[0])
                    if word[1]:
                        self.packets.append(words)
                        words = []
                dut.m_event_tready.value = int(next(self.takes))
                await edge
            assert dut.rst.value or (held is None and not words), "a record ended early"

    def check_events(
        self, depth: np.ndarray, taken: Sequence[int], flags: Sequence[FrameFlags], beside: Sequence[bool]
    ) -> None:
        """Compare the record of each frame with the model's.

        Parameters
        ----------
        depth : int64 array (frames, rows, columns)
        taken : sequence of int
            Clock of the first pixel of each frame.
        flags : sequence of FrameFlags
            Those of each frame as if it were alone.
        beside : sequence of bool
            The solver clipped in a frame that was in the pipeline beside this one, so it may have set its flag.
        """
        records = [record(words) for words in self.packets]
        columns, wanted = self.config.columns, []
        for codes, settings, own, may, made in zip(depth, self.settings, flags, beside, records, strict=True):
            expected = own._replace(depth_clipped=own.depth_clipped or (may and made.flags.depth_clipped))
            for place, code in enumerate(codes.flat):
                row_ends, frame_ends = place % columns == columns - 1, place == self.pixels - 1
                event = self.events.beat(int(code), not place, row_ends, frame_ends, settings, 0, expected)
            wanted.append(event)
        assert [made._replace(time=0) for made in records] == wanted, "records of contact events"
        times = [made.time for made in records]
        assert [time - times[0] for time in times] == [clock - taken[0] for clock in taken], "time stamps"
