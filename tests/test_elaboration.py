# SPDX-License-Identifier: Apache-2.0
"""Parameters that a core cannot be built with stop it before it runs, by its own word."""

import subprocess
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository, simulator
from tb.stream import REGRESS

INVALID = {
    "burst_counter": ["Size=1"],
    "delay_line": ["Delay=0"],
    "row_reorder": ["Size=12", "Size=2"],
    "transpose": ["Size=12", "Size=2"],
    "mode_pairs": ["Size=12", "Size=2"],
    "frame_stack": ["Size=1", "Rows=1", "WordsPerRow=0"],
    "frame_guard": ["Rows=1", "Columns=1"],
    "frame_output": ["Columns=12", "Rows=1"],
    "divergence": ["Columns=1"],
    "threshold_comparator": ["Width=33"],
    "contact_events": [
        *("Width=1", "Width=33", "Rows=1", "Rows=1025", "Columns=1", "Columns=1025", "Rows=4 Columns=4"),
    ],
    "ram": ["Depth=1", 'Style=2 File="contents.hex"'],
    "rom": ["Depth=1"],
    "gradient_lookup": ["BitsPerChannel=0", *(["BitsPerChannel=9"] if REGRESS else [])],  # 4 GB of table
    "flat_field": ["Offset=1"],
    "gain_map": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7"],
    "auto_zero": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7"],
    "floor_capture": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "MaxLog2=9"],
    "reference_capture": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "MaxLog2=11", "GainFraction=10"],
    "spectral_divide": ["Size=12", "Size=1"],
    "thomas_table": ["Size=12", "Rows=1"],
    "twiddle_multiply": ["Size=12", "Size=1", "Block=12", "Block=1", "Block=256"],
    "tactile_depth": ["Rows=64", "DataWidth=33"],
    "round_saturate": ["Drop=46", "OutWidth=1"],
    "sdf_butterfly": [
        "Size=12",
        "Delay=0",
        "Delay=128",
        "Delay=6",
        "RotateBlock=2",
        "RotateBlock=6",
        "RotateBlock=256",
    ],
    "sdf_fft": ["Size=4", "Size=24"],
    "axil_registers": [
        *("Rows=0", "Rows=65536", "Columns=0", "Columns=65536"),
        *("GradientWidth=1", "GradientWidth=33", "BitsPerChannel=11"),
    ],
}
CASES = [(core, change) for core, changes in INVALID.items() for change in changes]


def refused(core: Any, change: Any, folder: Path) -> str:
    """Return the message with which Icarus refuses: at elaboration, or by $fatal at time 0."""
    changes = [f"-P{core}.{parameter}" for parameter in change.split()]
    sources = [str(path) for path in repository.sources()]
    built = folder / "built"
    command = ["iverilog", "-g2012", "-o", built, "-s", core, *changes, *sources]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        return result.stderr
    result = subprocess.run(["vvp", "-n", built], capture_output=True, text=True, check=False, cwd=folder)
    return result.stdout + result.stderr if result.returncode else ""


@pytest.mark.parametrize(("core", "change"), CASES)
def test_an_invalid_parameter_is_refused(tmp_path: Path, core: str, change: Any) -> None:
    simulator.check("icarus")
    assert "FATAL" in (said := refused(core, change, tmp_path)) or "error" in said.lower()


VALID = [
    *("burst_counter Size=2", "frame_guard Rows=2", "sdf_butterfly RotateBlock=4", "threshold_comparator Width=32"),
    *("contact_events Rows=4 Columns=8", "contact_events Rows=1024 Columns=1024 Width=32"),
]


@pytest.mark.parametrize("case", VALID)
def test_a_valid_parameter_is_not(tmp_path: Path, case: Any) -> None:
    simulator.check("icarus")
    core, change = case.split(maxsplit=1)
    assert not refused(core, change, tmp_path)
