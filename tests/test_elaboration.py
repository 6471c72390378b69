# SPDX-License-Identifier: Apache-2.0
"""Invalid parameters of a core stop its elaboration: the module of the rule that they break is reported as missing.

REFUSED of each core's test states the rules.
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

REFUSED: dict[str, Mapping[str, str | Refused]] = {
    core: repository.stated(core, "REFUSED") for core in repository.cores() if repository.stated(core, "REFUSED")
}
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
