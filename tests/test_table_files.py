# SPDX-License-Identifier: Apache-2.0
"""Table files that are missing, foreign or damaged end a simulation at time 0, and it names the file."""

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import repository, simulator, wrapper
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.rom_files import CRCS, table_files
from tactile_depth.chip.tactile_depth import top_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic_for

CONFIG = Configuration(columns=16, rows=8, solver="tridiagonal", flat_field=True, gradient_model="cubic")
FOLDER = "finger"
TIME_0 = '#include "Vtop.h"\nint main() { Vtop top; top.eval(); }\n'


@dataclass(frozen=True)
class Built:
    """A module as `make wrap` writes it, built as a stranger does: without the macros of this repository."""

    command: tuple[str, ...]
    tables: Path


@pytest.fixture(scope="module", params=simulator.SIMULATORS)
def built(request: Any, tmp_path_factory: pytest.TempPathFactory) -> Built:
    name, folder = request.param, tmp_path_factory.mktemp(request.param)
    tables = folder / FOLDER
    crc = write_roms(tables, synthetic_for(CONFIG), CONFIG)
    module = wrapper.write(folder, "finger", top_parameters(CONFIG, tables_crc=crc), f"{FOLDER}/")
    program = folder / "time_0.cpp"
    program.write_text(TIME_0)
    files, out = [*repository.sources(), module], folder / "build"
    simulator.build(name, module.stem, files, {}, out, program=program, checked=False, log=folder / "build.log")
    command = (str(out / module.stem),) if name == "verilator" else ("vvp", "-n", str(out / "sim.vvp"))
    return Built(command, tables)


def complaints(built: Built, folder: Path) -> list[str]:
    """Run a simulation in a folder, and return what it says is wrong with a file; without a word it runs on."""
    ended = subprocess.run(built.command, cwd=folder, capture_output=True, text=True, check=False)
    output = ended.stdout + ended.stderr
    found = [line for line in output.splitlines() if f"{FOLDER}/" in line and "atal" in line.lower()]
    assert bool(found) == bool(ended.returncode), output
    return found


def copied(built: Built, folder: Path) -> Path:
    shutil.copytree(built.tables, folder / FOLDER)
    return folder / FOLDER


def test_the_right_tables_run(built: Built, tmp_path: Path) -> None:
    tables = copied(built, tmp_path)
    assert complaints(built, tmp_path) == []
    for path in tables.iterdir():
        path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    assert complaints(built, tmp_path) == []


def test_a_wrong_folder_is_named(built: Built, tmp_path: Path) -> None:
    [line] = complaints(built, tmp_path)
    assert "TableFolder, which is seen from the folder in which" in line


def flipped(path: Path) -> None:
    """Flip one bit of a word in the middle of a table."""
    lines = path.read_text().splitlines()
    place = len(lines) // 2
    lines[place] = f"{int(lines[place], 16) ^ 1:0{len(lines[place])}x}"
    path.write_text("\n".join([*lines, ""]))


@pytest.mark.parametrize(("damage", "said"), [(Path.unlink, "no such file"), (flipped, "changed since it was written")])
def test_each_file_that_is_missing_or_damaged_is_named(
    built: Built, tmp_path: Path, damage: Callable[[Path], None], said: str
) -> None:
    names = [name for name in table_files(built.tables) if damage is Path.unlink or name != CRCS]
    assert {"down.hex", "gain_0.hex", "polynomial_5.hex", "twiddle_forward_0.hex"} <= {*names}
    for name in names:
        tables = copied(built, tmp_path)
        damage(tables / name)
        [line] = complaints(built, tmp_path)
        assert f"{FOLDER}/{name}: {said}" in line
        shutil.rmtree(tables)


def test_tables_of_another_calibration_are_refused(built: Built, tmp_path: Path) -> None:
    gains = np.full((*CONFIG.reference_nodes, 3), 1 << CONFIG.gain.width - 2)
    write_roms(tmp_path / FOLDER, synthetic_for(CONFIG), CONFIG, gains=gains)
    [line] = complaints(built, tmp_path)
    assert f"{FOLDER}/{CRCS}: the tables are not those of Config" in line
