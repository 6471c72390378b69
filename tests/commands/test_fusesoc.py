# SPDX-License-Identifier: Apache-2.0
"""tactile_depth.core lists hdl/ and nothing else; its generator writes what the top reads; its part is the script's."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from commands.common import repository
from tactile_depth.configuration import Configuration
from tactile_depth.tactile_depth import top_parameters

CORE = repository.ROOT / "tactile_depth.core"


@pytest.fixture
def core() -> Any:
    return yaml.safe_load(CORE.read_text().removeprefix("CAPI=2:"))


def test_it_lists_every_file_of_hdl_and_no_other(core: Any) -> None:
    listed = core["filesets"]["rtl"]["files"]
    assert sorted(listed) == sorted(str(path.relative_to(repository.ROOT)) for path in repository.sources())
    assert listed[0].endswith("_pkg.sv")


def test_it_names_targets(core: Any) -> None:
    assert {"default", "lint", "sim", "synth"} == core["targets"].keys()


def test_part_is_that_of_the_vivado_script(core: Any) -> None:
    script = (repository.ROOT / "constraints" / "xczu7ev_ooc.tcl").read_text()
    assert re.search(r"^set part (\S+)$", script, re.M)[1] == core["targets"]["synth"]["flow_options"]["part"]  # type: ignore[index]


def generated(folder: Path, parameters: Any) -> Any:
    description = folder / "wanted.yml"
    description.write_text(yaml.safe_dump({"vlnv": "::tables:0", "parameters": parameters}))
    command = [sys.executable, str(repository.ROOT / "commands" / "hardware" / "fusesoc.py"), str(description)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_the_generator_writes_parameters_and_tables(tmp_path: Path) -> None:
    assert generated(tmp_path, {"SOLVER": "tridiagonal", "ROWS": 8, "COLS": 16}).returncode == 0
    made = yaml.safe_load((tmp_path / "tables.core").read_text().removeprefix("CAPI=2:"))
    config = Configuration(columns=16, rows=8, solver="tridiagonal")
    defaults = {name: parameter["default"] for name, parameter in made["parameters"].items()}
    # The calibration's slopes set the formats, so only what they do not touch is the default's.
    assert defaults.keys() == top_parameters(config).keys()
    assert (defaults["Rows"], defaults["Size"], defaults["Tridiagonal"]) == (8, 16, 1)
    files = {name for file in made["filesets"]["tables"]["files"] for name in file}
    assert files == {path.name for path in tmp_path.glob("*.hex")}
    assert "gradient.hex" in files


def test_the_generator_refuses_what_it_does_not_know(tmp_path: Path) -> None:
    result = generated(tmp_path, {"FRAMES": "ball"})
    assert result.returncode == 2
    assert "FRAMES: unknown variable" in result.stderr
