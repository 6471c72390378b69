# SPDX-License-Identifier: Apache-2.0
"""C header of the tables: a program loads them into registers in memory, which then hold the $readmemh files."""

import json
import re
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from commands.hardware import registers
from tactile_depth.chip.c_header import FILE, c_header
from tactile_depth.chip.camera.camera_registers import WINDOW, CameraRegisters, camera_registers_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.hardware_files import write_hardware
from tactile_depth.chip.limits import CORRECTION_WIDTH, CUBIC, POLYNOMIAL
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.axil_registers import AxilRegisters, Build, Events
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS, REGISTERS, TABLES
from tactile_depth.chip.registers.table_banks import COMMIT
from tactile_depth.chip.tactile_depth import hdl_parameters, top_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb import tb_c_header
from tb.structures import Structure

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-pedantic")
ALL = COMMIT.mask()
LOADER = ROOT / "tests" / "load_tables.c"
EXAMPLE = ROOT / "examples" / "load_calibration.c"
ACCESSES = {  # of the example, and what stands for them in the device of register_file.c
    "*(volatile uint32_t *)((char *)context + address) = word;": "device_write(context, address, word);",
    "return *(volatile uint32_t *)((char *)context + address);": "return device_read(context, address);",
}
DEVICE = """
#include <stdio.h>
#include <stdint.h>
uint32_t device_read(void *context, uint32_t address);
void device_write(void *context, uint32_t address, uint32_t word);
void *device_begin(int count, char **words);
void device_end(void *context);
"""
MAIN = """
int main(int count, char **words)
{
  void *device = device_begin(count - 2, words + 2);

  printf("result %d\\n", load_calibration(device));
  device_end(device);
  return 0;
}
"""
RESULTS = ["LOADED", "NO_DEVICE", "OTHER_GRID", "OTHER_FORMAT", "OTHER_BUILD", "OTHER_UNIT", "OTHER_NUMBERS"]
RESULTS += ["OTHER_SIZE", "STAYS_PENDING", "REFUSED", "OTHER_WINDOW"]
GRADIENT_MODELS = ("cubic", "quadratic", "lut")


def tool(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"{name} is missing: it compiles the header")
    return path


def compiled(*arguments: Any) -> None:
    ran = subprocess.run(list(map(str, arguments)), capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr


@dataclass(frozen=True)
class Loaded:
    """Accesses of the program to the registers in memory.

    Attributes
    ----------
    result : str
        Result of the load function, one of RESULTS.
    writes : list of (address, word)
    tables : dict
        Name of a table to the entries that the next frame uses, int64 (entries, 2), upper and lower word.
    refusals : int
        Writes that were refused.
    """

    result: str
    writes: list[tuple[int, int]]
    tables: dict[str, np.ndarray]
    refusals: int


@dataclass(frozen=True)
class Program:
    """The program with a header, and the device that it expects.

    Attributes
    ----------
    folder : Path
        The header, and the $readmemh files of the same configuration.
    """

    folder: Path
    config: Configuration
    pitch_mm: float
    path: Path

    @property
    def build(self) -> Build:
        return Build(top_parameters(self.config, self.pitch_mm))

    def run(self, commit: int = ALL, words: Mapping[str, int] = {}, **chances: int) -> Loaded:
        """Load the tables of some bits of TABLE_COMMIT.

        Parameters
        ----------
        words : mapping
            Words of registers that the device shows in place of those of the configuration.
        chances
            See `device_begin` in tests/register_file.c.
        """
        device = AxilRegisters(self.build).values | dict(words)
        named = REGISTERS | CAMERA_REGISTERS
        arguments = {f"{named[name].offset:#x}": word for name, word in device.items() if word}
        arguments |= {f"size{table}": size for table, size in self.build.table_sizes.items()} | chances
        command = [str(self.path), str(commit), *(f"{name}={value}" for name, value in arguments.items())]
        text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        entries = re.findall(r"^entry (\d+) (\w+) (\w+)$", text, re.MULTILINE)
        names = {str(code): name for name, code in TABLES.items()}
        tables: dict[str, list[list[int]]] = {}
        for table, high, low in entries:
            tables.setdefault(names[table], []).append([int(high, 0), int(low, 0)])
        writes = re.findall(r"^write (\w+) (\w+)$", text, re.MULTILINE)
        numbers = dict(re.findall(r"^(result|refusals) (\d+)$", text, re.MULTILINE))
        return Loaded(
            RESULTS[int(numbers["result"])],
            [(int(address, 0), int(word, 0)) for address, word in writes],
            {name: np.array(listed) for name, listed in tables.items()},
            int(numbers["refusals"]),
        )


def program_of(folder: Path, config: Configuration, pitch_mm: float, source: Path = LOADER) -> Program:
    """Compile a program with the header in a folder; both by the strictest rules of C99."""
    gcc, path = tool("gcc"), folder / "load_tables"
    registers.c_header(registers.PIPELINE, folder)
    common = (*WARNINGS, f"-I{folder}", "-c")
    compiled(gcc, "-std=gnu11", *common, ROOT / "tests" / "register_file.c", "-o", folder / "device.o")
    strict = ("-Wconversion", "-Wshadow")
    compiled(gcc, "-std=c99", *strict, *common, source, "-o", folder / "main.o")
    compiled(gcc, folder / "device.o", folder / "main.o", "-o", path)
    return Program(folder, config, pitch_mm, path)


@pytest.fixture(scope="module", params=GRADIENT_MODELS)
def program(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Program:
    """The header of a configuration with all tables of a gradient model, which hold random words."""
    ball, folder, rng = td.sample("ball"), tmp_path_factory.mktemp(request.param), np.random.default_rng(1)
    pipeline = td.Pipeline(ball.sensor, ball.reference, grid=(24, 32), model=request.param)
    config, sensor = pipeline.config, pipeline.sensor
    assert sensor.corrections is not None
    corrections = rng.uniform(-0.4, 0.4, sensor.corrections.shape) * config.gradient_limit
    degree = np.repeat(range(4), range(1, 5))  # of the position in mm, by term
    terms = rng.uniform(-1, 1, CUBIC) / 20.0 ** (degree + 1)
    sensor = replace(sensor, corrections=corrections, cubic=terms, coefficients=terms[..., :6])
    half = 1 << config.data_width - 1
    zero = rng.integers(-half, half, config.reference_nodes)
    gains = rng.integers(0, 1 << config.gain_width, (*config.reference_nodes, 3))
    write_hardware(folder, sensor, config, zero, gains, {})
    return program_of(folder, config, pipeline.pixel_pitch_mm)


def memory(folder: Path, name: str) -> list[int]:
    """Return the words of a $readmemh file."""
    return [int(line, 16) for line in (folder / f"{name}.hex").read_text().split()]


def of_memories(folder: Path, config: Configuration) -> dict[str, np.ndarray]:
    """Return the entries of the tables in the $readmemh files, (entries, 2): upper and lower word, unsigned."""
    entries: dict[str, Any] = {}
    if config.gradient_model != "quadratic":
        width = CORRECTION_WIDTH if config.polynomials else config.gradient.width
        entries["gradient"] = [[word >> width, word & (1 << width) - 1] for word in memory(folder, "gradient")]
    if config.polynomials:
        polynomials = [memory(folder, f"polynomial_{polynomial}") for polynomial in range(6)]
        entries["coefficients"] = [[0, word] for words in polynomials for word in words]
    if config.flat_field:
        colours = zip(*(memory(folder, f"gain_{colour}") for colour in range(3)), strict=True)
        entries["reference"] = [[0, word] for gains in colours for word in (*gains, 0)]
    if config.zero_offset:
        entries["zero"] = [[0, word] for word in memory(folder, "zero_0")]
    return {name: np.array(listed) for name, listed in entries.items()}


def masked(tables: Mapping[str, np.ndarray], config: Configuration) -> dict[str, np.ndarray]:
    """Return entries as the tables hold them: a table stores as many of the lower bits of a word as it has."""
    widths = {
        "gradient": CORRECTION_WIDTH if config.polynomials else config.gradient.width,
        "coefficients": POLYNOMIAL.width,
        "reference": config.gain_width,
        "zero": config.data_width,
    }
    one_word = {name: np.array([name == "gradient", True]) for name in tables}
    return {name: entries * one_word[name] & (1 << widths[name]) - 1 for name, entries in tables.items()}


def assert_same(got: Mapping[str, np.ndarray], want: Mapping[str, np.ndarray]) -> None:
    assert got.keys() == want.keys()
    for name, entries in want.items():
        np.testing.assert_array_equal(got[name], entries, name)


def test_the_program_loads_what_the_memories_hold(program: Program) -> None:
    loaded = program.run(words={"TABLE_SELECT": TABLES["zero"], "TABLE_INDEX": 3})  # as another program has left it
    assert (loaded.result, loaded.refusals) == ("LOADED", 0)
    tables = of_memories(program.folder, program.config)
    assert_same(masked(loaded.tables, program.config), tables)
    for name, entries in tables.items():
        assert np.unique(entries[:, 1]).size > 20, f"the test is void: {name} holds the same word often"


def test_the_model_of_the_registers_takes_every_write(program: Program) -> None:
    device, loaded = AxilRegisters(program.build), program.run()
    device.values["PITCH"] = 0
    for address, word in loaded.writes:
        assert device.write(address, word) == Response.OKAY, f"{word:#x} to {address:#x}"
        device.clock(Events())
    names = {code: name for name, code in TABLES.items()}
    written: dict[str, list[list[int]]] = {}
    for table, index, high, low in device.table_writes:
        entries = written.setdefault(names[table], [])
        assert index == len(entries)
        entries.append([high, low])
    held = {name: np.array(entries) for name, entries in written.items()}
    assert_same(masked(held, program.config), of_memories(program.folder, program.config))
    assert device.read(COMMIT.offset)[0] == program.build.present
    assert device.values["PITCH"] == round(program.pitch_mm * 1e6)


def test_some_tables_are_loaded_and_the_others_stay(program: Program) -> None:
    name = "gradient" if program.config.gradient_model == "lut" else "coefficients"
    loaded = program.run(COMMIT.pack(**{name: 1}))
    assert loaded.result == "LOADED"
    assert loaded.writes[-1] == (COMMIT.offset, COMMIT.pack(**{name: 1}))
    assert loaded.tables[name].any()
    assert not any(entries.any() for other, entries in loaded.tables.items() if other != name)


@pytest.mark.parametrize(
    ("register", "field", "result"),
    [
        ("ID", "value", "NO_DEVICE"),
        ("GRID", "rows", "OTHER_GRID"),
        ("GRID", "columns", "OTHER_GRID"),
        ("FORMAT", "data_width", "OTHER_FORMAT"),
        ("FORMAT", "bits_per_channel", "OTHER_FORMAT"),
        ("DEVICE", "solver", "OTHER_BUILD"),
        ("DEVICE", "gain_width", "OTHER_BUILD"),
        ("DEVICE", "lanes", "LOADED"),
        ("DEPTH_UNIT", "mantissa", "OTHER_UNIT"),
        ("SLOPE_UNIT", "exponent", "OTHER_UNIT"),
        ("ARITHMETIC", "value", "OTHER_NUMBERS"),
        ("PITCH", "value", "LOADED"),
    ],
)
def test_a_device_that_does_not_fit_is_left_as_it_is(program: Program, register: str, field: str, result: str) -> None:
    word = AxilRegisters(program.build).values[register] ^ 1 << REGISTERS[register].field(field).low
    loaded = program.run(words={register: word})
    assert loaded.result == result
    assert bool(loaded.writes) == (result == "LOADED")


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_another_size_is_refused(program: Program, name: str) -> None:
    size = program.build.table_sizes[TABLES[name]]
    if size:
        other: dict[str, Any] = {f"size{TABLES[name]}": 2 * size}
        loaded = program.run(**other)
        assert loaded.result == "OTHER_SIZE"
        assert {address for address, _ in loaded.writes} == {REGISTERS["TABLE_SELECT"].offset}


def test_it_waits_for_the_frame_that_takes_earlier_tables(program: Program) -> None:
    pending = {"TABLE_COMMIT": program.build.present}
    loaded = program.run(words=pending, frame=5)
    assert (loaded.result, loaded.refusals) == ("LOADED", 0)
    assert_same(masked(loaded.tables, program.config), of_memories(program.folder, program.config))
    assert program.run(words=pending).result == "STAYS_PENDING"
    assert program.run(COMMIT.pack(zero=1), words={"TABLE_COMMIT": COMMIT.pack(reference=1)}).result == "LOADED"


def test_it_waits_for_the_end_of_a_capture_and_for_its_commit(program: Program) -> None:
    loaded = program.run(capture=4, frame=3)
    assert (loaded.result, loaded.refusals) == ("LOADED", 0)
    assert program.run(capture=4).result == "STAYS_PENDING"
    assert program.run(capture=1000, frame=1).result == "STAYS_PENDING"


@pytest.mark.parametrize("first", ["first", "last", "inner"])
def test_tables_with_an_entry_that_was_refused_are_not_committed(program: Program, first: str) -> None:
    entries = sum(program.build.table_sizes.values())
    loaded = program.run(refused={"first": 1, "last": entries, "inner": entries // 2}[first])
    assert loaded.result == "REFUSED"
    assert not any(entries.any() for entries in loaded.tables.values())
    assert REGISTERS["TABLE_COMMIT"].offset not in dict(loaded.writes)


def test_values_for_the_user(tmp_path: Path) -> None:
    """Compare units, grid and thresholds with those of the pipeline, in a program that also reads the register map."""
    ball = td.sample("ball")
    sensor = replace(ball.sensor, pixel_aspect=1.25)
    pipeline = td.Pipeline(sensor, ball.reference, grid=(24, 32), threshold_mm=0.2)
    described = json.loads(pipeline.hardware(tmp_path).read_text())
    units = ("DEPTH_LSB_MM", "PIXEL_PITCH_MM", "PIXEL_ASPECT", "GRADIENT_LSB")
    names = ("ROWS", "COLUMNS", *units, *described["registers"])
    text = (tmp_path / FILE).read_text()
    values = dict(re.findall(r"^#define TACTILE_DEPTH_(\w+) (\S+?)u?$", text, re.MULTILINE))
    rows, columns, depth, pitch, aspect, gradient, *words = (
        float(values[name]) if "." in values[name] else int(values[name], 0) for name in names
    )
    assert (rows, columns) == pipeline.grid
    assert (depth, pitch) == (pipeline.depth_lsb_mm, pipeline.pixel_pitch_mm)
    assert (gradient, aspect) == (pipeline.config.gradient_lsb, 1.25)
    assert described["pixel_aspect"] == 1.25
    assert words == [*described["registers"].values()]
    assert described["registers"]["THRESHOLD"] == round(0.2 / pipeline.depth_lsb_mm)
    assert described["registers"]["OFF_THRESHOLD"] == described["registers"]["THRESHOLD"]
    assert described["registers"]["AREA_THRESHOLD"] == round(pipeline.area_threshold_mm / pipeline.depth_lsb_mm)
    addresses = {name.removesuffix("_ADDRESS"): value for name, value in values.items() if name.endswith("_ADDRESS")}
    assert {name: int(value, 16) for name, value in addresses.items()} == {
        name: register.offset for name, register in REGISTERS.items()
    }
    fields = {f"{r.name}_{f.name.upper()}": f.mask for r in REGISTERS.values() for f in r.fields if f.name != "value"}
    assert {name: int(values[name].rstrip("u"), 16) for name in fields} == fields


@pytest.mark.parametrize("standard", ["c++11", "c++20"])
def test_the_header_is_cpp_too(program: Program, tmp_path: Path, standard: str) -> None:
    source = tmp_path / "program.cpp"
    source.write_text(f'#include "{FILE}"\nint main() {{ return TACTILE_DEPTH_LOADED; }}\n')
    flags = (f"-std={standard}", *WARNINGS, f"-I{program.folder}")
    compiled(tool("g++"), *flags, source, "-o", tmp_path / "program")


def test_the_example_and_the_results_on_the_page(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "integrate.md").read_text()
    ball = td.sample("ball")
    td.Pipeline(ball.sensor, ball.reference, grid=(24, 32)).hardware(tmp_path)
    compiled(tool("gcc"), "-std=c99", *WARNINGS, f"-I{tmp_path}", "-c", EXAMPLE, "-o", tmp_path / "program.o")
    assert re.findall(r"^\| `TACTILE_DEPTH_(\w+)`", page, re.MULTILINE) == RESULTS


def test_the_example_writes_every_register_that_contacts_depend_on(tmp_path: Path) -> None:
    """Run it on another bus, as its comment says: what is left as after a reset makes `touching` alternate."""
    ball = td.sample("ball")
    pipeline = td.Pipeline(ball.sensor, ball.reference, grid=(24, 32))
    wanted = json.loads(pipeline.hardware(tmp_path).read_text())["registers"]
    contact = {"THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE"}
    assert wanted.keys() == contact | {"SLOPE_LIMIT"}
    text = EXAMPLE.read_text()
    for own, other in ACCESSES.items():
        assert text.count(own) == 1
        text = text.replace(own, other)
    source = tmp_path / "example.c"
    source.write_text(DEVICE + text + MAIN)
    loaded = program_of(tmp_path, pipeline.config, pipeline.pixel_pitch_mm, source).run()
    assert loaded.result == "LOADED"
    written = dict(loaded.writes)
    assert {name: written.get(REGISTERS[name].offset) for name in wanted} == wanted


def test_a_name_that_ends_a_string_or_a_comment(tmp_path: Path) -> None:
    config = Configuration(columns=16, rows=8, solver="tridiagonal", bits_per_channel=2)
    sensor = replace(synthetic(2), name='a"b*/c\\\n??/ü')
    (tmp_path / FILE).write_text(c_header(sensor, config))
    write_roms(tmp_path, sensor, config)
    loaded = program_of(tmp_path, config, sensor.pixel_pitch_mm).run()
    assert loaded.result == "LOADED"
    assert_same(masked(loaded.tables, config), of_memories(tmp_path, config))


def test_a_device_with_another_camera_window_is_left_as_it_is(tmp_path: Path) -> None:
    config = Configuration(columns=16, rows=8, solver="tridiagonal", bits_per_channel=2)
    camera = CameraConfiguration((48, 64), (8, 16), "raw8", window=(4, 8, 48, 24))
    (tmp_path / FILE).write_text(c_header(synthetic(2), config, camera=camera))
    program = program_of(tmp_path, config, synthetic(2).pixel_pitch_mm)
    words = CameraRegisters(camera_registers_parameters(camera)).values
    assert program.run(words=words).result == "LOADED"
    for name in WINDOW:
        loaded = program.run(words=words | {name: words[name] + 1})
        assert loaded.result == "OTHER_WINDOW"
        assert {address for address, _ in loaded.writes} == {REGISTERS["TABLE_SELECT"].offset}


OF_POLYNOMIALS: dict[str, Any] = {"columns": 16, "rows": 9, "solver": "tridiagonal", "lanes": 4, "neumann": True}
OF_POLYNOMIALS |= {"flat_field": True, "gradient_model": "quadratic", "zero_offset": True, "light_gains": True}
OF_LUT: dict[str, Any] = {"columns": 16, "bits_per_channel": 2, "flat_field": True}


@pytest.mark.parametrize("choices", [OF_POLYNOMIALS, OF_LUT], ids=["tridiagonal-quadratic", "spectral-lut"])
@pytest.mark.parametrize("simulator", ["icarus", pytest.param("verilator", marks=pytest.mark.regress)], indirect=True)
def test_the_rtl_takes_the_tables(
    run_tb: Callable[..., None], simulator: str, tmp_path: Path, choices: dict[str, Any]
) -> None:
    """Call the function of the header from the testbench, which makes its accesses on the bus of the RTL."""
    config = Configuration(**choices)
    (tmp_path / FILE).write_text(c_header(**tb_c_header.calibration(config)))
    source, library = tmp_path / "load.c", tmp_path / "load.so"
    source.write_text(
        f'#include "{FILE}"\n'
        "int load(tactile_depth_write write, tactile_depth_read read);\n"
        "int load(tactile_depth_write write, tactile_depth_read read)\n"
        "{ return tactile_depth_load(write, read, 0, TACTILE_DEPTH_ALL_TABLES); }\n"
    )
    compiled(tool("gcc"), "-std=c99", *WARNINGS, "-shared", "-fPIC", source, "-o", library)
    structure = Structure(
        hdl_parameters(config),
        device={"configuration": choices, "library": str(library)},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
    )
    run_tb(structure, toplevel="tactile_depth", test_module="tb.tb_c_header")
