# SPDX-License-Identifier: Apache-2.0
"""IP-XACT components (IEEE 1685-2014) of a module: bus interfaces, registers, ports and files."""

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from commands.common.wrapper import Port

NAMESPACE = "http://www.accellera.org/XMLSchema/IPXACT/1685-2014"
SCHEMA = "http://www.w3.org/2001/XMLSchema-instance"
# Bus and abstraction in the library AMBA4 of amba.com, by the end of an interface's name.
STREAM, LITE = ("AXI4Stream", "r0p0_1"), ("AXI4-Lite", "r0p0_0")
BUSES = {"axis": STREAM, "event": STREAM, "axil": LITE}
KINDS = {".sv": "systemVerilogSource", ".v": "verilogSource", ".h": "cSource", ".hex": "user", ".crc": "user"}
REGISTERS = "registers"  # name of the memory map
VIEW = "rtl"
SOFTWARE = "software"  # set of files that no tool of hardware reads
CLOCK, RESET = "clk", "rst"


@dataclass(frozen=True)
class Module:
    """A module that a component describes.

    Attributes
    ----------
    name : str
    language : str
        `systemverilog` or `verilog`.
    ports : of the module
    maps : elements
        Components of its register maps, which `write` takes apart (`registers.components`).
    sets : mapping
        Files in the order in which tools read them, by the name of the set.
    tables : str
        Default of its parameter TableFolder.
    """

    name: str
    language: str
    ports: Sequence[Port]
    maps: Sequence[Element]
    sets: Mapping[str, Sequence[Path]]
    tables: str = "./"


def tag(name: str) -> str:
    """Return the qualified name of an element or an attribute."""
    return f"{{{NAMESPACE}}}{name}"


def element(kind: str, /, *inside: Element | str | int, **attributes: str) -> Element:
    """Return an element with a text or elements inside."""
    made = Element(tag(kind), attributes)
    for each in inside:
        if isinstance(each, Element):
            made.append(each)
        else:
            made.text = str(each)
    return made


def write(module: Module, path: Path, place: Path | None = None) -> Path:
    """Write the component of a module, and return its path.

    Parameters
    ----------
    place : folder from which its files are named, by default that of the path
    """
    for prefix, uri in (("ipxact", NAMESPACE), ("xsi", SCHEMA)):
        ElementTree.register_namespace(prefix, uri)
    component = module.maps[0]
    _inside(component, "name").text = module.name
    blocks = [_placed(_inside(root, "memoryMaps/memoryMap/addressBlock")) for root in module.maps]
    component.remove(_inside(component, "memoryMaps"))
    grouped: dict[str, list[Port]] = {}
    for port in module.ports:
        if port.interface:
            grouped.setdefault(port.interface, []).append(port)
    folder = place or path.parent
    component.extend(
        (
            element("busInterfaces", *(_interface(*each) for each in grouped.items())),
            element("memoryMaps", element("memoryMap", element("name", REGISTERS), *blocks)),
            _model(module),
            element("fileSets", *(_file_set(name, paths, folder) for name, paths in module.sets.items())),
            element("parameters", _table_folder("parameter", f'"{module.tables}"', parameterId="TableFolder")),
        )
    )
    ElementTree.indent(component)
    text = ElementTree.tostring(component, encoding="unicode")
    notice = "<!-- SPDX-License-Identifier: Apache-2.0 -->\n<!-- Generated: do not edit. -->"
    path.write_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{notice}\n{text}\n')
    return path


def _inside(root: Element, path: str) -> Element:
    """Return the first element of a path of names."""
    found = root.find("/".join(map(tag, path.split("/"))))
    assert found is not None
    return found


def _number(text: str | None) -> int:
    """Return a number as the exporter writes it, 'h100."""
    return int((text or "").removeprefix("'h"), 16)


def _placed(block: Element) -> Element:
    """Return a block of registers that begins at its first register."""
    base, size = _inside(block, "baseAddress"), _inside(block, "range")
    offsets = [_inside(register, "addressOffset") for register in block.iter(tag("register"))]
    first = min(_number(offset.text) for offset in offsets)
    base.text, size.text = f"'h{_number(base.text) + first:x}", f"'h{_number(size.text) - first:x}"
    for offset in offsets:
        offset.text = f"'h{_number(offset.text) - first:x}"
    return block


def _interface(name: str, ports: Sequence[Port]) -> Element:
    """Return a bus interface; the clock is a part of each."""
    bus, version = BUSES[name.partition("_")[2]]
    library = {"vendor": "amba.com", "library": "AMBA4", "version": version}
    wires = {"ACLK": CLOCK} | {port.name.removeprefix(f"{name}_").upper(): port.name for port in ports}
    maps = [
        element(
            "portMap",
            element("logicalPort", element("name", logical)),
            element("physicalPort", element("name", physical)),
        )
        for logical, physical in wires.items()
    ]
    abstraction = element("abstractionRef", **library, name=f"{bus}_rtl")
    return element(
        "busInterface",
        element("name", name),
        element("busType", **library, name=bus),
        element("abstractionTypes", element("abstractionType", abstraction, element("portMaps", *maps))),
        element("master") if name.startswith("m_") else _slave(bus),
    )


def _slave(bus: str) -> Element:
    return element("slave", *([element("memoryMapRef", memoryMapRef=REGISTERS)] if bus == LITE[0] else []))


def _model(module: Module) -> Element:
    """Return the view of the module, what it instantiates, and its ports."""
    sets = [element("fileSetRef", element("localName", name)) for name in module.sets if name != SOFTWARE]
    instance = element(
        "componentInstantiation",
        element("name", VIEW),
        element("language", module.language),
        element("moduleName", module.name),
        element("moduleParameters", _table_folder("moduleParameter", "TableFolder", dataType="string")),
        *sets,
    )
    view = element("view", element("name", VIEW), element("componentInstantiationRef", VIEW))
    ports = element("ports", *map(_port, module.ports))
    return element("model", element("views", view), element("instantiations", instance), ports)


def _table_folder(kind: str, value: str, **attributes: str) -> Element:
    about = "Folder of the table files, with a / at its end"
    named = (element("name", "TableFolder"), element("description", about), element("value", value))
    return element(kind, *named, **attributes)


def _port(port: Port) -> Element:
    """Return a port; an input of no interface but clock and reset is 0 where nothing drives it."""
    wire = [element("direction", port.direction.removesuffix("put"))]
    if port.width > 1:
        bits = element("vector", element("left", port.width - 1), element("right", 0))
        wire.append(element("vectors", bits))
    if port.direction == "input" and not port.interface and port.name not in (CLOCK, RESET):
        wire.append(element("drivers", element("driver", element("defaultValue", 0))))
    about = [element("description", port.note)] if port.note else []
    return element("port", element("name", port.name), *about, element("wire", *wire))


def _file_set(name: str, paths: Iterable[Path], place: Path) -> Element:
    """Return a set of files, named from a folder."""
    listed = []
    for path in paths:
        kind = KINDS[path.suffix]
        of_kind = element("fileType", kind, **({"user": "readmemh"} if kind == "user" else {}))
        included = [element("isIncludeFile", "true")] if path.suffix == ".h" else []
        listed.append(element("file", element("name", os.path.relpath(path, place)), of_kind, *included))
    return element("fileSet", element("name", name), *listed)
