# SPDX-License-Identifier: Apache-2.0
"""`make registers`: writes all files that the maps in registers/ describe, and every list of the files in hdl/.

There are two maps: tactile_depth.rdl of the pipeline, and camera.rdl of the camera front end. Three files of each are
committed, so that nobody needs these tools to use them: the page by peakrdl-markdown, a package of SystemVerilog,
because no exporter writes one that Icarus 11 reads, and the JSON that register_map.py reads, because a run then needs
no compiler of 40 MB. The C header by peakrdl-cheader, the IP-XACT components of both tops (ip_xact.py) and the Python
access layer of peakrdl-python go to build/: they have thousands of lines.

The files of hdl/ are listed for FuseSoC, and in the README of each folder with the first sentence of their headers.
"""

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap as wrapped
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from peakrdl_cheader.c_standards import CStandard
from peakrdl_cheader.exporter import CHeaderExporter
from peakrdl_ipxact import IPXACTExporter
from peakrdl_markdown import MarkdownExporter
from peakrdl_python.exporter import PythonExporter
from systemrdl.compiler import RDLCompiler
from systemrdl.node import AddrmapNode, FieldNode, RegNode

from commands.common import wrapper
from commands.common.header import sentence
from commands.common.repository import GENERATED, HDL, ROOT, sources, testbench
from commands.common.tabular import Table, records
from commands.hardware.ip_xact import Module, write
from tactile_depth.base import files
from tactile_depth.chip.camera.pixel_format import chroma_codes
from tactile_depth.chip.camera_configuration import FORMATS
from tactile_depth.chip.registers.register_map import Field, Register
from tactile_depth.chip.tactile_depth import default_parameters

FUSESOC = ROOT / "tactile_depth.core"
VENDOR = "tactile-depth"  # of the IP-XACT components
CORES = re.compile(r"(?<=<!-- cores: by make registers -->\n).*(?=\n<!-- end of cores -->)", re.DOTALL)
BUILT = ROOT / "build" / "registers"
LAYER_NAME = "tactile_depth_registers"  # `tactile_depth` is the package of models


@dataclass(frozen=True)
class Map:
    """A map of registers."""

    name: str  # of the .rdl file and of the C header
    package: Path  # of SystemVerilog
    data: str  # file name of the JSON
    page: str  # file name of the page
    title: str  # what the registers are
    prefix: str = ""  # of names in the package that do not come from a register

    @property
    def source(self) -> Path:
        return ROOT / "registers" / f"{self.name}.rdl"

    @property
    def written_by(self) -> str:
        return f"Written by `make registers` from {self.source.relative_to(ROOT)}: change it there."


PIPELINE = Map(
    "tactile_depth",
    HDL / "registers" / "td_register_map_pkg.sv",
    "register_map.json",
    "registers.md",
    "the AXI4-Lite registers",
)
CAMERA = Map(
    "camera",
    HDL / "camera" / "td_camera_map_pkg.sv",
    "camera_map.json",
    "camera-registers.md",
    "the AXI4-Lite registers of the camera front end",
    "camera",
)
MAPS = (PIPELINE, CAMERA)


def compiled(source: Path = PIPELINE.source, inst_name: str | None = None) -> AddrmapNode:
    """Return the elaborated map, under its own name or under `inst_name`."""
    compiler = RDLCompiler()
    compiler.compile_file(str(source))
    return compiler.elaborate(inst_name=inst_name).top


def access(field: FieldNode) -> str:
    """Return the access of a field, one of tactile_depth.chip.registers.register_map.ACCESSES.

    Raises ValueError: no register of this design has such an access.
    """
    onwrite, onread = field.get_property("onwrite"), field.get_property("onread")
    properties = (
        field.get_property("sw").name,
        onwrite.name if onwrite else "",
        onread.name if onread else "",
        field.get_property("singlepulse"),
    )
    accesses = {
        ("r", "", "", False): "ro",
        ("rw", "", "", False): "rw",
        ("rw", "woclr", "", False): "w1c",
        ("rw", "woset", "", False): "w1s",
        ("w", "", "", True): "pulse",
        ("rw", "wuser", "ruser", False): "port",
    }
    if properties not in accesses:
        raise ValueError(f"{field.get_path()}: no register has sw, onwrite, onread, singlepulse = {properties}")
    return accesses[properties]


def is_setting(field: FieldNode) -> bool:
    """Return True for a field that software alone writes, and that holds what was written."""
    return access(field) == "rw" and not field.is_hw_writable


def field_of(node: FieldNode) -> Field:
    """Return a field of a register."""
    encode = node.get_property("encode")
    return Field(
        node.inst_name,
        node.low,
        node.high,
        access(node),
        node.get_property("reset"),
        node.get_property("is_signed", default=False),
        is_setting(node),
        {member.name: member.value for member in encode} if encode else {},
    )


def register_of(node: RegNode) -> Register:
    """Return a register."""
    return Register(node.inst_name, node.absolute_address, tuple(map(field_of, node.fields())))


def stated(each: Register | Field) -> dict[str, Any]:
    """Return a register or a field as the JSON states it, without what has its default."""
    default = vars(Field("", 0, 0, ""))
    values = {name: [*map(stated, value)] if name == "fields" else value for name, value in vars(each).items()}
    return {name: value for name, value in values.items() if name in ("low", "high") or value != default.get(name)}


def camel(name: str) -> str:
    """Return a name with underscores in UpperCamelCase."""
    return "".join(word.capitalize() for word in name.split("_"))


def package(of: Map, registers: list[Register], elsewhere: Collection[str]) -> str:
    """Return the text of the SystemVerilog package of a map; bits of registers made `elsewhere` have no names."""
    prefix = camel(of.prefix)
    offsets, resets, bits, values = [], [], [], []
    for register in registers:
        name = camel(register.name)
        offsets.append(f"localparam int {name}Offset = 32'h{register.offset:03x};")
        if reset := reset_of(register.fields):
            resets.append(f"localparam int {name}Reset = 32'h{reset:08x};")
        for field in () if register.name in elsewhere else register.fields:
            if field.name == "value":  # the register is this number
                continue
            single, whole = field.low == field.high, name + camel(field.name)
            bits.append(f"localparam int {whole}{'Bit' if single else 'Lsb'} = {field.low};")
            if field.values and not single:
                bits.append(f"localparam int {whole}Width = {field.width};")
                values.append(f"localparam int {whole}Count = {len(field.values)};")
            values += [f"localparam int {name}{camel(value)} = {code};" for value, code in field.values.items()]
    settings = [register for register in registers if any(field.setting for field in register.fields)]
    writable = [register for register in registers if register.writable]
    record = [register for register in registers if register.name.startswith("RECORD_")]
    sections = {
        "Byte offsets.": [f"localparam int {prefix}AddressWidth = {address_width(registers)};", *offsets],
        "Words of a record of contact, and their offsets, the first in the lowest bits.": record_words(record),
        "Values after reset that are not zero.": resets,
        "Bits: number of a flag, lowest of a wider field.": bits,
        "Values of a field.": values,
        "Registers that software alone writes, by number, in words of 32 bits, the lowest first.": settings_of(
            prefix, settings
        ),
        "Offsets that can be read, and those that can be written.": [
            *predicate("_".join(filter(None, ("is", of.prefix, "register"))), registers),
            *predicate("_".join(filter(None, ("is", of.prefix, "writable"))), writable),
        ],
    }
    if of is CAMERA:
        sections["Of a pixel format: bits of a sample, words of a pixel, 1 for a Bayer pattern, 1 for YUYV."] = [
            line
            for name, attribute in (("bits", "bits"), ("words", "words"), ("is_bayer", "bayer"), ("is_yuyv", "is_yuyv"))
            for line in of_format(f"format_{name}", attribute)
        ]
        sections["Coefficients of BT.601, full range, in units of 2^-12."] = [
            f"localparam int {name} = {code};" for name, code in chroma_codes().items()
        ]
    parts = [(f"// {title}", *lines) for title, lines in sections.items() if lines]
    body = "\n\n".join("\n".join(f"  {line}" for line in part) for part in parts)
    return (
        "// SPDX-License-Identifier: Apache-2.0\n"
        f"// {of.package.stem}: offsets, reset values and bits of {of.title}.\n"
        "//\n"
        f"// {of.written_by}\n\n"
        "`default_nettype none\n\n"
        f"package {of.package.stem};\n\n{body}\n\nendpackage\n\n"
        "`default_nettype wire\n"
    )


def reset_of(fields: Iterable[Field]) -> int:
    """Return the word that fields of a register hold after reset."""
    return sum((field.reset or 0) << field.low for field in fields)


def record_words(registers: list[Register]) -> list[str]:
    """Return the declarations of the number of words of a record and of the offset of each, none without a record."""
    if not registers:
        return []
    listed = ", ".join(f"{camel(register.name)}Offset" for register in reversed(registers))
    lines = [f"localparam int RecordWords = {len(registers)};"]
    return [*lines, "localparam logic [32*RecordWords-1:0] RecordOffsets = {", *indented(listed), "};"]


def indented(listed: str) -> list[str]:
    """Return the lines of a list, indented."""
    return [f"  {line}" for line in wrapped(listed, 112)]


def settings_of(prefix: str, registers: list[Register]) -> list[str]:
    """Return the declarations of number, offset, bits and reset value of each register with settings."""
    words: dict[str, list[str]] = {"Offsets": [], "Masks": [], "Resets": []}
    for register in registers:
        fields = [field for field in register.fields if field.setting]
        mask = sum(field.mask for field in fields)
        words["Offsets"].append(f"{camel(register.name)}Offset")
        words["Masks"].append(f"32'h{mask:08x}")
        words["Resets"].append(f"32'h{reset_of(fields):08x}")
    lines = [f"localparam int {prefix}Settings = {len(registers)};"]
    lines += [f"localparam int {camel(register.name)}Setting = {n};" for n, register in enumerate(registers)]
    for name, values in words.items():
        listed = ", ".join(reversed(values))
        lines.append(f"localparam logic [32*{prefix}Settings-1:0] {prefix}Setting{name} = {{")
        lines += [*indented(listed), "};"]
    return lines


def predicate(name: str, registers: list[Register]) -> list[str]:
    """Return a function that is high for the offsets of some registers."""
    listed = ", ".join(f"{camel(register.name)}Offset" for register in registers)
    *lines, last = (f"  {line}" for line in wrapped(listed, 90))
    return [
        f"function automatic logic {name}(input logic [31:0] offset);",
        "  case (offset)",
        *(f"  {line}" for line in lines),
        f"  {last}: {name} = 1'b1;",
        f"    default: {name} = 1'b0;",
        "  endcase",
        "endfunction",
    ]


def of_format(name: str, attribute: str) -> list[str]:
    """Return a function that states an attribute of a pixel format; another number counts as the first format."""
    by_value: dict[int, list[str]] = {}
    for form in FORMATS.values():
        by_value.setdefault(int(getattr(form, attribute)), []).append(f"CameraFormat{camel(form.name)}")
    default = next(iter(by_value))
    return [
        f"function automatic int {name}(input int pixel_format);",
        "  case (pixel_format)",
        *(
            f"    {line}"
            for value, forms in by_value.items()
            if value != default
            for line in wrapped(f"{', '.join(forms)}: {name} = {value};", 100)
        ),
        f"    default: {name} = {default};",
        "  endcase",
        "endfunction",
    ]


def address_width(registers: list[Register]) -> int:
    """Return the bits of a byte address: 10, enough for 256 registers, or more for a larger map."""
    return max(10, max(register.offset for register in registers).bit_length())


def fusesoc_core() -> str:
    """Return the text of tactile_depth.core with every file of hdl/, packages first, and testbench of the whole."""
    files = "".join(f"      - {path.relative_to(ROOT)}\n" for path in sources())
    text = re.sub(r"(?<=  rtl:\n    files:\n)( {6}- .*\n)+", files, FUSESOC.read_text())
    return re.sub(r"(?<=cocotb_module: tb.exit_status,).*", testbench("tactile_depth"), text)


def readme(page: Path) -> str:
    """Return the README of a folder of hdl/ with a row for each file of SystemVerilog beside it."""
    rows = [(f"[{file.stem}]({file.name})", sentence(file)) for file in sorted(page.parent.glob("*.sv"))]
    table = Table(("core", "what it does"), rows).markdown()
    return CORES.sub(lambda _: f"\n{table}", page.read_text())


def c_header(of: Map, folder: Path) -> Path:
    """Write the C header of a map into a folder."""
    path = folder / f"{of.name}.h"
    # Names by position, not by type: a type that is used twice would get a hash for its name.
    CHeaderExporter().export(compiled(of.source), str(path), reuse_typedefs=False, std=CStandard.gnu11)
    path.write_text(f"// SPDX-License-Identifier: Apache-2.0\n// {of.written_by}\n{path.read_text()}")
    return path


def ip_xact(of: Map, folder: Path) -> Path:
    """Write the registers of a map into a folder, as an IP-XACT component without ports or files."""
    identity = re.search(r"^name: .*:(\w+):([\w.]+)$", FUSESOC.read_text(), re.MULTILINE)
    assert identity is not None
    name, version = identity.groups()
    path = folder / f"{of.name}.xml"
    IPXACTExporter(vendor=VENDOR, library=name, version=version).export(compiled(of.source), str(path))
    declaration, _, body = path.read_text().partition("\n")
    notice = f"<!-- SPDX-License-Identifier: Apache-2.0 -->\n<!-- {of.written_by} -->"
    path.write_text(f"{declaration}\n{notice}\n{body}")
    return path


def components(camera: bool) -> list[Element]:
    """Return the IP-XACT components of the register maps of a top, with those of the camera or without."""
    with files.temporary() as folder:
        return [ElementTree.parse(ip_xact(of, folder)).getroot() for of in (MAPS if camera else (PIPELINE,))]


def tops(folder: Path) -> list[Path]:
    """Write the IP-XACT components of both tops, with their default configurations, and return the paths."""
    written = []
    for camera, top in enumerate(("tactile_depth", "tactile_sensor")):
        ports, maps = wrapper.ports(top, default_parameters()), components(bool(camera))
        module = Module(top, "systemverilog", ports, maps, {"rtl": sources(top)})
        written.append(write(module, folder / f"{top}.xml"))
    return written


def generated(of: Map) -> dict[Path, str]:
    """Return the text of each committed file that is written from a map."""
    top = compiled(of.source)
    nodes = [*top.registers(unroll=True)]
    registers = [*map(register_of, nodes)]
    elsewhere = {node.inst_name for node in nodes if node.get_property("made_elsewhere", default=False)}
    described = {"written_by": of.written_by, "address_width": address_width(registers)}
    described["registers"] = [*map(stated, registers)]
    with files.temporary() as folder:
        page = folder / of.page
        MarkdownExporter().export(top, str(page), input_files=[str(of.source.relative_to(ROOT))])
        text = re.sub(r"- Base Offset: \w+\n- Size: 0x4\n", "", page.read_text())  # of each register: the same again
        return {
            GENERATED / of.page: f"<!-- SPDX-License-Identifier: Apache-2.0 -->\n{text}",
            ROOT / "models" / "tactile_depth" / "chip" / "registers" / of.data: records(described) + "\n",
            of.package: package(of, registers, elsewhere),
        }


def written() -> dict[Path, str]:
    """Return the text of each committed file that is written from the maps, the configuration, or what is in hdl/."""
    texts = {path: text for of in MAPS for path, text in generated(of).items()}
    readmes = {page: readme(page) for page in HDL.rglob("README.md")}
    return texts | readmes | {wrapper.DEFAULTS: wrapper.package(), FUSESOC: fusesoc_core()}


def python_layer(folder: Path) -> None:
    """Write the package `tactile_depth_registers` into a folder, with its library."""
    PythonExporter().export(
        compiled(inst_name=LAYER_NAME),
        str(folder),
        skip_test_case_generation=True,
        skip_systemrdl_name_and_desc_in_docstring=True,
    )


def main() -> None:
    """Write every file, and print which have changed."""
    for path, text in written().items():
        changed = not path.exists() or path.read_text() != text
        path.write_text(text)
        print(f"{'wrote' if changed else 'same '} {path.relative_to(ROOT)}")
    BUILT.mkdir(parents=True, exist_ok=True)
    python_layer(BUILT)
    for path in (BUILT / LAYER_NAME, *(c_header(of, BUILT) for of in MAPS), *tops(BUILT)):
        print(f"wrote {path.relative_to(ROOT)}")
