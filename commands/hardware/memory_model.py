# SPDX-License-Identifier: Apache-2.0
"""Area, energy, leakage and timing of memories, from those of public macros at 45 nm.

The macros are single-port SRAMs of fakeram45, made with bsg_fakeram and CACTI for NanGate FreePDK45, 1.1 V. A memory
has the figures per bit of the macro that is nearest in words and in bits of a word; a deeper one is several of the
deepest, of which one works at a time. With the node, area grows with the square and time linearly; energy is C V^2, and
C grows linearly. A ROM counts as a RAM, which is too much: one bit of a ROM is a transistor.
"""

from math import hypot, log2
from typing import NamedTuple

NODE_NM, VOLTAGE = 45.0, 1.1


class Ram(NamedTuple):
    """Words and bits of a macro, its area, the energy of an access of one word, and its leakage."""

    depth: int
    width: int
    area_um2: float
    access_pj: float
    leakage_mw: float

    @property
    def bits(self) -> int:
        return self.depth * self.width


RAMS = (
    Ram(32, 32, 794.5, 0.660, 0.0457),
    Ram(64, 64, 3_817.1, 2.498, 0.1872),
    Ram(128, 32, 3_295.7, 1.738, 0.1735),
    Ram(128, 64, 5_479.6, 2.762, 0.3035),
    Ram(256, 32, 5_065.7, 1.874, 0.2898),
    Ram(512, 64, 17_301.4, 5.300, 0.8232),
    Ram(2048, 39, 45_478.8, 6.855, 1.8766),
)
ACCESS_NS, SETUP_NS = 0.435, 0.050  # of the slowest of them
# CACTI's cell is 10 F x 14.6 F; a second port adds two wires of 2.5 F to each side.
SECOND_PORT_UM2 = ((10 + 5) * (14.6 + 5) - 10 * 14.6) * (NODE_NM / 1e3) ** 2
METHOD = "macros of 32 to 2,048 words (CACTI, 45 nm, 1.1 V) by size, scaled to the node"


def nearest(depth: int, width: int) -> Ram:
    """Return the macro whose figures per bit a memory takes."""
    return min(RAMS, key=lambda ram: hypot(log2(ram.depth / depth), log2(ram.width / width)))


def area_um2(depth: int, width: int, node_nm: float, *, two_ports: bool = False) -> float:
    """Return the area of a memory."""
    ram = nearest(depth, width)
    per_bit = ram.area_um2 / ram.bits + two_ports * SECOND_PORT_UM2
    return depth * width * per_bit * (node_nm / NODE_NM) ** 2


def energy_pj(depth: int, width: int, node_nm: float, voltage: float) -> float:
    """Return the energy of reading or writing a word of a memory."""
    ram = nearest(depth, width)
    return ram.access_pj * width / ram.width * node_nm / NODE_NM * (voltage / VOLTAGE) ** 2


def leakage_mw(depth: int, width: int) -> float:
    """Return the leakage of a memory at 45 nm."""
    ram = nearest(depth, width)
    return ram.leakage_mw * depth * width / ram.bits


def times_ns(node_nm: float) -> tuple[float, float]:
    """Return the time from the clock to the output of a memory, and the set-up time of its inputs."""
    return ACCESS_NS * node_nm / NODE_NM, SETUP_NS * node_nm / NODE_NM
