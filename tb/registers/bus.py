# SPDX-License-Identifier: Apache-2.0
"""Choices of the pins of AXI4-Lite, and of those between axil_port and a core of registers, for benches in lockstep."""

from typing import Any

from tactile_depth.chip.registers.axil_port import strobed_bits
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS, REGISTERS
from tb.lockstep import WORD, Pins

OFFSET = {name: register.offset for name, register in {**REGISTERS, **CAMERA_REGISTERS}.items()}
NAME_AT = {offset: name for name, offset in OFFSET.items()}
STROBES = [strobed_bits(strobe) for strobe in (15, *range(15))]
CHANNELS = ("s_axil_aw", "s_axil_w", "s_axil_ar")
"""Streams into a port on AXI4-Lite."""
PINS = {
    **dict.fromkeys((f"s_axil_{pin}" for pin in ("awaddr", "wdata", "araddr")), WORD),
    "s_axil_wstrb": range(15, -1, -1),
    **dict.fromkeys((f"s_axil_{pin}" for pin in ("awvalid", "wvalid", "bready", "arvalid", "rready")), 1.0),
}
"""Choices of the pins of a client on AXI4-Lite."""


def choices(dut: Any, *names: str) -> dict[str, Any]:
    """Return the choices for a core of these registers: as often theirs as offsets that differ from one in one bit."""
    own = [OFFSET[name] for name in names]
    at = own * 32 + [offset ^ 1 << bit for offset in own for bit in range(32)]
    bus = {"write": 1.0, "write_offset": at, "write_ones": WORD, "write_mask": STROBES, "read_offset": at}
    return {pin: choice for pin, choice in bus.items() if hasattr(dut, pin)}


def strobed(model: Any, pins: Pins) -> None:
    """Clear the data of bytes without strobe."""
    pins["write_ones"] &= pins["write_mask"]
