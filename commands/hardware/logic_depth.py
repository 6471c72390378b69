# SPDX-License-Identifier: Apache-2.0
"""Logic depth of a mapped design: the longest path through its cells, without wires, by Yosys' `sta`."""

import re
from pathlib import Path

FILE = "depth.txt"
NOTE = (
    "Logic depth: 7-series cells in a row, of a core by itself and of the whole flattened; no wires, no times of "
    "registers, and none of memories of LUTs, which Yosys does not have."
)
# Appended to a mapping to 7-series logic. Yosys reads the times of the cells anew: the mapping leaves them without.
COMMANDS = (
    "read_verilog -overwrite -lib -specify +/xilinx/cells_sim.v",
    f"tee -q -o {FILE} sta",
    "setattr -mod -unset keep_hierarchy *",
    "flatten",
    f"tee -q -a {FILE} sta",
)
ARRIVAL = re.compile(r"Latest arrival time in '(?P<module>\S+)' is (?P<picoseconds>\d+)")


def depths(folder: Path) -> dict[str, float]:
    """Return the logic depth of each module in ns, that of the top with everything in it."""
    found = ARRIVAL.finditer((folder / FILE).read_text())
    return {match["module"]: int(match["picoseconds"]) / 1000 for match in found}
