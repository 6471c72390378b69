# SPDX-License-Identifier: Apache-2.0
"""camera_registers against its model, every output in every cycle."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.camera_registers import (
    CONTROL,
    COUNTERS,
    STATUS,
    CameraRegisters,
    Setup,
    camera_registers_parameters,
)
from tactile_depth.chip.camera.camera_window import FAULTS
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_MAP, CAMERA_REGISTERS, WORD
from tb import structs
from tb.cases import on_bench
from tb.registers.register_bench import WHOLE, RegisterBench
from tb.stream import parameters, parametrize
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

VGA: dict[str, Any] = {"picture": (480, 640), "grid": (128, 128), "pixel_format": "raw10", "phase": "grbg"}
OTHER: dict[str, Any] = {
    "picture": (240, 320),
    "grid": (96, 128),
    "pixel_format": "yuyv_bytes",
    "window": (7, 5, 256, 192),
    "black_level": 341,
    "gains": (1.5, 0.25, 15.75),
}


def built(choices: dict[str, Any], **runs: Any) -> Structure:
    return Structure(camera_registers_parameters(CameraConfiguration(**choices)), **runs)


STRUCTURES = (
    built(VGA, on=VERILATOR),
    built(OTHER, on=ICARUS, mutants=ICARUS),
)
PROTOCOL = {"counts": "live"}
MUTANTS = Mutants(
    outside=(
        "dropped",
        "lost",
    ),
    flat=False,
)
PROOFS = (
    Proof(
        FULL_WIDTH,
    ),
)


PARAMETERS = (
    *("PictureColumns", "PictureRows", "WindowX", "WindowY", "BlackLevel", "RedGain", "GreenGain", "BlueGain"),
    *("WindowColumns", "WindowRows", "Format", "Phase"),
)
SETUP = ("setup_done", "setup_failed", "setup_entry", "setup_found")
EVERY = tuple(CAMERA_REGISTERS)


class Bench(RegisterBench):
    """Bench of camera_registers."""

    idle = MappingProxyType(dict.fromkeys(("faults", "frames_lost", *SETUP), 0))
    registers = CAMERA_MAP

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        self.model = CameraRegisters(dict(zip(PARAMETERS, parameters(dut, *PARAMETERS), strict=True)))

    def word(self, name: str) -> int:
        done, failed, entry, found = (self.inputs[pin] for pin in SETUP)
        return self.model.read(name, Setup(bool(done), bool(failed), entry, found)) if name else 0

    def outputs(self) -> dict[str, int]:
        restart = self.allowed is not None and self.write_name == CONTROL.name
        return {
            "settings": structs.pack("camera_settings_t", self.model.settings),
            "writable": bool(self.write_name and CAMERA_REGISTERS[self.write_name].writable),
            "readable": bool(self.read_name),
            "setup_restart": restart and CONTROL.unpack(self.ones)["restart_setup"],
        }

    def step(self, write: tuple[str, int, int] | None) -> None:
        if write and write[0]:
            self.model.write(*write)
        faults = structs.unpack("camera_faults_t", self.inputs["faults"])
        self.model.clock([name for name in FAULTS if faults[name]], self.inputs["frames_lost"])

    def reset(self) -> None:
        self.model.reset()

    async def preset(self, value: int) -> None:
        """Set the counters in the RTL and in the model."""
        self.dut.dropped.value = self.dut.lost.value = value
        await self.clock()
        self.model.values.update(dict.fromkeys(COUNTERS, value))

    def random_inputs(self) -> dict[str, Any]:
        rng = self.random
        return {
            "faults": rng.choice((0, 0, fault(rng.choice(FAULTS)))),
            "frames_lost": rng.choice((0, 0, 1, rng.randrange(256))),
            "setup_done": rng.getrandbits(1),
            "setup_failed": rng.getrandbits(1),
            "setup_entry": rng.getrandbits(8),
            "setup_found": rng.getrandbits(8),
        }


def fault(name: str) -> int:
    return structs.pack("camera_faults_t", {name: 1})


@on_bench(Bench)
async def reset_values(bench: Bench) -> None:
    """Settings have the values of the build; every other field has that of the map."""
    for register in CAMERA_MAP:
        values = register.unpack(await bench.clock(read_at=register.name))
        for field in register.fields:
            assert field.reset is None or values[field.name] == field.reset, field.name


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(name=list(CAMERA_REGISTERS))
async def access(dut: Any, name: str) -> None:
    """Each field has the access of the map, byte by byte."""
    register = CAMERA_REGISTERS[name]
    bench = Bench(dut)
    await bench.start()
    for strobe in range(16):
        for word in (WORD, 0, 0x5AA5_C33C):
            before = await bench.clock(read_at=name)
            await bench.clock((name, word, strobe))
            mask = sum(0xFF << 8 * byte for byte in range(4) if strobe >> byte & 1) & register.mask("rw")
            assert await bench.clock(read_at=name) == word & mask | before & ~mask


@on_bench(Bench)
async def other_offsets(bench: Bench) -> None:
    """Access offsets that differ in one bit from that of a register: they are not taken for it."""
    await bench.other_offsets(EVERY)


@on_bench(Bench)
async def events(bench: Bench) -> None:
    """Each fault has its bit and counts once; lost frames count as many as there are; a 1 clears its bit alone."""
    for number, name in enumerate(FAULTS, 1):
        await bench.clock(faults=fault(name))
        await bench.clock()
        assert await bench.clock(read_at="CAMERA_DROPPED") == number
    assert await bench.clock(read_at="CAMERA_STATUS") == STATUS.pack(**dict.fromkeys(FAULTS, 1))
    await bench.clock(frames_lost=255)
    await bench.clock(frames_lost=2)
    await bench.clock()
    assert await bench.clock(read_at="CAMERA_LOST") == 257
    for field in (*FAULTS, "lost"):
        before = await bench.clock(read_at="CAMERA_STATUS")
        await bench.clock(("CAMERA_STATUS", STATUS.field(field).mask, WHOLE))
        assert await bench.clock(read_at="CAMERA_STATUS") == before & ~STATUS.field(field).mask
    assert await bench.clock(read_at="CAMERA_STATUS") == 0


@on_bench(Bench)
async def counters_have_32_bits(bench: Bench) -> None:
    """They count on from any value, and stay at the largest."""
    values = [(1 << bit) - 1 for bit in range(1, 33)] + [WORD - 1, WORD - 200]
    for value in (*values, *(bench.random.getrandbits(32) for _ in range(2))):
        await bench.preset(value)
        await bench.clock(faults=fault("row_long"), frames_lost=200)
        await bench.clock()
        assert await bench.clock(read_at="CAMERA_DROPPED") == min(value + 1, WORD)
        assert await bench.clock(read_at="CAMERA_LOST") == min(value + 200, WORD)


@on_bench(Bench)
async def an_event_in_the_clock_of_a_clearing_write_is_kept(bench: Bench) -> None:
    await bench.preset(WORD)
    await bench.clock(faults=fault("row_short"), frames_lost=3)  # reaches the counters in the next cycle
    await bench.clock(("CAMERA_CONTROL", CONTROL.field("clear_counters").mask, WHOLE))
    assert await bench.clock(read_at="CAMERA_DROPPED") == 1
    assert await bench.clock(read_at="CAMERA_LOST") == 3


@on_bench(Bench)
async def set_up(bench: Bench) -> None:
    """A written 1 restarts it for one cycle; its state is read as it stands."""
    for word in (CONTROL.mask(), 1, 2, WORD & ~2, 0):
        await bench.clock(("CAMERA_CONTROL", word, WHOLE))
        await bench.clock(("CAMERA_CONTROL", word, WHOLE), rst=True)
    for done, failed, entry, found in ((1, 0, 0x55, 0xAA), (0, 1, 0xAA, 0x55)):
        state: dict[str, Any] = {
            "setup_done": done,
            "setup_failed": failed,
            "setup_entry": entry,
            "setup_found": found,
        }
        assert await bench.clock(read_at="CAMERA_SETUP", **state) == entry | found << 8
        status = STATUS.unpack(await bench.clock(read_at="CAMERA_STATUS", **state))
        assert (status["setup_done"], status["setup_failed"]) == (done, failed)


@on_bench(Bench)
async def random_writes(bench: Bench) -> None:
    """Drive random writes, reads, events and resets."""
    await bench.random_clocks(EVERY)
