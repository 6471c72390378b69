# SPDX-License-Identifier: Apache-2.0
"""Soft errors: one bit of a register or memory of tactile_depth flips while frames stream through.

Each experiment resets the device, streams FRAMES frames, flips one bit in one cycle and classifies the output. Its
outcome is the first of OUTCOMES of upsets.py that applies. The bits are sampled evenly over modules, so that small
modules count as much as memories. Results go to upsets.json in the run folder.
"""

import json
import random
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cocotb
import numpy as np
from cocotb.handle import ArrayObject, HierarchyArrayObject, HierarchyObject, LogicArrayObject, LogicObject
from cocotb.triggers import FallingEdge, RisingEdge

from commands.common.repository import cores
from tactile_depth.chip.latency import last_pixel_to_first_depth
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.sensor.synthetic import synthetic
from tb.axis import video
from tb.pixels import pack
from tb.settings import RUN
from tb.stream import configuration, start_clock

FRAMES = 6
FLIPPED_IN = 1  # the flip comes as this frame enters, or up to one latency later
OF_DATA = ("saturation", "contact", "touching")  # bits of STATUS that depend on the content of a frame
# Values that hold until software writes them again; an upset there persists over frames.
SETTINGS = {
    "setting_registers": ("settings",),
    "table_access": ("index", "high"),
    "table_banks": ("bank", "requested"),
    "gradient_lookup": ("words",),
}


@dataclass(frozen=True)
class Place:
    """A register, or a word of a memory, and the module it belongs to."""

    module: str
    path: str
    handle: LogicArrayObject | LogicObject
    memory: bool


def registers_of(module: str) -> set[str]:
    """Return the names that the source of a module assigns with <= in a clocked block."""
    text = re.sub(r"//.*", "", cores()[module].hdl.read_text())
    clocked = text[text.find("always_ff") :]
    names = set(re.findall(r"(?:^|[;)]|begin|else)\s*\{?\s*(\w+)(?:\[[^\]]*\])?\s*<=", clocked, re.M))
    joined = re.findall(r"\{([\w, ]+)\}\s*<=", clocked)
    return names | {name.strip() for group in joined for name in group.split(",")}


def places(dut: Any) -> list[Place]:
    """Return every register and every word of memory, without ROMs and objects that exist in simulation only."""
    places_of_module: list[Place] = []

    def visit(scope: Any, module: str, owner: str) -> None:
        registers = registers_of(module)
        for child in scope:
            name = child._name
            if isinstance(child, HierarchyArrayObject):
                for element in child:
                    visit(element, module, owner)
            elif isinstance(child, HierarchyObject):
                inner = child._def_name
                if inner in cores():
                    if inner != "td_rom":
                        # A memory counts for the core that contains it, and so does a counter or a delay line.
                        shared = inner in (
                            "td_ram",
                            "td_delay_line",
                            "td_burst_counter",
                            "td_round_saturate",
                            "td_dot_product",
                        )
                        visit(child, inner, owner if shared else inner)
                else:
                    visit(child, module, owner)
            elif name in registers or name == "words":
                memory = isinstance(child, ArrayObject)
                for element in child if memory else [child]:
                    places_of_module.append(Place(owner, child._path, element, memory))

    visit(dut, "tactile_depth", "tactile_depth")
    return places_of_module


def lanes_of(bits: str, lanes: int) -> list[int | None]:
    """Return the codes of a beat, the first from the lowest bits; None: it depends on a place never written."""
    width = len(bits) // lanes
    words = [bits[len(bits) - width * (lane + 1) : len(bits) - width * lane] for lane in range(lanes)]
    return [int(word, 2) - (word[0] == "1") * (1 << width) if {*word} <= {*"01"} else None for word in words]


class Device:
    """Driver of the pins, one cycle at a time."""

    def __init__(self, dut: Any, rng: Any) -> None:
        self.dut, self.random = dut, rng
        self.config = configuration()
        rgb = np.random.default_rng(1).integers(0, 256, (FRAMES, self.config.rows, self.config.columns, 3), np.uint8)
        self.codes = (
            tactile_depth(rgb, synthetic(self.config.bits_per_channel), self.config).reshape(FRAMES, -1).tolist()
        )
        self.words = [word for frame in pack(rgb) for word in video(frame.ravel(), self.config.columns)]
        self.pixels = self.config.rows * self.config.columns
        self.latency = last_pixel_to_first_depth(self.config)

    async def reset(self) -> None:
        dut = self.dut
        for pin in ("s_axis_tvalid", "s_axil_awvalid", "s_axil_wvalid", "s_axil_arvalid", "s_axil_bready"):
            getattr(dut, pin).value = 0
        dut.s_axil_rready.value, dut.m_axis_tready.value, dut.m_event_tready.value, dut.rst.value = 1, 1, 1, 1
        dut.cold_rst.value = 0
        for _ in range(2):
            await RisingEdge(dut.clk)
        dut.rst.value = 0
        await RisingEdge(dut.clk)

    async def status(self) -> int | None:
        """Read STATUS; None: the registers do not answer."""
        dut = self.dut
        dut.s_axil_araddr.value, dut.s_axil_arvalid.value = REGISTERS["STATUS"].offset, 1
        for _ in range(10):
            await RisingEdge(dut.clk)
            if dut.s_axil_arready.value:
                dut.s_axil_arvalid.value = 0
            if dut.s_axil_rvalid.value:
                word = list(str(dut.s_axil_rdata.value))
                for name in OF_DATA:  # unknown if it depends on a place that was never written
                    word[-1 - REGISTERS["STATUS"].field(name).low] = "0"
                return int("".join(word), 2)
        return None

    async def experiment(self, place: Place, bit: int, at: int, stall: float) -> str | None:
        """Stream the frames and flip one bit after cycle `at`; return the outcome, None if the place was never written
        before."""
        dut, edge = self.dut, RisingEdge(self.dut.clk)
        await self.reset()
        sent, clock, quiet = 0, 0, 0
        sent_at_flip = 0
        beats: list[tuple[int | None, int]] = []
        valid, ready, m_valid, m_ready = dut.s_axis_tvalid, dut.s_axis_tready, dut.m_axis_tvalid, dut.m_axis_tready
        data, last, user = dut.s_axis_tdata, dut.s_axis_tlast, dut.s_axis_tuser
        while quiet < 2 * self.latency:
            valid.value = int(sent < len(self.words))
            if sent < len(self.words):
                data.value, last.value, user.value = self.words[sent]
            m_ready.value = int(self.random.random() >= stall)
            if clock == at:
                await FallingEdge(dut.clk)
                if not place.handle.value.is_resolvable:
                    return None
                self.flip(place, bit)
                sent_at_flip = sent
            await edge
            clock += 1
            quiet = 0 if sent < len(self.words) and clock < 20 * len(self.words) else quiet + 1
            if sent < len(self.words) and ready.value:
                sent += 1
            if m_valid.value and m_ready.value:
                codes = lanes_of(str(dut.m_axis_tdata.value), self.config.lanes)
                starts = [int(dut.m_axis_tuser.value), *[0] * (self.config.lanes - 1)]
                beats += zip(codes, starts, strict=True)
                quiet = 0
        valid.value = 0
        status = await self.status()
        if place.memory and place.module in SETTINGS:
            self.flip(place, bit)
        return self.outcome(beats, status, sent_at_flip)

    def flip(self, place: Place, bit: int) -> None:
        place.handle.value = int(place.handle.value) ^ 1 << bit

    def outcome(self, beats: list[tuple[int | None, int]], status: int | None, sent_at_flip: int) -> str:
        frames: list[list[int | None]] = []
        for code, user in beats:
            if user or not frames:
                frames.append([])
            frames[-1].append(code)
        later = FRAMES - -(-sent_at_flip // self.pixels)  # frames that began after the flip
        if status is None or len(frames) < later or len(beats) < later * self.pixels:
            return "hang"
        if frames[len(frames) - later :] != self.codes[FRAMES - later :]:
            return "stays wrong"
        fields = REGISTERS["STATUS"].unpack(status)
        flagged = any(value for name, value in fields.items() if name not in ("busy", *OF_DATA))
        if frames == self.codes:
            return "false alarm" if flagged else "masked"
        return "flagged" if flagged else "not flagged"


@cocotb.test()
async def upsets(dut: Any) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    start_clock(dut.clk)
    device = Device(dut, rng)
    await device.reset()
    by_module: dict[str, list[Place]] = {}
    for place in places(dut):
        by_module.setdefault(place.module + " memory" * place.memory, []).append(place)
    dut._log.info("%s", {module: len(places_of_module) for module, places_of_module in by_module.items()})
    assert len(by_module) > 20, "the registers were not found"
    results: list[Any] = []
    first = FLIPPED_IN * device.pixels
    for name, places_of_module in sorted(by_module.items()):
        wanted = len(results) + RUN.device["upsets"]
        while len(results) < wanted:
            place = rng.choice(places_of_module)
            bit = rng.randrange(len(place.handle))
            at = first + rng.randrange(device.pixels + device.latency)
            stall = rng.choice((0.0, 0.25))
            outcome = await device.experiment(place, bit, at, stall)
            if outcome is None:
                continue
            setting = place.path.rpartition(".")[2] in SETTINGS.get(place.module, ())
            results.append(
                {"group": name, "path": place.path, "bit": bit, "clock": at, "outcome": outcome, "setting": setting}
            )
            if outcome in ("hang", "stays wrong"):
                dut._log.info("%s: %s bit %d at clock %d", outcome, place.path, bit, at)
    Path("upsets.json").write_text(json.dumps(results))
