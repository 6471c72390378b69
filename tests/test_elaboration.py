# SPDX-License-Identifier: Apache-2.0
"""Invalid parameters of a core stop its elaboration with a message of the core."""

import subprocess
import sys

import pytest

from commands.common import repository, simulator
from tactile_depth.tactile_depth import config_value, default_parameters
from tb.stream import REGRESS

INVALID = {
    "td_burst_counter": ["Words=1"],
    "td_delay_line": ["Delay=0"],
    "row_reorder": ["Columns=12", "Columns=2"],
    "transpose": ["Columns=12", "Columns=2"],
    "mode_pairs": ["Size=12", "Size=2"],
    "frame_stack": ["Columns=1", "Rows=1", "WordsPerRow=0", "Lanes=3", "Lanes=128"],
    "corner_turn": ["Lanes=1", "Lanes=12", "Lanes=128", "Columns=96"],
    "back_substitution": ["Lanes=3", "Lanes=64"],
    "frame_guard": ["Rows=1", "Columns=1"],
    "frame_output": ["Columns=12", "Rows=1"],
    "divergence": ["Columns=1"],
    "threshold_comparator": ["Width=33", "Lanes=0"],
    "beat_sums": ["Lanes=1", "Lanes=12"],
    "contact_sums": ["Lanes=3", "Lanes=64"],
    "contact_events": [
        *("Width=1", "Width=33", "Rows=1", "Rows=1025", "Columns=1", "Columns=1025", "Rows=4 Columns=4"),
    ],
    "td_divide": ["DivisorWidth=0", "QuotientWidth=1"],
    "td_block_sum": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "SumWidth=27"],
    "td_ram": ["Depth=1", 'Style=2 File="contents.hex"'],
    "td_rom": ["Depth=1"],
    "gradient_lookup": ["BitsPerChannel=0", *(["BitsPerChannel=9"] if REGRESS else [])],  # 4 GB of table
    "flat_field": ["Offset=1"],
    "td_gain_map": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7"],
    "zero_offset": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "Lanes=128", "Lanes=3"],
    "td_node_map": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "Lanes=1", "Lanes=3", "Lanes=128"],
    "td_ramp": ["Count=0", "Count=3", "StepWidth=33"],
    "zero_capture": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "MaxLog2=9"],
    "reference_capture": ["BlockLog2=0", "Columns=96", "Columns=8", "Rows=7", "MaxLog2=11", "GainFraction=10"],
    "td_async_fifo": ["DepthLog2=1"],
    "block_weights": ["Denominator=0", "Numerator=3"],
    "row_sums": ["Bayer=2", "Numerator=7"],
    "block_totals": ["Columns=3"],
    "round_divide": ["TotalWidth=9", "WeightWidth=0", "Drop=1"],
    "area_average": ["Bits=7", "Rows=1", "Columns=3", "Numerator=7"],
    "dvp_receive": ["FifoLog2=2"],
    "pixel_format": ["Format=10", "Phase=4"],
    "camera_window": ["WindowColumns=1", "WindowRows=8192", "WordsPerPixel=3"],
    "camera_setup": ["AddressBytes=3", "QuarterClocks=3", "Entries=1", "Attempts=0", "DeviceId=67", "DeviceId=256"],
    "camera_registers": ["PictureColumns=8192", "WindowY=-1", "WindowRows=8192", "BlackLevel=4096", "BlueGain=65536"],
    "camera_front_end": ["Format=-1", "Numerator=7", "Rows=4096"],
    "spectral_divide": ["Columns=12", "Columns=1"],
    "thomas_table": ["Columns=12", "Rows=1"],
    "twiddle_multiply": ["Size=12", "Size=1", "Block=12", "Block=1", "Block=256"],
    "tactile_depth": ["Quadratic=1", "Rows=64", "DataWidth=33", "ZeroOffset=2"],
    "poisson_unit": [
        *(
            "Tridiagonal=2",
            "Lanes=2",
            "Neumann=-1",
            "Rows=64",
            "Columns=12",
            "DataWidth=33",
        ),
        *("GradientWidth=1", "CoeffWidth=1", "StoreStyle=3", "DivideShiftWidth=0", "DivideDrop=100"),
        *("RowForwardOut=100", "ColumnForwardIn=100", "ColumnInverseOut=100", "RowInverseIn=100", "RowInverseOut=100"),
        *(f"Tridiagonal=1 {word}" for word in ("WordsPerRow=0", "TableWords=1", "SettledWidth=0")),
        "Tridiagonal=1 LastShiftWidth=0",
        *(f"Tridiagonal=1 Neumann=1 {word}" for word in ("MeanReciprocal=0", "MomentDrop=100", "MeanDrop=100")),
    ],
    "gradient_unit": [
        *("Quadratic=1", "FlatField=2", "BitsPerChannel=0"),
        *(f"FlatField=1 {word}" for word in ("GainWidth=33", "ColourDrop=100")),
        *(f"FlatField=1 {word}" for word in ("CaptureLog2=20", "BlockLog2=0", "Rows=7")),
        "FlatField=1 Quadratic=1 SlopeDrop=100",
    ],
    "depth_unit": [
        "ZeroOffset=2",
        "FrameLatency=0",
        "ZeroOffset=1 BlockLog2=0",
        "Columns=12",
    ],
    "td_round_saturate": ["Drop=46", "OutWidth=1"],
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
        *("Rows=0", "Rows=65536", "Columns=0", "Columns=65536", "GradientWidth=1", "GradientWidth=33"),
        *("BitsPerChannel=0", "BitsPerChannel=9", "GradientFraction=256", "DepthMantissa=16777216"),
        *("SlopeMantissa=-1", "DepthExponent=-129", "SlopeExponent=128", "PitchNm=-1"),
    ],
}

TOOLS = ("icarus", "slang", "verilator")


def parameters(core: str, change: str) -> list[str]:
    """Return a change as parameters of a core: that of a unit changes fields of the default configuration."""
    if "Config = DefaultConfig" not in repository.cores()[core].hdl.read_text():
        return change.split()
    fields = {name: int(number) for name, number in (word.split("=") for word in change.split())}
    return [f"Config={config_value(default_parameters() | fields)}"]


def refused(tool: str, core: str, change: str) -> str:
    """Return the message with which a tool refuses to elaborate a core, "" if it accepts."""
    sources, changed = [str(path) for path in repository.sources()], parameters(core, change)
    if tool == "icarus":
        command = ["iverilog", "-g2012", "-t", "null", "-s", core, *(f"-P{core}.{word}" for word in changed)]
    elif tool == "verilator":
        command = ["verilator", "--lint-only", "--top-module", core, *(f"-G{word}" for word in changed)]
    else:
        command = [sys.executable, "-m", "commands.verify.slang_lint", core, *(f"-G{word}" for word in changed)]
    result = subprocess.run([*command, *sources], capture_output=True, text=True, check=False, cwd=repository.ROOT)
    return (result.stdout + result.stderr) if result.returncode else ""


@pytest.mark.parametrize(
    ("tool", "core", "change"),
    [
        pytest.param(tool, core, change, marks=[pytest.mark.regress] if tool != "icarus" and index else [])
        for core, changes in INVALID.items()
        for index, change in enumerate(changes)
        for tool in TOOLS
        if tool == "icarus" or '"' not in change  # a text parameter, which each runner quotes in its own way
    ],
)
def test_an_invalid_parameter_is_refused(tool: str, core: str, change: str) -> None:
    """Refuse an invalid parameter: the message names the rule, or the tool stops earlier at a consequence."""
    for simulation in simulator.SIMULATORS:
        simulator.check(simulation)
    output = refused(tool, core, change).lower()
    assert "unknown module" in output or "error" in output


def test_every_field_of_the_configuration_has_a_value_that_is_refused() -> None:
    changed = {word.split("=")[0] for changes in INVALID.values() for change in changes for word in change.split()}
    assert not default_parameters().keys() - changed


VALID = [
    *("td_burst_counter Words=2", "frame_guard Rows=2", "sdf_butterfly RotateBlock=4", "threshold_comparator Width=32"),
    *("contact_events Rows=4 Columns=8", "contact_events Rows=1024 Columns=1024 Width=32"),
]


@pytest.mark.parametrize("case", VALID)
@pytest.mark.parametrize("tool", TOOLS[:2])
def test_a_valid_parameter_is_not(tool: str, case: str) -> None:
    simulator.check("icarus")
    core, change = case.split(maxsplit=1)
    assert not refused(tool, core, change)
