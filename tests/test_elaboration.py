# SPDX-License-Identifier: Apache-2.0
"""Invalid parameters of a core stop its elaboration: the module of the rule that they break is reported as missing.

REFUSED of each core's bench states the rules, and UNITS those of the units, which have no bench.
"""

import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from commands.common import repository, simulator
from commands.verify.slang_lint import findings, waiver
from tactile_depth.chip.tactile_depth import config_value, default_parameters
from tb.settings import RUN
from tb.structures import Refused

SIZES = "pictures_and_windows_have_up_to_8191_rows_and_columns"
LEVELS = "BlackLevel_must_fit_12_bits_and_gains_16"
RATIO = "Numerator_must_be_at_least_Denominator_and_Denominator_at_least_1"
WORDS = "Words_and_Columns_must_be_powers_of_two_with_at_least_8_clocks_in_a_burst"
UNITS = {
    "camera_unit": {
        "CameraFormat=10": "Format_is_a_number_of_camera_format_e",
        "CameraPhase=4": "Phase_is_0_to_3",
        "CameraNumerator=3": RATIO,
        "CameraDenominator=0": Refused(RATIO, {}),
        "CameraPictureColumns=8192": SIZES,
        "CameraPictureRows=-1": SIZES,
        "CameraWindowX=8192": SIZES,
        "CameraWindowY=-1": SIZES,
        "CameraBlackLevel=4096": LEVELS,
        "CameraRedGain=65536": LEVELS,
        "CameraGreenGain=-1": LEVELS,
        "CameraBlueGain=65536": LEVELS,
    },
    "contact_unit": {
        "DataWidth=33": "Width_must_be_2_to_32",
        "Rows=1025": "Rows_must_be_2_to_1024",
        "Columns=1025": "Columns_must_be_2_to_1024",
        "Lanes=128": "Lanes_must_be_a_power_of_two_up_to_64_that_divides_Columns",
        "Rows=4 Columns=4": "a_frame_must_take_at_least_Latency_cycles",
    },
    "depth_unit": {
        "ZeroOffset=2": "ZeroOffset_is_0_or_1",
        "FrameLatency=1": "FrameLatency_must_be_at_least_2",
        "ZeroOffset=1 BlockLog2=0": "BlockLog2_must_be_at_least_1",
        "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
    },
    "gradient_unit": {
        "Polynomial=1": "Polynomial_needs_FlatField",
        "FlatField=2": "FlatField_Polynomial_Corrections_and_LightGains_are_0_or_1",
        "LightGains=1": "LightGains_need_Polynomial",
        "Corrections=1": "Corrections_need_Polynomial",
        "BitsPerChannel=0": "BitsPerChannel_must_be_1_to_8",
        "FlatField=1 GainWidth=33": "GainWidth_must_be_2_to_32",
        "FlatField=1 ColourDrop=100": "Drop_must_leave_a_bit_of_the_input",
        "FlatField=1 CaptureLog2=20": "a_sum_over_2_to_the_MaxLog2_frames_must_fit_Width_bits",
        "FlatField=1 BlockLog2=0": "BlockLog2_must_be_at_least_1",
        "FlatField=1 Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
        "FlatField=1 Polynomial=1 SlopeDrop=100": "Drop_must_leave_a_bit_of_the_input",
        "FlatField=1 Polynomial=1 FineBits=-15": "CoeffWidth_must_be_at_most_WordWidth_and_FineBits",
        "FlatField=1 Polynomial=1 CorrectionUnit=-1": "a_correction_must_fit_the_sum",
    },
    "poisson_unit": {
        "Tridiagonal=2": "Tridiagonal_and_Neumann_are_0_or_1",
        "Lanes=2": "the_spectral_solver_has_one_lane",
        "Neumann=-1": "Tridiagonal_and_Neumann_are_0_or_1",
        "Rows=64": "the_spectral_solver_takes_square_grids_Rows_must_be_Columns",
        "Columns=12": "the_spectral_solver_takes_square_grids_Rows_must_be_Columns",
        "DataWidth=33": "DataWidth_must_be_2_to_32",
        "GradientWidth=1": "GradientWidth_and_CoeffWidth_must_be_2_to_32",
        "CoeffWidth=1": "GradientWidth_and_CoeffWidth_must_be_2_to_32",
        "StoreStyle=3": "StoreStyle_must_be_0_to_2",
        "DivideShiftWidth=0": "DivideShiftWidth_must_be_1_to_6",
        "DivideDrop=100": "Drop_must_leave_a_bit_of_the_input",
        "RowForwardOut=100": "Drop_must_leave_a_bit_of_the_input",
        "ColumnForwardIn=100": "Drop_must_leave_a_bit_of_the_input",
        "ColumnInverseOut=100": "Drop_must_leave_a_bit_of_the_input",
        "RowInverseIn=100": "Drop_must_leave_a_bit_of_the_input",
        "RowInverseOut=100": "Drop_must_leave_a_bit_of_the_input",
        "Tridiagonal=1 WordsPerRow=0": Refused(
            "WordsPerRow_must_be_at_least_1", {"verilator": "depth_must_be_at_least_2"}
        ),
        "Tridiagonal=1 TableWords=1": "Depth_must_be_at_least_2",
        "Tridiagonal=1 SettledWidth=0": "SettledWidth_must_be_1_to_16_and_LastShiftWidth_1_to_6",
        "Tridiagonal=1 LastShiftWidth=0": "SettledWidth_must_be_1_to_16_and_LastShiftWidth_1_to_6",
        "Tridiagonal=1 Lanes=8 DownWords=32": WORDS,
        "Tridiagonal=1 Lanes=8 DownTableWords=1": "Depth_must_be_at_least_2",
        "Tridiagonal=1 Lanes=8 DownSettledWidth=0": "DownSettledWidth_and_UpSettledWidth_must_be_1_to_16",
        "Tridiagonal=1 Lanes=8 UpTableWords=1": "Depth_must_be_at_least_2",
        "Tridiagonal=1 Lanes=8 UpSettledWidth=0": "DownSettledWidth_and_UpSettledWidth_must_be_1_to_16",
        "Tridiagonal=1 Lanes=8 LastShiftWidth=0": "LastShiftWidth_must_be_1_to_6",
        "Tridiagonal=1 Neumann=1 MeanReciprocal=0": "MeanReciprocal_must_fit_CoeffWidth",
        "Tridiagonal=1 Neumann=1 MomentDrop=100": "Drop_must_leave_a_bit_of_the_input",
        "Tridiagonal=1 Neumann=1 MeanDrop=100": "Drop_must_leave_a_bit_of_the_input",
    },
    "video_unit": {
        "Rows=1": "Rows_and_Columns_must_be_at_least_2",
        "Columns=1": "Rows_and_Columns_must_be_at_least_2",
    },
}
REFUSED: dict[str, Mapping[str, str | Refused]] = {
    core: repository.stated(core, "REFUSED") for core in repository.cores() if repository.stated(core, "REFUSED")
} | UNITS
TOOLS = ("icarus", "slang", "verilator")


def parameters(core: str, change: str) -> list[str]:
    """Return a change as parameters of a core: that of a unit changes fields of the default configuration."""
    if core not in repository.cores() or "Config = DefaultConfig" not in repository.cores()[core].hdl.read_text():
        return change.split()
    fields = {name: int(number) for name, number in (word.split("=") for word in change.split())}
    return [f"Config={config_value(default_parameters() | fields)}"]


def output_of(tool: str, core: str, change: str) -> str:
    """Return the message with which a tool refuses to elaborate a core, "" if it accepts."""
    sources, changed = repository.sources(core if core in repository.cores() else None), parameters(core, change)
    if tool == "slang":
        values = dict(word.split("=") for word in changed)
        return "\n".join(str(each) for each in findings([core], sources, values) if waiver(each) is None)
    if tool == "icarus":
        command = ["iverilog", "-g2012", "-t", "null", "-s", core, *(f"-P{core}.{word}" for word in changed)]
    else:
        command = [simulator.VERILATOR, "--lint-only", "--top-module", core, *(f"-G{word}" for word in changed)]
    result = subprocess.run([*command, *sources], capture_output=True, text=True, check=False, cwd=repository.ROOT)
    return (result.stdout + result.stderr) if result.returncode else ""


def refused(tool: str, core: str, change: str, refusal: str | Refused) -> bool:
    """Return True if a tool refuses a change for the stated reason."""
    stated = refusal if isinstance(refusal, Refused) else Refused(refusal)
    output = output_of(tool, core, change)
    return stated.earlier[tool] in output.lower() if tool in stated.earlier else stated.rule in output


@pytest.fixture(autouse=True)
def simulators() -> None:
    for name in simulator.SIMULATORS:
        simulator.check(name)


@pytest.mark.parametrize("tool", TOOLS)
@pytest.mark.parametrize("core", REFUSED)
def test_invalid_parameters_are_refused(core: str, tool: str) -> None:
    """Try every change in Icarus, and in the slower tools the first one, or each in `make regress`."""
    changes = [
        (change, refusal)
        for change, refusal in REFUSED[core].items()
        if tool == "icarus" or '"' not in change  # a text parameter, which each runner quotes in its own way
    ]
    some = changes if tool == "icarus" or RUN.full else changes[:1]
    assert [change for change, refusal in some if not refused(tool, core, change, refusal)] == []


@pytest.mark.parametrize("tool", TOOLS)
def test_a_core_that_does_not_exist_is_not_taken_as_refused(tool: str) -> None:
    assert not refused(tool, "no_such_core", "Size=12", "Size_must_be_a_power_of_two")


@pytest.mark.parametrize("name", simulator.SIMULATORS)
def test_a_parameter_that_the_core_does_not_have_is_an_error(name: str, tmp_path: Path) -> None:
    """Icarus would only warn, and build with the default of the one that was meant."""
    sources, log = repository.sources("td_delay_line"), tmp_path / "build.log"
    with pytest.raises(RuntimeError):
        simulator.build(name, "td_delay_line", sources, {"Lag": 3}, tmp_path, log=log)
    assert "Lag" in log.read_text()


def test_every_field_of_the_configuration_has_a_value_that_is_refused() -> None:
    changed = {word.split("=")[0] for changes in REFUSED.values() for change in changes for word in change.split()}
    assert not default_parameters().keys() - changed


VALID = [
    *("td_burst_counter Words=2", "frame_guard Rows=2", "sdf_butterfly RotateBlock=4", "threshold_comparator Width=32"),
    *("contact_events Rows=4 Columns=8", "contact_events Rows=1024 Columns=1024 Width=32"),
]


@pytest.mark.parametrize("tool", TOOLS[:2])
def test_valid_parameters_are_not(tool: str) -> None:
    assert [case for case in VALID if output_of(tool, *case.split(maxsplit=1))] == []
