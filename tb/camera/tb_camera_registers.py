# SPDX-License-Identifier: Apache-2.0
"""camera_registers against its model in every clock; counts are set too, because 2^32 events would take too long."""

import random
from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.camera_registers import (
    CONTROL,
    COUNTERS,
    CameraRegisters,
    Levels,
    Setup,
    camera_registers_parameters,
)
from tactile_depth.chip.camera.camera_window import FAULTS
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS
from tb import structs
from tb.lockstep import WORD, Pins, play
from tb.registers.bus import NAME_AT, Bus
from tb.stream import parameters
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


STRUCTURES = (built(VGA, on=VERILATOR), built(OTHER, on=ICARUS, mutants=ICARUS))
PROTOCOL = {"counts": "live"}
MUTANTS = Mutants(outside=("dropped", "lost"), flat=False)
PROOFS = (Proof(FULL_WIDTH),)


PARAMETERS = (
    *("PictureColumns", "PictureRows", "WindowX", "WindowY", "BlackLevel", "RedGain", "GreenGain", "BlueGain"),
    *("WindowColumns", "WindowRows", "Format", "Phase"),
)


class Registers:
    """The model at the pins of the core."""

    def __init__(self, values: dict[str, int]) -> None:
        self.model = CameraRegisters(values)

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        written, read = (CAMERA_REGISTERS.get(NAME_AT.get(pins[f"{kind}_offset"], "")) for kind in ("write", "read"))
        model, ones, restarts = self.model, pins["write_ones"], False
        setup = Setup(bool(pins["setup_done"]), bool(pins["setup_failed"]), pins["setup_entry"], pins["setup_found"])
        levels = Levels(**structs.unpack("camera_levels_t", pins["levels"]))
        out = {
            "settings": structs.pack("camera_settings_t", model.settings),
            "writable": bool(written and written.writable),
            "readable": bool(read),
            "read_data": model.read(read.name, setup, levels) if read else 0,
        }
        if pins["write"] and written:
            restarts = written is CONTROL and bool(CONTROL.unpack(ones)["restart_setup"])
            model.write(written.name, ones, pins["write_mask"])
        faults = structs.unpack("camera_faults_t", pins["faults"])
        model.clock([name for name in FAULTS if faults[name]], pins["frames_lost"])
        if pins["rst"]:
            model.reset()
        return out | {"setup_restart": restarts}


@cocotb.test
async def registers(dut: Any) -> None:
    chance, bus = random.Random(cocotb.RANDOM_SEED), Bus(dut, *CAMERA_REGISTERS)
    bits = [1 << bit for bit in range(len(dut.faults))]
    pins = {
        **bus.choices,
        "faults": [0, sum(bits), *bits],
        "frames_lost": [0, *range(256)],
        **dict.fromkeys(("setup_done", "setup_failed"), 1.0),
        **dict.fromkeys(("setup_entry", "setup_found", "levels"), WORD),
    }

    def legal(core: Registers, pins: Pins) -> None:
        """Set the counts at times: one may stand below a carry or the largest."""
        bus.drive(pins)
        if chance.random() < 0.02:
            count = chance.choice(((1 << chance.randrange(33)) - 1, 2**32 - 1 - chance.getrandbits(8)))
            core.model.values.update(dict.fromkeys(COUNTERS, count))
            dut.dropped.value = dut.lost.value = count

    await play(dut, Registers(dict(zip(PARAMETERS, parameters(dut, *PARAMETERS), strict=True))), pins, legal)
