# SPDX-License-Identifier: Apache-2.0
"""Area, energy and timing of memory macros, one figure each, from a published macro at 45 nm.

The macro is the single-port SRAM of 512 words of 64 bits of fakeram45 (public, made with bsg_fakeram and CACTI for
NanGate FreePDK45, 1.1 V): 17,301 um2, 5.3 pJ per access, 0.305 ns from clock to output, 0.050 ns set-up. Every memory
gets its area and energy per bit. With the node, area grows with the square and time linearly; energy is C V^2, and C
grows linearly. Leakage is left out. A ROM counts as a RAM, which is too much: one bit of a ROM is a transistor.
"""

from commands.cost.cost import ACCESS_PJ, WORD_BITS

NODE_NM, VOLTAGE = 45.0, 1.1
AREA_UM2_PER_BIT = 0.53  # 17,301 um2 / (512 x 64)
ACCESS_NS, SETUP_NS = 0.305, 0.050
METHOD = (
    f"{AREA_UM2_PER_BIT} um2 per bit, {ACCESS_PJ} pJ per access of {WORD_BITS} bits at {NODE_NM:g} nm and {VOLTAGE} V, "
    "scaled to the node"
)


def area_um2(bits: float, node_nm: float) -> float:
    """Return the area of `bits` bits of memory."""
    return bits * AREA_UM2_PER_BIT * (node_nm / NODE_NM) ** 2


def energy_pj(bits: float, node_nm: float, voltage: float) -> float:
    """Return the energy of reading or writing `bits` bits."""
    return bits * ACCESS_PJ / WORD_BITS * node_nm / NODE_NM * (voltage / VOLTAGE) ** 2


def times_ns(node_nm: float) -> tuple[float, float]:
    """Return the time from the clock to the output of a memory, and the set-up time of its inputs."""
    return ACCESS_NS * node_nm / NODE_NM, SETUP_NS * node_nm / NODE_NM
