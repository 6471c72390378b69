# SPDX-License-Identifier: Apache-2.0
"""Wrappers with a configuration inside, and the package of default parameters."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyslang
import pytest
from PIL import Image

from commands.common import repository, wrapper
from commands.common import simulator as simulation
from tactile_depth.chip.c_header import FILE, c_header
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.hardware_files import PARAMETERS
from tactile_depth.chip.tactile_depth import default_parameters, tactile_depth, top_parameters, write_roms
from tactile_depth.pictures.reader import SYNTHETIC_GRID
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.scenes import render
from tactile_depth.sensor.synthetic import synthetic
from tb.structures import Structure
from tb.tb_two_pipelines import calibration
from tests.drawn_light import no_contact

CONFIGURATIONS: dict[str, dict[str, Any]] = {
    "left": {"columns": 16, "rows": 8, "solver": "tridiagonal", "bits_per_channel": 2},
    "right": {"columns": 16, "bits_per_channel": 3, "data_width": 20, "neumann": True},
}

SENSOR = synthetic(4).scaled(SYNTHETIC_GRID[1] / 16)  # on a grid of 16 columns


def test_the_package_has_the_default_configuration() -> None:
    assert wrapper.package() == wrapper.DEFAULTS.read_text(), "run `make registers`"


def test_a_wrapper_has_every_port_of_the_top_and_every_field() -> None:
    parameters = top_parameters(Configuration(**CONFIGURATIONS["left"]))
    text = wrapper.wrapper("left", parameters)
    outer = {port.name: port for port in wrapper.outer_ports(parameters)}
    assert {"clk", "s_axis_tdata", "m_axis_tuser", "contact", "m_event_tready", "s_axil_rready"} < outer.keys()
    assert all(f" {name}" in text and f".{name}" in text for name in outer)
    assert (outer["m_axis_tdata"].width, outer["s_axil_awaddr"].width, outer["irq"].width) == (24, 10, 1)
    assert text.count("configuration[32*") == len(parameters)
    assert all(
        f"configuration[32*{name}Field+:32] = {wrapper.literal(value)};" in text for name, value in parameters.items()
    )


@pytest.mark.parametrize("top", ["tactile_depth", "tactile_sensor"])
def test_every_port_of_a_top_is_read(top: str) -> None:
    """Compare with pyslang, which elaborates the top."""
    tree = pyslang.syntax.SyntaxTree.fromFiles([str(path) for path in repository.sources(top)])
    compilation = pyslang.ast.Compilation()
    compilation.addSyntaxTree(tree)
    (instance,) = [each for each in compilation.getRoot().topInstances if each.name == top]
    elaborated = [(port.name, port.direction.name.lower(), port.type.bitWidth) for port in instance.body.portList]
    read = wrapper.ports(top, default_parameters())
    assert [(port.name, port.direction.removesuffix("put"), port.width) for port in read] == elaborated


@pytest.mark.parametrize("simulator", [pytest.param("verilator", marks=pytest.mark.regress), "icarus"], indirect=True)
def test_two_pipelines_with_two_calibrations_in_one_simulation(
    run_tb: Callable[..., None], simulator: str, tmp_path: Path
) -> None:
    files = [repository.ROOT / "tb" / "two_pipelines.sv"]
    configs = {side: Configuration(**choices) for side, choices in CONFIGURATIONS.items()}
    for side, config in configs.items():
        files.append(wrapper.write(tmp_path, side, top_parameters(config), tables=f"{side}/"))

    def tables(folder: Path) -> None:
        for side, config in configs.items():
            (folder / side).mkdir(exist_ok=True)
            write_roms(folder / side, calibration(side, config), config)

    structure = Structure(device={"configurations": CONFIGURATIONS}, roms=tables)
    run_tb(structure, toplevel="two_pipelines", test_module="tb.tb_two_pipelines", files=files)


def test_the_command_writes_the_module_and_its_tables(run_command: Callable[..., Any], tmp_path: Path) -> None:
    choices = ("PRESET=published", "N=16", "SOLVER=tridiagonal")
    assert run_command("wrap", "NAME=finger", f"OUT={tmp_path}", "TABLES=finger/", *choices).status == 0
    text = (tmp_path / "tactile_depth_finger.sv").read_text()
    assert 'parameter TableFolder = "finger/"' in text
    assert "[32*TridiagonalField+:32] = 32'd1;" in text
    (tmp_path / "direct").mkdir()
    write_roms(tmp_path / "direct", synthetic(4), Configuration(columns=16, solver="tridiagonal"))
    written = {path.name: path.read_text() for path in tmp_path.glob("*.hex")}
    assert written == {path.name: path.read_text() for path in (tmp_path / "direct").glob("*.hex")}
    registers_of = json.loads((tmp_path / PARAMETERS).read_text())["registers"]
    assert registers_of["THRESHOLD"] > 0
    del registers_of["SLOPE_LIMIT"]  # of the calibration
    header = c_header(SENSOR, Configuration(columns=16, solver="tridiagonal"), thresholds=registers_of)
    assert (tmp_path / FILE).read_text() == header


@pytest.mark.parametrize(
    ("choices", "is_real"), [((), True), (("CALIBRATION=synthetic",), False)], ids=["real", "drawn"]
)
def test_a_reference_that_is_not_a_picture_is_warned_of(
    run_command: Callable[..., Any], tmp_path: Path, choices: tuple[str, ...], is_real: bool
) -> None:
    ended = run_command("wrap", "NAME=finger", f"OUT={tmp_path}", "N=16", *choices)
    assert ended.status == 0
    fix = "capture reference and zero offset on the device before its depth means anything"
    assert ended.errors == [f"make wrap: warning: no REFERENCE: {fix}"] * is_real


def test_the_zero_offset_is_in_its_table(run_command: Callable[..., Any], tmp_path: Path) -> None:
    choices = ("PRESET=published", "N=16", "SOLVER=tridiagonal", "ZERO=ball")
    assert run_command("wrap", "NAME=finger", f"OUT={tmp_path}", *choices).status == 0
    (tmp_path / "direct").mkdir()
    config = Configuration(columns=16, solver="tridiagonal", zero_offset=True)
    at_rest = tactile_depth(render("ball", 16).frames, synthetic(), replace(config, zero_offset=False))
    zero = captured_zero(at_rest, config)
    assert np.abs(zero).max() > 0
    write_roms(tmp_path / "direct", synthetic(4), config, zero)
    assert (tmp_path / "zero_0.hex").read_text() == (tmp_path / "direct" / "zero_0.hex").read_text()
    registers_of = json.loads((tmp_path / PARAMETERS).read_text())["registers"]
    del registers_of["SLOPE_LIMIT"]
    assert (tmp_path / FILE).read_text() == c_header(SENSOR, config, zero, thresholds=registers_of)


@pytest.mark.parametrize("form", [("CAMERA=raw10_lsb", "BAYER=grbg"), ("CAMERA=yuyv_bytes",)], ids=lambda form: form[0])
def test_with_a_camera_the_module_is_a_tactile_sensor(
    run_command: Callable[..., Any], tmp_path: Path, form: tuple[str, ...]
) -> None:
    """Elaborate the module in Icarus, which refuses an unknown port or parameter."""
    choices = ("PRESET=published", "N=64", "SOLVER=tridiagonal", *form)
    assert run_command("wrap", "NAME=finger", f"OUT={tmp_path}", *choices).status == 0
    path = tmp_path / "tactile_sensor_finger.sv"
    assert "frames_lost" in path.read_text()
    assert "#define TACTILE_DEPTH_CAMERA_WINDOW_SIZE 0x" in (tmp_path / FILE).read_text()
    assert [file.name for file in tmp_path.glob("*.xml")] == ["tactile_sensor_finger.xml"]
    files, build = [*repository.sources(), path], tmp_path / "build"
    build.mkdir()
    simulation.build("icarus", "tactile_sensor_finger", files, {}, build, log=build / "build.log")


def test_a_reference_is_a_picture_of_the_camera(run_command: Callable[..., Any], tmp_path: Path) -> None:
    """The window shows what the calibration's pictures show, as without a reference."""
    full = Image.fromarray(no_contact(load("gelsight-mini"))).resize((640, 480))
    full.save(tmp_path / "background.png")
    shown = []
    for reference in (tmp_path / "background.png", "flat"):
        choices = ("NAME=finger", f"OUT={tmp_path / 'finger'}", "CAMERA=raw8", f"REFERENCE={reference}")
        output = run_command("wrap", *choices, "CALIBRATION=gelsight-mini").output
        shown += re.findall("pictures of 640 x 480 from the camera, (WINDOW=91,.*)", output)
    assert len(shown) == 2
    assert shown[0] == shown[1]


def test_a_folder_holds_one_module(
    run_command: Callable[..., Any], refused: Callable[..., str], tmp_path: Path
) -> None:
    common = (f"OUT={tmp_path}", "PRESET=published", "N=16")
    assert run_command("wrap", "NAME=left", *common).status == 0
    assert "the tables there are those of tactile_depth_left.sv" in refused("wrap", "NAME=right", *common)
    assert run_command("wrap", "NAME=left", *common).status == 0


def test_what_an_earlier_run_for_the_name_has_left_goes(run_command: Callable[..., Any], tmp_path: Path) -> None:
    common = ("NAME=finger", f"OUT={tmp_path}", "PRESET=published", "N=16")
    assert run_command("wrap", *common, "SHELL=verilog").status == 0
    (tmp_path / "notes.xml").write_text("mine")
    assert run_command("wrap", *common, "SOLVER=tridiagonal", "CAMERA=raw8", "CALIBRATION=synthetic").status == 0
    left = {path.name for path in tmp_path.iterdir() if path.suffix in (".v", ".sv", ".xml")}
    assert left == {"tactile_sensor_finger.sv", "tactile_sensor_finger.xml", "notes.xml"}
    assert not (tmp_path / "reciprocal.hex").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "NAME=: accepted are small letters, digits and _, beginning with a letter, as NAME=finger"),
        (("NAME=Finger",), "NAME=Finger: accepted are small letters"),
        (("NAME=finger", "TABLES=finger"), "with / between names and at its end"),
        (("NAME=finger", "TABLES=new\\tables/"), "with / between names and at its end"),
        (("NAME=finger", "LANES=2", "SOLVER=spectral"), "LANES"),
        (("NAME=finger", "SHELL=vhdl"), "SHELL=vhdl is unknown: accepted is verilog"),
        (("NAME=finger", "CAMERA=raw9"), "CAMERA=raw9 is unknown: accepted are"),
    ],
)
def test_bad_input_ends_with_one_line(refused: Callable[..., str], arguments: tuple[str, ...], message: str) -> None:
    assert message in refused("wrap", *arguments)
