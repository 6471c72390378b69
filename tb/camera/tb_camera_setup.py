# SPDX-License-Identifier: Apache-2.0
"""camera_setup against its model in every clock; tests/camera/test_camera_setup.py plays the model with cameras."""

import random
from functools import partial
from typing import Any

import cocotb

from formal.entries import Proof
from formal.tables import camera_list
from tactile_depth.chip.camera.camera_setup import READ, CameraSetup, Entry, Kind, bits_of
from tactile_depth.chip.camera.register_lists import Camera, setup_parameters, write_list
from tb.lockstep import CLOCKS, Pins, play
from tb.settings import RUN
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, Structure

COUNTS = ("AddressBytes", "DeviceId", "QuarterClocks", "MillisecondClocks", "Attempts", "XclkHalfClocks")


# Lists with each kind of entry, for registers of one and of two bytes.
LISTS = {
    "short": (
        Entry(Kind.PINS, 2, 2),
        Entry(Kind.PINS, 1, 0),
        Entry(Kind.CHECK, 0x0A, 0x76),
        Entry(Kind.PLAIN_WRITE, 0x12, 0x80),
        Entry(Kind.WRITE, 0xA5, 0x5A),
        Entry(Kind.PINS, 1, 1),
        Entry(Kind.WRITE, 0x03, 0xFF),
    ),
    "wide": (
        Entry(Kind.PINS, 2, 0xA5),
        Entry(Kind.PINS, 1, 0),
        Entry(Kind.CHECK, 0x300A, 0x56),
        Entry(Kind.PLAIN_WRITE, 0x3008, 0x82),
        Entry(Kind.WRITE, 0xC35A, 0x01),
        Entry(Kind.WRITE, 0x3CA5, 0xFE),
    ),
}

TIMES = {"QuarterClocks": 4, "MillisecondClocks": 3, "XclkHalfClocks": 2, "Attempts": 4}


def built(entries: str, **runs: Any) -> Structure:
    device = {"short": (1, 0x42), "wide": (2, 0x78)}[entries]
    camera = Camera(entries, *device, picture=(1, 1), bayer="bggr", frames_per_s=1, entries=LISTS[entries])
    return Structure(
        {**setup_parameters(camera), **TIMES},
        device={"list": entries},
        roms=partial(write_list, entries=camera.entries),
        name=entries,
        **runs,
    )


STRUCTURES = (built("short", on=BOTH), built("wide", on=ICARUS, mutants=ICARUS))
PROTOCOL = {"counts": "live"}
REFUSED = {
    "AddressBytes_must_be_1_or_2": "AddressBytes=3",
    "QuarterClocks_must_be_at_least_4_the_line_takes_three_to_be_seen": "QuarterClocks=3",
    "MillisecondClocks_and_Entries_must_be_at_least_2_XclkHalfClocks_and_Attempts_1": "Entries=1, Attempts=0",
    "DeviceId_must_be_an_even_byte": "DeviceId=67, DeviceId=256",
}
PROOFS = (Proof("a list with every kind of entry", {"Bus": 0}, roms=camera_list, free=("sent", "caught")),)


@cocotb.test
async def lists(dut: Any) -> None:
    address_bytes, device_id, quarter, millisecond, attempts, half = parameters(dut, *COUNTS)
    entries = LISTS[RUN.device["list"]]
    model = CameraSetup(entries, address_bytes, device_id, quarter, millisecond, attempts, half)
    chance = random.Random(cocotb.RANDOM_SEED)
    pins: dict[str, Any] = {"rst": 0.0007, "restart": 0.0007, "sio_d": [1, 0, 0]}

    def legal(core: CameraSetup, pins: Pins) -> None:
        """Answer a read in the quarter that is looked at: what stands for the line is where it is wrong."""
        bits = bits_of([core.device_id | READ, core.entries[core.entry].data])
        place = 1 + len(bits) - len(core.symbols)
        if core.quarter != 2:
            pins["sio_d"] = chance.getrandbits(1)
        elif core.symbols and core.step == 2 and 0 <= place < len(bits):
            pins["sio_d"] ^= bits[place]

    await play(dut, model, pins, legal, clocks=max(CLOCKS, 40_000))
