# SPDX-License-Identifier: Apache-2.0
"""Parameters that a door cannot take stop its elaboration: the module of the rule that they break is missing.

REFUSED of a bench states the rules of its core, and CONFIG those of the modules that take a configuration.
"""

import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from commands.common import repository, simulator
from commands.verify.slang_lint import findings, waiver
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import config_value, default_parameters, top_parameters
from tb.settings import RUN

WIDE = "Tridiagonal=1 Lanes=8"
NEUMANN = "Tridiagonal=1 Neumann=1"
POLYNOMIAL = "FlatField=1 Polynomial=1"
CHECKED = top_parameters(Configuration(self_check=True))
CHECK = " ".join(f"{name}={CHECKED[name]}" for name in CHECKED if name == "ResidualBound" or name.startswith("Check"))
CONFIG = {
    "tactile_sensor": {"Config_has_no_camera": "Camera=0"},
    "camera_unit": {
        "Format_is_a_number_of_camera_format_e": "CameraFormat=-1, CameraFormat=10",
        "Phase_is_0_to_3": "CameraPhase=-1, CameraPhase=4",
        "Rows_must_be_at_least_2_and_Columns_4": "Rows=1, Columns=1, Columns=3",
        "Numerator_must_be_at_least_Denominator_and_Denominator_at_least_1": "CameraNumerator=3, CameraDenominator=16",
        "below_a_ratio_of_2_some_blocks_lack_a_colour": "CameraNumerator=7",
        "pictures_and_windows_have_up_to_8191_rows_and_columns": "CameraPictureColumns=8192, CameraPictureRows=-1, "
        "CameraWindowX=8192, CameraWindowY=-1, Rows=4096, Columns=4096",
        "BlackLevel_must_fit_12_bits_and_gains_16": "CameraBlackLevel=4096, CameraRedGain=65536, CameraGreenGain=-1, "
        "CameraBlueGain=65536",
    },
    "poisson_unit": {
        "Tridiagonal_and_Neumann_are_0_or_1": "Tridiagonal=2, Neumann=-1",
        "Columns_must_be_a_power_of_two_16_to_1024": "Tridiagonal=1 Columns=2, Tridiagonal=1 Columns=8, "
        "Tridiagonal=1 Columns=96, Tridiagonal=1 Columns=2048, Rows=1 Columns=1, Rows=8 Columns=8, Rows=96 Columns=96",
        "Rows_must_be_8_to_1024": "Tridiagonal=1 Rows=1, Tridiagonal=1 Rows=7, Tridiagonal=1 Rows=1025",
        "Lanes_must_be_a_power_of_two_up_to_64_and_half_of_Columns": "Tridiagonal=1 Lanes=0, Tridiagonal=1 Lanes=3, "
        "Tridiagonal=1 Lanes=128, Tridiagonal=1 Lanes=16 Columns=16",
        "the_spectral_solver_takes_square_grids_and_has_one_lane": "Rows=64, Columns=64, Lanes=2",
        "DataWidth_must_be_2_to_32": "DataWidth=1, DataWidth=33",
        "GradientWidth_and_CoeffWidth_must_be_2_to_32": "GradientWidth=1, GradientWidth=33, CoeffWidth=1, "
        "CoeffWidth=33",
        "StoreStyle_must_be_0_to_2": "StoreStyle=-1, StoreStyle=3",
        "DivideShiftWidth_and_LastShiftWidth_must_be_1_to_6": "DivideShiftWidth=0, DivideShiftWidth=7, "
        f"Tridiagonal=1 LastShiftWidth=0, {WIDE} LastShiftWidth=7",
        "DownSettledWidth_and_UpSettledWidth_must_be_1_to_16": "Tridiagonal=1 DownSettledWidth=0, "
        f"Tridiagonal=1 UpSettledWidth=17, {WIDE} DownSettledWidth=0, {WIDE} UpSettledWidth=17",
        "MeanReciprocal_must_fit_CoeffWidth": f"{NEUMANN} MeanReciprocal=0, {NEUMANN} MeanReciprocal=131073",
        "WordsPerRow_must_be_at_least_1": "Tridiagonal=1 WordsPerRow=-1",
        "DownWords_must_be_a_power_of_two_up_to_half_of_Lanes_and_an_eighth_of_Columns": f"{WIDE} DownWords=0, "
        f"{WIDE} DownWords=3, {WIDE} DownWords=16, Tridiagonal=1 Lanes=64 DownWords=32, Tridiagonal=1 DownWords=2",
        "Drop_must_leave_a_bit_of_the_input": "DivideDrop=100, RowForwardOut=100, ColumnForwardIn=100, "
        f"ColumnInverseOut=100, RowInverseIn=100, RowInverseOut=100, {NEUMANN} MomentDrop=100, {NEUMANN} MeanDrop=100",
        "Parity_must_be_0_or_1": "Parity=2",
        "a_check_needs_32_Columns_and_8_cycles_for_a_row_more_with_many_Lanes": f"{CHECK} Columns=16, {CHECK} Lanes=32",
        "CheckDropped_and_CheckInDropped_must_leave_two_bits": f"{CHECK} CheckDropped=23, {CHECK} CheckInDropped=-1",
        "CheckSumWidth_must_be_the_bits_that_stay_of_a_depth_to_32": f"{CHECK} CheckSumWidth=17, "
        f"{CHECK} CheckSumWidth=33",
        "ResidualBound_must_fit_a_sum": f"{CHECK} ResidualBound=-1, {CHECK} ResidualBound=8388608",
        "CheckScaleFraction_must_be_1_to_30_and_leave_the_time_to_multiply": f"{CHECK} CheckScaleFraction=31, "
        f"{CHECK} CheckScale=1 CheckScaleFraction=0",
        "CheckScale_must_be_at_least_1_and_below_2_to_the_CheckScaleFraction": f"{CHECK} CheckScale=0, "
        f"{CHECK} CheckScale={1 << 24}",
        "a_check_needs_a_FrameLatency_below_a_frame_or_a_half_more_with_a_power_of_two_of_Rows": f"{CHECK} "
        f"FrameLatency=16200 Rows=127, {CHECK} FrameLatency=24400",
        "Depth_must_be_at_least_2": f"Tridiagonal=1 DownTableWords=1, {WIDE} UpTableWords=1",
    },
    "tactile_depth": {
        "FlatField_Polynomial_Corrections_LightGains_and_ZeroOffset_are_0_or_1": "FlatField=2, ZeroOffset=2, "
        "FlatField=-1",
        "Corrections_and_LightGains_need_Polynomial_and_that_needs_FlatField": "Polynomial=1, "
        "FlatField=1 Corrections=1, FlatField=1 LightGains=1",
        "BitsPerChannel_must_be_1_to_8": "BitsPerChannel=0, BitsPerChannel=9",
        "GainWidth_must_be_2_to_32": "FlatField=1 GainWidth=1, FlatField=1 GainWidth=33",
        "a_sum_of_a_block_over_2_to_the_CaptureLog2_frames_must_fit_GainWidth": "FlatField=1 CaptureLog2=11",
        "FineBits_must_leave_a_coefficient_of_a_colour_in_the_words": f"{POLYNOMIAL} FineBits=-15",
        "a_correction_must_fit_the_sum": f"{POLYNOMIAL} CorrectionUnit=-1, {POLYNOMIAL} CorrectionUnit={1 << 28}",
        "FrameLatency_must_be_at_least_2": "FrameLatency=1",
        "GradientFraction_does_not_fit_FORMAT": "GradientFraction=-1, GradientFraction=256",
        "a_mantissa_does_not_fit_24_bits": f"DepthMantissa={1 << 24}, SlopeMantissa=-1",
        "an_exponent_does_not_fit_8_bits": "DepthExponent=-129, SlopeExponent=128",
        "PitchNm_must_not_be_negative": "PitchNm=-1",
        "DataWidth_must_be_2_to_32": "DataWidth=33",
        "Drop_must_leave_a_bit_of_the_input": f"FlatField=1 ColourDrop=100, {POLYNOMIAL} SlopeDrop=100",
        "BlockLog2_must_be_at_least_1": "FlatField=1 BlockLog2=0, ZeroOffset=1 BlockLog2=0",
        "two_blocks_a_row_and_one_a_column_are_needed": "FlatField=1 BlockLog2=7, ZeroOffset=1 BlockLog2=7",
        "four_words_a_row_are_needed_an_addition_takes_three_clocks": "Tridiagonal=1 ZeroOffset=1 Lanes=64",
    },
}
"""Modules that take a configuration: each change of fields of the default that breaks a rule, with commas between."""
REFUSED: Mapping[str, Mapping[str, str]] = CONFIG | {
    core: stated for core in repository.cores() if (stated := repository.stated(core, "REFUSED"))
}
TOOLS = ("icarus", "slang", "verilator")


def parameters(core: str, change: str) -> list[str]:
    """Return a change as parameters of a core."""
    if core not in CONFIG:
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


@pytest.fixture(autouse=True)
def simulators() -> None:
    for name in simulator.SIMULATORS:
        simulator.check(name)


@pytest.mark.parametrize("tool", TOOLS)
@pytest.mark.parametrize("core", REFUSED)
def test_invalid_parameters_are_refused(core: str, tool: str) -> None:
    """Try every change in Icarus, and in the slower tools the first one, or each in `make regress`."""
    changes = [
        (change, rule)
        for rule, listed in REFUSED[core].items()
        for change in listed.split(", ")
        if tool == "icarus" or '"' not in change  # a text parameter, which each runner quotes in its own way
    ]
    some = changes if tool == "icarus" or RUN.full else changes[:1]
    assert [change for change, rule in some if rule not in output_of(tool, core, change)] == []


def test_every_rule_refuses_something() -> None:
    rules = [rule for file in repository.sources() for rule in re.findall(r"(\w+) u_refused \(", file.read_text())]
    assert sorted({*rules} - {rule for stated in REFUSED.values() for rule in stated}) == []


@pytest.mark.parametrize("tool", TOOLS)
def test_a_core_that_does_not_exist_is_not_taken_as_refused(tool: str) -> None:
    assert "Size_must_be_a_power_of_two" not in output_of(tool, "no_such_core", "Size=12")


@pytest.mark.parametrize("name", simulator.SIMULATORS)
def test_a_parameter_that_the_core_does_not_have_is_an_error(name: str, tmp_path: Path) -> None:
    """Icarus would only warn, and build with the default of the one that was meant."""
    sources, log = repository.sources("td_delay_line"), tmp_path / "build.log"
    with pytest.raises(RuntimeError):
        simulator.build(name, "td_delay_line", sources, {"Lag": 3}, tmp_path, log=log)
    assert "Lag" in log.read_text()


def test_every_field_of_the_configuration_has_a_value_that_is_refused() -> None:
    changes = " ".join(listed for stated in CONFIG.values() for listed in stated.values())
    any_number = {"TablesCrc"}
    assert default_parameters().keys() - set(re.findall(r"(\w+)=", changes)) == any_number


VALID = (
    "td_burst_counter Words=2",
    "link_unit Rows=2 Columns=2 DataWidth=2 AddressWidth=2",
    "camera_unit Rows=2 Columns=4",
    "poisson_unit Tridiagonal=1 Rows=8 Columns=16",
    f"poisson_unit {WIDE} Rows=1024 Columns=1024 DataWidth=32",
)


@pytest.mark.parametrize("tool", TOOLS[:2])
def test_valid_parameters_are_not(tool: str) -> None:
    assert [case for case in VALID if output_of(tool, *case.split(maxsplit=1))] == []
