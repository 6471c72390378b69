# SPDX-License-Identifier: Apache-2.0
"""register_access: RTL against the model of the device; tests/link/test_device.py tests that."""

from formal.entries import Proof
from tb.structures import BOTH, ICARUS, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("AddressWidth Accesses")
STRUCTURES = (
    built(10, 128, on=BOTH),
    built(4, 3, on=ICARUS, mutants=True),
    built(16, 128),
)
MUTANTS = Mutants(repeats=2)
REFUSED = {
    "AddressWidth=1": "AddressWidth_must_be_2_to_16",
    "AddressWidth=17": "AddressWidth_must_be_2_to_16",
    "Accesses=1": "Accesses_must_be_2_to_128",
    "Accesses=129": "Accesses_must_be_2_to_128",
}
PROOFS = (
    Proof(
        "each access once, one at a time, in its clock, with its own address and value; none behind a refused one, "
        "above the width, or of a repeated request; the reply has what was done and the values read, a repeated one "
        "the same",
        "accesses are only counted, and no value is looked at; td_ram is proven by itself",
        depth=32,
        free=("word",),
    ),
)
