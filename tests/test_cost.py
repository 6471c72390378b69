# SPDX-License-Identifier: Apache-2.0
"""Cost of a configuration against the RTL, elaborated and counted by Yosys, and against formulas of docs/results.md."""

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from commands.common import recorded, repository, run_request
from commands.cost.cost import KINDS, cost, power_mw
from commands.cost.devices import ECP5, XCZU7EV, Device
from commands.cost.luts import RUNS, logic, memories
from commands.hardware import estimate, synthesis, yosys
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.fft import twiddle_stages
from tactile_depth.chip.resources import LATE_BITS
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic

DEVICES = {device.name: device for device in (XCZU7EV, ECP5)}
FITTED, CHECKED = 0.037, 0.042  # largest difference of LUTs of logic
NEAR = 16  # LUTs of memories: the tools leave out zeros, and build a deep one of a bit in another way

SAVED = {  # blocks, where the tool leaves out a constant bit of a table of 37, whose words then fit one
    ("LFE5U-85F", "COLS=32 DATA_WIDTH=15 GAIN_WIDTH=16 PARITY=1 PRESET=sensor ROWS=24 SELF_CHECK=1"): 1
}
CASES = [
    {"columns": 16, "bits_per_channel": 2},
    pytest.param(
        {"columns": 32, "data_width": 30, "coefficient_width": 20, "neumann": True}, marks=pytest.mark.regress
    ),
    {"columns": 16, "rows": 24, "solver": "tridiagonal", "bits_per_channel": 2, "data_width": 20},
    pytest.param(
        {"columns": 64, "rows": 24, "solver": "tridiagonal", "neumann": True, "coefficient_width": 14},
        marks=pytest.mark.regress,
    ),
    {"columns": 32, "rows": 24, "solver": "tridiagonal", "neumann": True, "zero_offset": True},
    {"columns": 16, "rows": 24, "solver": "tridiagonal", "flat_field": True, "gradient_model": "quadratic"},
    {"columns": 512, "rows": 48, "solver": "tridiagonal", "bits_per_channel": 2},  # words three to a memory row
    {"columns": 16, "rows": 9, "solver": "tridiagonal", "lanes": 2, "zero_offset": True, "neumann": True},
    {"columns": 32, "rows": 9, "solver": "tridiagonal", "parity": True, "self_check": True},
    pytest.param({"columns": 16, "parity": True}, marks=pytest.mark.regress),
    pytest.param(
        {"columns": 64, "rows": 21, "solver": "tridiagonal", "lanes": 8, "zero_offset": True, "neumann": True},
        marks=pytest.mark.regress,
    ),
    pytest.param(
        {"columns": 64, "rows": 9, "solver": "tridiagonal", "lanes": 32, "bits_per_channel": 2},
        marks=pytest.mark.regress,
    ),
]

INSTANCES = {  # in the units and solvers
    "u_flat_field": "flat_field",
    "u_lookup": "gradient_lookup",
    "u_polynomial": "polynomial_gradient",
    "u_divergence": "divergence",
    "u_row_in": "row_order",
    "u_rows": "row_order",
    "u_row_forward": "dst_forward",
    "u_column_forward": "dst_forward",
    "u_forward": "dst_forward",
    "u_to_columns": "transpose",
    "u_to_rows": "transpose",
    "u_divide": "spectral_divide",
    "u_down": "elimination",
    "u_stack": "frame_stack",
    "u_up": "substitution",
    "u_row_inverse": "dst_inverse",
    "u_column_inverse": "dst_inverse",
    "u_inverse": "dst_inverse",
    "u_row_out": "corner_turn",
    "u_corner_turn": "corner_turn",
    "u_zero_offset": "zero_offset",
    "u_capture": "zero_capture",
    "u_self_check": "self_check",
    "u_events": "contact_events",
}
REGISTERS = "u_registers.", "$auto$proc_rom"  # a few words that nobody counts, and what proc makes of their map


def elaborated(config: Configuration, folder: Path) -> Any:
    """Return the multiplications and memories of the whole pipeline, by name."""
    write_roms(folder, synthetic(config.bits_per_channel), config)
    names = []
    for path in repository.sources("tactile_depth"):
        (folder / path.name).write_text(path.read_text())
        names.append(path.name)
    parameters = " ".join(f"-G{name}={value}" for name, value in hdl_parameters(config).items())
    script = folder / "count.ys"
    script.write_text(
        f"read_slang --threads 1 --top tactile_depth {parameters} {' '.join(names)}\n"
        "proc\nmemory_collect\ndelete c:* t:$mul %d t:$mem* %d\nwrite_json cells.json\n"
    )
    assert yosys.run(script, timeout_s=300) == ""
    (module,) = json.loads((folder / "cells.json").read_text())["modules"].values()
    return module["cells"]


def core_of(cell: str) -> str:
    """Return the core of a cell, among those that cost.py lists, by the instances in its name."""
    return INSTANCES[next(part for part in cell.split(".") if part in INSTANCES)]


def operand_width(bits: Any) -> int:
    """Return the width of an operand without copies of its sign."""
    while len(bits) > 1 and bits[-1] == bits[-2]:
        bits = bits[:-1]
    return len(bits)


def is_address(cell: Any) -> bool:
    """Return True for a product with a constant outside td_multiply.sv: it addresses a word and takes adders."""
    wires = cell["connections"]
    constant = any(all(isinstance(bit, str) for bit in wires[port]) for port in "AB")
    return constant and not cell["attributes"]["src"].startswith("td_multiply.sv")


@pytest.mark.parametrize("choices", CASES, ids=str)
def test_multipliers_and_memories_are_those_of_the_rtl(tmp_path: Path, choices: Any) -> None:
    config = Configuration(**choices)
    multipliers: Counter[Any] = Counter()
    memories: Counter[Any] = Counter()
    others = set()
    for name, cell in elaborated(config, tmp_path).items():
        if cell["type"] == "$mul" and not is_address(cell):
            wires = cell["connections"]
            multipliers[tuple(sorted((operand_width(wires["A"]), operand_width(wires["B"]))))] += 1
        elif cell["type"].startswith("$mem") and not name.startswith(REGISTERS):
            behind_wrapper = name.split(".")[-2].startswith("g_")  # td_ram.sv, td_rom.sv name their array in a generate
            if behind_wrapper:
                width, words = (int(cell["parameters"][size], 2) for size in ("WIDTH", "SIZE"))
                memories[core_of(name), width, words] += 1
            else:
                others.add(name)
    counted = cost(config)
    assert multipliers == Counter(tuple(sorted((m.a, m.b))) for m in counted.multipliers)
    assert memories == Counter((memory.core, memory.width, memory.words) for memory in counted.memories)
    assert {multiplier.core for multiplier in counted.multipliers} <= repository.cores().keys()
    tags = {f"u_depth.u_tags.{name}" for name in ("due_clock", "lates", "tags")}
    assert others <= tags, "registers of a few words, of frame_tags.sv"


@pytest.mark.parametrize("size", [32, 64, 128, 256, 512])
def test_formulas_of_the_readme(size: int) -> None:
    stages = twiddle_stages(size)
    for neumann in (False, True):
        spectral = cost(Configuration(columns=size, neumann=neumann))
        tridiagonal = cost(Configuration(columns=size, neumann=neumann, solver="tridiagonal"))
        assert spectral.tiles == 16 * stages + 13
        assert tridiagonal.tiles == 8 * stages + 10 + 2 * neumann
        assert spectral.bits_of("frame stores") == 2 * 24 * size**2
        words = size if size <= 128 else 3 * -(-size // 3)  # a row's, in whole rows of an UltraRAM; two go past it
        assert tridiagonal.bits_of("frame stores") == 24 * words * (size - 2)
        for counted in (spectral, tridiagonal):
            assert counted.memory_bits == sum(counted.bits_of(kind) for kind in KINDS)


@pytest.mark.parametrize(
    ("a", "b", "tiles"),
    [
        (27, 18, 1),
        (18, 27, 1),
        (28, 18, 2),
        (27, 19, 2),
        (28, 19, 2),
        (35, 24, 2),
        (35, 28, 4),
        (53, 18, 2),
        (54, 18, 3),
    ],
)
def test_wide_products_take_several_multipliers(a: Any, b: Any, tiles: Any) -> None:
    assert XCZU7EV.multipliers(a, b) == tiles


@pytest.mark.parametrize(("a", "b", "number"), [(18, 18, 1), (19, 18, 2), (25, 9, 2), (36, 18, 2), (27, 24, 4)])
def test_an_ecp5_splits_operands_of_more_than_18_bits(a: int, b: int, number: int) -> None:
    assert ECP5.multipliers(a, b) == ECP5.multipliers(b, a) == number


@pytest.mark.parametrize(
    ("words", "width", "rom", "blocks"),
    [(512, 36, False, 1), (513, 36, False, 2), (4096, 44, False, 11), (4096, 44, True, 10), (16384, 24, False, 24)],
)
def test_blocks_of_an_ecp5(words: int, width: int, rom: bool, blocks: int) -> None:
    """A RAM of more than 2,048 words is sliced by boards/ecp5/td_ram.sv, a ROM is as Yosys shapes it."""
    assert ECP5.blocks(words, width, rom) == blocks


@pytest.mark.parametrize(("device", "folder"), [(XCZU7EV, "hdl"), (ECP5, "boards/ecp5")], ids=str)
def test_a_device_builds_memories_of_luts_up_to_the_size_in_its_package(device: Device, folder: str) -> None:
    text = (repository.ROOT / folder / "td_memory_pkg.sv").read_text()
    numbers = {name: int(value) for name, value in re.findall(r"localparam int (\w+) = (\d+);", text)}
    assert numbers == {"DistributedBits": device.distributed_bits, "LateBits": LATE_BITS}


@pytest.mark.parametrize("run", json.loads(RUNS.read_text()), ids=lambda run: f"{run['device']}-{run['variables']}")
def test_the_model_is_near_the_recorded_runs(run: dict[str, Any]) -> None:
    """Bounds: a little above the largest differences in docs/hardware.md, for runs fitted and not fitted."""
    device, count = DEVICES[run["device"]], cost(Configuration(**run["configuration"]))
    assert count.blocks_of(device) - SAVED.get((run["device"], run["variables"]), 0) == run["blocks"]
    assert memories(count.config, device) == pytest.approx(run["memories"], abs=NEAR)
    assert count.multipliers_of(device) == pytest.approx(run["multipliers"], abs=2)  # products by constants
    error = sum(logic(count.config, device).values()) / sum(run["logic"].values()) - 1
    assert abs(error) <= (FITTED if run["fitted"] else CHECKED)


@pytest.mark.parametrize(("name", "margin"), [("spectral", 0.07), ("tridiagonal", 0.07), ("chip", 0.07)])
def test_power_of_logic_is_near_its_estimate_from_gates(name: str, margin: float) -> None:
    """Three configurations are fitted by two numbers."""
    (line,) = (line for line, entry in recorded.load().items() if entry.get("name") == name)
    config = synthesis.design(run_request.parse(line.split()[2:]))[2]
    logic_mw = cost(config).power_mw - power_mw(0, 0, cost(config).accessed_bits)
    measured = estimate.of_default_library(recorded.load()[line]["figures"]["logic"])
    assert logic_mw == pytest.approx(measured.logic_mw, rel=margin)


def test_two_rows_in_one_transform_halve_the_products_on_the_way_up() -> None:
    """A core that takes several words at a time works the more seldom: lanes cost LUTs, and products no power."""
    one, two, eight = (cost(Configuration(solver="tridiagonal", lanes=lanes)) for lanes in (1, 2, 8))
    product_bits = [sum(m.a * m.b * each.work[m.core] for m in each.multipliers) for each in (one, two, eight)]
    down, up = 14 + 2, 2 + 16
    assert product_bits[0] == product_bits[1] == 27 * 18 * (down + up / 2)
    assert product_bits[2] < product_bits[0] < sum(m.a * m.b for m in one.multipliers)
