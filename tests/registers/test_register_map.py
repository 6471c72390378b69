# SPDX-License-Identifier: Apache-2.0
"""Maps in registers/: generated files are up to date, and C, Python and IP-XACT have the same registers."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from peakrdl_ipxact import IPXACTImporter
from systemrdl.compiler import RDLCompiler
from systemrdl.node import AddrmapNode

from commands.common.repository import ROOT
from commands.hardware import registers
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.axil_registers import RECORD, AxilRegisters, Build, Live
from tactile_depth.chip.registers.register_map import (
    ACCESSES,
    ADDRESS_WIDTH,
    CAMERA_MAP,
    CAMERA_REGISTERS,
    MAP,
    REGISTERS,
    TABLES,
    WORD_BITS,
)
from tactile_depth.chip.tactile_depth import top_parameters

BUILD = Build(top_parameters(Configuration(columns=32, rows=16, solver="tridiagonal", bits_per_channel=2)))
RECORD_WORDS = tuple(REGISTERS["RECORD_PEAK_POSITION"].pack(row=n + 2, column=n) for n in range(len(RECORD)))


MAPS = {registers.PIPELINE: MAP, registers.CAMERA: CAMERA_MAP}


def test_written_files_are_up_to_date() -> None:
    for path, text in registers.written().items():
        assert path.read_text() == text, f"{path.relative_to(ROOT)} is not what the map says: run make registers"


def test_offsets_are_words_of_their_own() -> None:
    offsets = [register.offset for each in MAPS.values() for register in each]
    assert len(set(offsets)) == len(offsets) == len(REGISTERS) + len(CAMERA_REGISTERS)
    assert all(offset % (WORD_BITS // 8) == 0 for offset in offsets)
    assert all(0 <= offset < 1 << ADDRESS_WIDTH for offset in offsets)


def test_accesses_are_known() -> None:
    for register in (*MAP, *CAMERA_MAP):
        assert {field.access for field in register.fields} <= set(ACCESSES), register.name


def test_an_access_that_no_register_has_is_refused(tmp_path: Path) -> None:
    source = tmp_path / "other.rdl"
    source.write_text("addrmap a { reg { field { sw = rw; onread = rclr; } value[31:0] = 0; } R @ 0; };\n")
    node = next(iter(registers.compiled(source).registers()))
    with pytest.raises(ValueError, match=r"a\.R\.value: no register has sw, onwrite, onread"):
        registers.register_of(node)


def test_a_table_has_the_bit_of_its_number_in_the_commit_register() -> None:
    """Compare: hdl/registers/table_access.sv uses the number of a table as its bit."""
    assert {field.name: field.low for field in REGISTERS["TABLE_COMMIT"].fields} == dict(TABLES)
    assert sorted(TABLES.values()) == list(range(len(TABLES)))


@pytest.mark.parametrize("register", [*MAP, *CAMERA_MAP], ids=lambda register: register.name)
def test_pack_is_the_inverse_of_unpack(register: Any) -> None:
    fields: dict[str, Any] = {field.name: (n + 1) % (1 << field.width) for n, field in enumerate(register.fields)}
    assert register.unpack(register.pack(**fields)) == fields


def test_a_value_too_large_for_its_field_is_refused() -> None:
    with pytest.raises(ValueError, match=r"STATUS\.busy=2 does not fit: accepted are 0 to 1"):
        REGISTERS["STATUS"].pack(busy=2)
    with pytest.raises(KeyError, match="it has rows, columns"):
        REGISTERS["GRID"].field("cols")


@pytest.mark.parametrize("of", MAPS, ids=lambda of: of.name)
def test_the_c_header(of: registers.Map, tmp_path: Path) -> None:
    """Compile a program that checks the offset of every register, and the bits and reset value of every field."""
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("gcc is missing: it compiles the C header")
    checks = [f"sizeof({of.name}_t) == {MAPS[of][-1].offset + 4}"]
    for register in MAPS[of]:
        checks.append(f"offsetof({of.name}_t, {register.name}) == {register.offset}")
        for field in register.fields:
            prefix = f"{of.name}__{register.name}__{field.name}".upper()
            checks += [f"{prefix}_bm == {field.mask}u", f"{prefix}_bp == {field.low}", f"{prefix}_bw == {field.width}"]
            if field.reset is not None:
                checks.append(f"{prefix}_reset == {field.reset}u")
    program = tmp_path / "program.c"
    program.write_text(
        "#include <stddef.h>\n"
        f'#include "{of.name}.h"\n'
        + "".join(f'static_assert({check}, "");\n' for check in checks)
        + "int main(void) { return 0; }\n"
    )
    registers.c_header(of, tmp_path)
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror"]
    ran = subprocess.run([compiler, *flags, program, "-o", tmp_path / "program"], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert subprocess.run([tmp_path / "program"]).returncode == 0


class Importer(IPXACTImporter):  # type: ignore[misc]
    """Importer of IP-XACT, which has no word for `external`: a register whose accesses the user defines is external."""

    def parse_register(self, register: Any) -> Any:
        parsed = super().parse_register(register)
        parsed.external = any("onread" in field.properties for field in parsed.children)
        return parsed


def described(top: AddrmapNode) -> list[dict[str, Any]]:
    """Return name, address, bits and fields of each register of a map; a field with bits, access, reset and values."""
    accesses = ("sw", "onwrite", "onread")
    return [
        {
            "name": register.inst_name,
            "address": register.absolute_address,
            "bits": register.get_property("regwidth"),
            "text": (register.get_property("name"), register.get_property("desc")),
            "fields": [
                {
                    "name": field.inst_name,
                    "bits": (field.high, field.low),
                    "access": [str(field.get_property(access)) for access in accesses],
                    "reset": field.get_property("reset"),
                    "values": [(code.name, code.value) for code in field.get_property("encode") or ()],
                    "text": field.get_property("name"),
                }
                for field in register.fields()
            ],
        }
        for register in top.registers(unroll=True)
    ]


@pytest.mark.parametrize("of", MAPS, ids=lambda of: of.name)
def test_the_ip_xact(of: registers.Map, tmp_path: Path) -> None:
    """Import the component again: it has the registers of the map, with their addresses, fields, access and reset."""
    compiler = RDLCompiler()
    Importer(compiler).import_file(str(registers.ip_xact(of, tmp_path)))
    imported = compiler.elaborate(f"{of.name}__{of.name}_mmap__{of.name}", inst_name=of.name).top
    assert described(imported) == described(registers.compiled(of.source))
    assert [register["name"] for register in described(imported)] == [register.name for register in MAPS[of]]


def test_the_python_layer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read and write fields by name, with the model of the registers as the device."""
    registers.python_layer(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    from tactile_depth_registers.lib import NormalCallbackSet  # type: ignore[import-not-found]
    from tactile_depth_registers.reg_model import RegModel  # type: ignore[import-not-found]

    model = AxilRegisters(BUILD, entry=lambda table, index: (0x1000 + index, 0x2000 + index))

    def read(addr: int, **_: Any) -> Any:
        data, response = model.read(addr, Live(busy=True, in_use=model.banks.bank, record=RECORD_WORDS))
        assert response == 0
        return data

    def write(addr: Any, data: Any, **_: Any) -> None:
        assert model.write(addr, data, live=Live(in_use=model.banks.bank)) == 0

    device = RegModel(callbacks=NormalCallbackSet(read_callback=read, write_callback=write))
    assert (device.GRID.rows.read(), device.GRID.columns.read()) == (16, 32)
    assert device.STATUS.busy.read() == 1
    device.CONTROL.hold_contact.write(1)
    assert model.values["CONTROL"] == REGISTERS["CONTROL"].pack(hold_contact=1)
    device.REFERENCE_CAPTURE.log2_frames.write(6)
    assert device.REFERENCE_CAPTURE.read() == REGISTERS["REFERENCE_CAPTURE"].pack(log2_frames=6)
    assert device.RECORD_PEAK_POSITION.row.read() == 6
    device.TABLE_INDEX.value.write(3)
    device.TABLE_HIGH.write(5)
    device.TABLE_LOW.write(6)
    assert model.table_writes == [(TABLES["gradient"], 3, 5, 6)]
    assert (device.TABLE_HIGH.read(), device.TABLE_LOW.read()) == (0x1004, 0x2004)
    assert device.TABLE_INDEX.read() == 5
