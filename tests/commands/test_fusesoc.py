# SPDX-License-Identifier: Apache-2.0
"""tactile_depth.core: its list of files is hdl/, and its generator writes a module and its tables."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from cocotb_tools.check_results import get_results
from cocotb_tools.config import pygpi_entry_point
from find_libpython import find_libpython
from PIL import Image

import tactile_depth as td
from commands.common import repository, simulator
from tactile_depth.chip.rom_files import table_files
from tb.settings import RunSettings

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


def test_the_target_sim_has_every_testbench_of_the_whole(core: Any) -> None:
    modules = core["targets"]["sim"]["flow_options"]["cocotb_module"]
    assert modules == f"tb.exit_status,{repository.testbench('tactile_depth')}"


def test_part_is_that_of_the_vivado_script(core: Any) -> None:
    script = (repository.ROOT / "constraints" / "xczu7ev_ooc.tcl").read_text()
    assert re.search(r"^set part (\S+)$", script, re.M)[1] == core["targets"]["synth"]["flow_options"]["part"]  # type: ignore[index]


def generated(folder: Path, parameters: Any, core_folder: Path | str = "") -> Any:
    description = folder / "wanted.yml"
    wanted = {"vlnv": "::tables:0", "parameters": parameters, "files_root": str(core_folder)}
    description.write_text(yaml.safe_dump(wanted))
    command = [sys.executable, str(repository.ROOT / "commands" / "hardware" / "fusesoc.py"), str(description)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_the_generator_without_its_libraries_says_what_to_do(tmp_path: Path) -> None:
    command = [sys.executable, "-S", str(repository.ROOT / "commands" / "hardware" / "fusesoc.py"), "wanted.yml"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr.count("\n")) == (1, 1)
    assert "run `make setup`" in ended.stderr


def test_the_generator_needs_the_package_and_yaml_alone(tmp_path: Path) -> None:
    (tmp_path / "wanted.yml").write_text(yaml.safe_dump({"vlnv": "::tables:0", "parameters": {"NAME": "a", "N": 16}}))
    absent = dict.fromkeys(("cocotb", "cocotb_tools", "find_libpython", "psutil", "pytest", "numba"))
    generator = "commands.hardware.fusesoc"
    code = f"import sys, runpy; sys.modules.update({absent}); runpy.run_module({generator!r}, run_name='__main__')"
    places = os.pathsep.join(map(str, (repository.ROOT, repository.ROOT / "models")))
    command, environment = [sys.executable, "-c", code, "wanted.yml"], os.environ | {"PYTHONPATH": places}
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    text = "no REFERENCE: capture reference and zero offset on the device before its depth means anything"
    assert (ended.returncode, ended.stderr) == (0, f"tables of tactile_depth: warning: {text}\n")
    assert ended.stdout.startswith("preset chip: ")


def test_the_generator_writes_a_module_and_its_tables(tmp_path: Path) -> None:
    assert (
        generated(
            tmp_path, {"NAME": "finger", "PRESET": "published", "SOLVER": "tridiagonal", "ROWS": 8, "COLS": 16}
        ).returncode
        == 0
    )
    made = yaml.safe_load((tmp_path / "tables.core").read_text().removeprefix("CAPI=2:"))
    assert made["filesets"]["module"]["files"] == ["tactile_depth_finger.sv"]
    files = {name: place["copyto"] for file in made["filesets"]["tables"]["files"] for name, place in file.items()}
    assert files.keys() == {*table_files(tmp_path)}
    assert files["gradient.hex"] == "finger/gradient.hex"
    module = (tmp_path / "tactile_depth_finger.sv").read_text()
    assert 'TableFolder = "finger/"' in module
    for field, number in {"Rows": 8, "Columns": 16, "Tridiagonal": 1}.items():
        assert f"configuration[32*{field}Field+:32] = 32'd{number};" in module


def test_the_target_sim_has_the_status_of_its_tests(tmp_path: Path) -> None:
    """Simulate as docs/integrate.md shows, then with settings that are not the module's, without a test, and so on."""
    binary = Path(sys.executable).parent / "fusesoc"
    if not binary.exists():
        pytest.skip("fusesoc is not installed: pip install -r requirements-hardware.txt")
    simulator.check("icarus")
    path = os.pathsep.join(map(str, (repository.ROOT, repository.ROOT / "models")))
    users = f"{find_libpython()};{pygpi_entry_point()}"
    environment = os.environ | {"PATH": f"{binary.parent}:{os.environ['PATH']}", "COCOTB_RANDOM_SEED": "1"}
    command = [str(binary), "--cores-root", str(repository.ROOT), "run", "--target", "sim", "tactile_depth"]

    def ended(rows: int = 8, **more: str) -> str:
        """Return the last line of stderr before those of make; only with none the status is 0."""
        choices = {"columns": 16, "rows": rows, "solver": "tridiagonal"}
        own = {"GPI_USERS": users, "PYTHONPATH": path} | more
        settings = RunSettings(level="first", device={"configuration": choices}).environment
        result = subprocess.run(
            command, cwd=tmp_path, env=environment | settings | own, capture_output=True, text=True, check=False
        )
        lines = [line for line in result.stderr.splitlines() if not line.startswith(("make", "ERROR", "INFO"))]
        assert bool(result.returncode) == bool(lines), result.stdout + result.stderr
        return lines[-1] if lines else ""

    assert ended() == ""
    (results,) = tmp_path.rglob("results.xml")
    assert get_results(results) == (2, 0)
    assert ended(rows=16) == "2 of 2 tests failed"
    assert ended(COCOTB_TEST_FILTER="absent") == "no test ran"
    assert "No module named 'tb'" in ended(PYTHONPATH="")
    assert ended(GPI_USERS="").startswith("GPI_USERS is not set")


def test_the_generator_refuses_what_it_does_not_know(tmp_path: Path) -> None:
    result = generated(tmp_path, {"NAME": "finger", "FRAMES": "ball"})
    assert result.returncode == 2
    assert "FRAMES: unknown variable" in result.stderr
    result = generated(tmp_path, {"N": 16})
    assert result.returncode == 2
    assert "NAME=: accepted are small letters" in result.stderr
    result = generated(tmp_path, {"NAME": "finger", "ZERO": None})
    assert "ZERO: it has no value: omit it" in result.stderr


def test_paths_count_from_the_folder_of_the_core(tmp_path: Path) -> None:
    sample = td.sample("ball")
    (tmp_path / "core").mkdir()
    Image.fromarray(sample.reference).save(tmp_path / "core" / "background.png")
    words = {"NAME": "finger", "ROWS": 24, "COLS": 32, "CALIBRATION": "synthetic", "REFERENCE": "background.png"}
    result = generated(tmp_path, words, tmp_path / "core")
    path = tmp_path / "core" / "background.png"
    assert f"REFERENCE={path} ZERO={path}" in result.stdout, result.stderr


def test_a_configuration_counts_from_the_folder_of_the_core_too(tmp_path: Path) -> None:
    (tmp_path / "core").mkdir()
    (tmp_path / "core" / "mine.json").write_text('{"PRESET": "published", "N": 16}')
    result = generated(tmp_path, {"NAME": "finger", "CONFIG": "mine.json"}, tmp_path / "core")
    assert "16 x 16" in result.stdout, result.stderr
    result = generated(tmp_path, {"NAME": "finger", "CONFIG": "other.json"}, tmp_path / "core")
    text = f"CONFIG=other.json: there is no such file: relative paths count from {tmp_path / 'core'}"
    assert (result.returncode, result.stderr) == (2, f"tables of tactile_depth: {text}\n")
