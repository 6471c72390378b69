# SPDX-License-Identifier: Apache-2.0
"""The ASIC flow: its parser and its sums against numbers by hand, a small core end to end, and bad input."""

import importlib.util
import itertools
import shutil
import subprocess
import sys

import numpy as np
import pytest

from commands.hardware import asic, gate_sim, memory_model, synthesis
from commands.hardware.gate_power import Power, power_of, typical
from commands.hardware.gates import Instance, Netlist, part
from commands.hardware.liberty import boolean, groups_of, read
from commands.hardware.memory_model import Range
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError

LATENCY = 4  # of dot_product

# Two cells. Loads in fF, so energies in fJ; 2 V; leakage in nW.
LIBERTY = """
/* two cells */
library(two) {
  time_unit : "1ns"; voltage_unit : "1V"; current_unit : "1mA"; leakage_power_unit : "1nW";
  capacitive_load_unit (1,ff);
  nom_voltage : 2; nom_temperature : 25;
  power_lut_template(by_load) { variable_1 : total_output_net_capacitance; index_1 ("0, 10"); }
  cell(INV) {
    area : 1; cell_leakage_power : 3;
    pin(A) { direction : input; capacitance : 2; }
    pin(Y) {
      direction : output; function : "(!A)";
      internal_power() {
        related_pin : "A";
        rise_power(by_load) { values ("1, 3"); }
        fall_power(by_load) { values ("2, \\
          6"); }
      }
    }
  }
  cell(DFF) {
    area : 4; cell_leakage_power : 5;
    ff(IQ, IQN) { next_state : "D"; clocked_on : "CK"; }
    pin(CK) { direction : input; capacitance : 1; clock : true;
      internal_power() { rise_power(scalar) { values ("7"); } fall_power(scalar) { values ("9"); } } }
    pin(D) { direction : input; capacitance : 2; internal_power() { power(scalar) { values ("0.5"); } } }
    pin(Q) { direction : output; function : "IQ"; }
  }
}
"""


@pytest.fixture
def library(tmp_path):
    path = tmp_path / "two.lib"
    path.write_text(LIBERTY)
    return read(path)


def test_power_by_hand(library):
    """A flip-flop (net 3) that an inverter (net 4) feeds back, and that is an output: it toggles each clock."""
    gates = [
        Instance("DFF", "", {"CK": [2], "D": [4], "Q": [3]}),
        Instance("INV", "", {"A": [3], "Y": [4]}),
    ]
    netlist = Netlist("toggle", {"clk": ("input", [2]), "q": ("output", [3])}, gates, library, 2)
    load, _ = typical(library)
    assert load == 8  # four inverters
    flip_flop, inverter = power_of(netlist, {3: 1.0, 4: 1.0}, clock_hz=1e6)
    # Both edges of 1 fF at 2 V and 7 + 9 fJ; D takes 0.5 fJ; Q drives 2 fF and an output of 8 fF.
    assert flip_flop.clock == pytest.approx((1 * 4 + 16) * 1e-15 * 1e6)
    assert flip_flop.internal == pytest.approx(0.5e-15 * 1e6)
    assert flip_flop.switching == pytest.approx(0.5 * 10 * 4 * 1e-15 * 1e6)
    assert flip_flop.leakage == pytest.approx(5e-9)
    # Y drives 2 fF: a rise costs 1.4 fJ, a fall 2.8 fJ.
    assert inverter.internal == pytest.approx(2.1e-15 * 1e6)
    assert inverter.switching == pytest.approx(0.5 * 2 * 4 * 1e-15 * 1e6)
    assert inverter.total == pytest.approx((2.1 + 4) * 1e-9 + 3e-9)


@pytest.mark.parametrize(
    ("text", "true_at"),
    [
        ("(!((A B)+C))", {0, 1, 2}),  # A lowest
        ("A^B C", {5, 6}),
        ("A' + B*C'", {0, 2, 3, 4, 6}),
        ("!(A|B)&C", {4}),
    ],
)
def test_boolean(text, true_at):
    table = gate_sim.truth(boolean(text), ["A", "B", "C"])
    assert {i for i in range(8) if table >> i & 1} == true_at


def test_memory_model_meets_what_was_published():
    """Horowitz's three caches; the two macros of GF180MCU; two of those on end, and three side by side."""
    for kilobytes, picojoule in ((8, 10), (32, 20), (1024, 113)):
        energy = memory_model.energy_pj(64, kilobytes * 128, 45, 0.9, write=False).low
        assert energy == pytest.approx(picojoule, rel=0.01)
    assert memory_model.area_um2(8, 64, 180).high == pytest.approx(100_571.5568)
    assert memory_model.area_um2(8, 512, 180).high == pytest.approx(209_400.2768)
    assert memory_model.area_um2(24, 1024, 180).high == pytest.approx(6 * 209_400.2768)
    assert memory_model.energy_pj(24, 1024, 180, 1.8, write=True).high == pytest.approx(3 * 2 * 112.563)
    assert memory_model.area_um2(8, 512, 130).low == pytest.approx(4096 * 2.28 / 0.7)


def test_whole_design_in_gates(library, tmp_path):
    """A stand-in with the ports of the design: a pixel's green is written to a memory and leaves two clocks later."""
    nets = iter(range(10, 200))
    bus = [next(nets) for _ in range(24)]
    rst, valid, last, user, ready, out_valid, late = (next(nets) for _ in range(7))
    read_data, out = [next(nets) for _ in range(8)], [next(nets) for _ in range(8)]
    inverse = [next(nets) for _ in range(8)]
    gates = [
        Instance("DFF", "", {"CK": [2], "D": [valid], "Q": [late]}),
        Instance("DFF", "", {"CK": [2], "D": [late], "Q": [out_valid]}),
        Instance("macro_0", "memory", {
            "clk": [2], "write_en": ["0"], "write_address": ["0"], "write_data": ["0"] * 8,
            "read_en": [valid], "read_address": bus[:4], "read_data": read_data}),
    ]  # fmt: skip
    for i in range(8):
        gates.append(Instance("INV", "", {"A": [read_data[i]], "Y": [inverse[i]]}))
        gates.append(Instance("DFF", "", {"CK": [2], "D": [inverse[i]], "Q": [out[i]]}))
    ports = {
        "clk": ("input", [2]), "rst": ("input", [rst]), "s_axis_tdata": ("input", bus),
        "s_axis_tvalid": ("input", [valid]),
        "s_axis_tlast": ("input", [last]), "s_axis_tuser": ("input", [user]), "s_axis_tready": ("output", ["1"]),
        "m_axis_tready": ("input", [ready]), "m_event_tready": ("input", [next(nets)]),
        "s_axil_bready": ("input", [next(nets)]),
        "s_axil_rready": ("input", [next(nets)]),
        "m_axis_tvalid": ("output", [out_valid]), "m_axis_tdata": ("output", out),
    }  # fmt: skip
    netlist = Netlist("whole", ports, gates, library, 2)
    rng = np.random.default_rng(1)
    words = rng.integers(0, 256, 16)
    initial = "".join(f"{word:08b}" for word in reversed(words))
    pixels = rng.integers(0, 16, 64)
    codes = words[pixels] ^ 255
    macro = gate_sim.Macro(8, 16, initial)
    seen = gate_sim.simulate(netlist, [macro], pixels, codes, 8, 3, [late, *out], range(4, 9), tmp_path)
    assert (seen.clocks, seen.codes, seen.wrong) == (64, 3 * 64 - 1, 0)
    assert seen.accesses == [(1.0, 0.0)]
    steady = np.append(codes[-1], codes)
    assert seen.toggles[out[0]] * 64 == np.count_nonzero(np.diff(steady & 1))
    assert seen.watched == ["1" + f"{codes[i - 2]:08b}"[::-1] for i in range(4, 9)]
    codes[5] ^= 1
    assert gate_sim.simulate(netlist, [macro], pixels, codes, 8, 3, [], range(0), tmp_path).wrong == 3


def test_factors_go_to_the_cores_they_were_measured_on(library):
    """Three inverters: in a timed core, in a core inside it, elsewhere."""
    gates = [Instance("INV", path, {"A": [i], "Y": [i + 1]}) for i, path in ((5, "a"), (7, "a.b"), (9, "c"))]
    netlist = Netlist("three", {"clk": ("input", [2])}, gates, library, 2)
    powers = [Power(clock=1.0, switching=2.0), Power(internal=3.0), Power(leakage=4.0, switching=5.0)]
    timed = [asic.Timed("one", "a", 2, 9, 0, 1.0, 1.5), asic.Timed("two", "a.b", 1, 9, 0, 2.0, 5.0)]
    watts = asic.with_delays(netlist, {"": "three", "a": "one", "a.b": "two", "c": "three"}, powers, timed)
    assert watts == Range((1 + 1.5 * 2) + 2.5 * 3 + (4 + 5), (1 + 1.5 * 2) + 2.5 * 3 + (4 + 2.5 * 5))


def test_report_says_its_figures():
    ends = {"low": 1.25, "high": 98.75}
    report = {
        "command": "make asic",
        "cores": [],
        "library": {"name": "two"},
        "node_nm": 180.0,
        "left_out": asic.LEFT_OUT,
        "timing": {
            "clock_mhz": 80.0,
            "worst_slack_ns": 0.5,
            "fastest_mhz": 83.3,
            "startpoint": "u_a",
            "endpoint": "u_b",
        },
        "area": {"cells": 7, "logic_mm2": 6.05, "memory_bits": 4096, "low_mm2": 11.5, "high_mm2": 61.7},
        "memory_area_mm2": ends,
        "memory_power_mw": ends,
        "memories": [],
        "timed": [],
        "power": {"low_mw": 681.1, "high_mw": 3763.9, "with_delays_mw": {"low": 900.5, "high": 1200.25}}
        | {"zero_delay": {f"{part}_mw": 1.0 for part in ("clock", "internal", "switching", "leakage", "total")}},
    }
    said = asic.table(report)
    for figure in ("681.1 to 3763.9", "11.50 to  61.70", "0.50 ns (83 MHz), u_a to u_b", "5.10", "wires, clock tree"):
        assert figure in said
    page = asic.figure(report)
    assert "900 to 1200" in page.content
    assert "1.2 to 98.8" in page.content


def test_delays_are_made_plain():
    said = """(DELAYFILE (CELL (CELLTYPE "top") (INSTANCE) (DELAY (ABSOLUTE (INTERCONNECT a b (0.1)))))
     (CELL (CELLTYPE "DFF") (INSTANCE c1) (DELAY (ABSOLUTE
       (COND S (IOPATH (posedge CK) Q (0.1::0.3) (0.2::0.25))) (IOPATH CK Q (0.4::0.2))))
       (TIMINGCHECK (SETUP D CK (1))))
     )"""
    assert "(INSTANCE c1) (DELAY (ABSOLUTE (IOPATH CK Q (0.4000) (0.4000))))" in asic.delays(said)


def needs_tools():
    for tool, package in asic.TOOLS.items():
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed: apt-get install {package}")
    if not asic.DEFAULT_LIB.exists():
        pytest.skip(f"{asic.DEFAULT_LIB} is not installed: apt-get install qflow-tech-osu018")
    if importlib.util.find_spec("vcd") is None:
        pytest.skip("pyvcd is not installed: make hardware")


def test_small_core_end_to_end(tmp_path):
    """Cells that compute products, the same toggles from Icarus as from the gates' own functions, more with delays."""
    needs_tools()
    widths = {"AWidth": 6, "BWidth": 5}
    cells = read(asic.DEFAULT_LIB)
    config = Configuration(columns=16)
    reading = synthesis.read(tmp_path, config, top="dot_product", parameters=widths, options="--keep-hierarchy")
    netlist, macros, where = asic.synthesise(tmp_path, reading, "dot_product", asic.DEFAULT_LIB, cells, 5.0)
    assert not macros
    assert where == {"": "dot_product", "u_product0": "multiply", "u_product1": "multiply"}
    stages = 2 * (6 + 5) + 11 + 11 + 11 + 11 + 12  # operands, twice for the second pair; products; the sum
    assert len(netlist.flip_flops()) == stages

    names = {name: bits for name, (_, bits) in netlist.ports.items()}
    rng = np.random.default_rng(2)
    operands = {name: rng.integers(-(1 << w - 1), 1 << w - 1, 40) for name, w in
                (("a0", 6), ("b0", 5), ("a1", 6), ("b1", 5))}  # fmt: skip
    values, tables = {"0": 0, "x": 0, "1": 1, names["en"][0]: 1}, gate_sim.Tables()
    order, held = gate_sim.in_order(netlist), [(instance, cell) for _, instance, cell in netlist.flip_flops()]
    settled = []
    for clock in range(40):
        for name, numbers in operands.items():
            values |= {bit: int(numbers[clock]) >> i & 1 for i, bit in enumerate(names[name])}
        following = {}
        for instance, cell in [*order, *held]:
            for pin, inputs, table in tables.of(cell):
                index = sum(values.get(instance.pins[name][0], 0) << k for k, name in enumerate(inputs))
                (following if cell.flip_flop else values)[instance.pins[pin][0]] = table >> index & 1
        if clock >= LATENCY:
            a0, b0, a1, b1 = (int(operands[name][clock - LATENCY]) for name in ("a0", "b0", "a1", "b1"))
            found = sum(values[bit] << i for i, bit in enumerate(names["sum"]))
            assert found == (a0 * b0 + a1 * b1) % (1 << 12)
            settled.append(dict(values))
        values |= following

    cut = part(netlist, "")
    rows = ["".join(str(state[bit]) for bit in asic.watched_of(cut)) for state in settled]
    timed = asic.run_part(tmp_path / "part", "dot_product", "", cut, rows, 5.0)
    assert timed.wrong == 0
    assert timed.clocks == len(settled) - 1
    toggles = {
        bit: sum(now[bit] != then[bit] for now, then in itertools.pairwise(settled)) / timed.clocks
        for bit in settled[0]
        if isinstance(bit, int)
    }
    data_mw = 1e3 * sum(power.data for power in power_of(cut, toggles, 200e6))
    assert timed.data_zero_delay_mw == pytest.approx(data_mw)
    assert timed.factor > 1


def without(text, cell):
    return text.replace(f"cell({cell})", f"cell({cell}) {{}} other({cell})")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "cannot be read (No such file"),
        ("not liberty at all", "no Liberty file that can be read (not stands where"),
        ("library(a) { cell(b) {", "is not closed"),
        ("cell(b) { }", "holds no library group"),
        (without(LIBERTY, "DFF"), "no flip-flop among its 2 cells"),
        (LIBERTY.replace("nom_voltage : 2;", ""), "nom_voltage is missing"),
        (LIBERTY.replace('"1, 3"', '"1, 3, 5"'), "3 values for 2 points"),
        (LIBERTY.replace("area : 4", "area : four"), "could not convert string"),
        (without(LIBERTY, "INV"), "holds no inverter"),
    ],
)
def test_bad_library(tmp_path, text, said):
    path = tmp_path / "bad.lib"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError) as error:
        read(path).inverter()
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_groups_nest():
    group = groups_of('library("x") { a : "1 2"; b(1, "2,3"); c(d) { e : f; } }')
    assert (group.attributes, group.lists) == ({"a": "1 2"}, {"b": ["1", "2,3"]})
    assert group.groups[0].attributes == {"e": "f"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([f"LIB={__file__}"], "NODE_NM is missing"),
        (["LIB=a.lib", "NODE_NM=90", "CLOCK_MHZ=fast"], "CLOCK_MHZ=fast: accepted is a number"),
        (["NODE_NM=-1", "LIB=a.lib"], "NODE_NM=-1: accepted is a number"),
        (["LIB=a.lib", "NODE_NM=90", "TIMED=nothing"], "TIMED=nothing: no such core"),
        (["LIB=a.lib", "NODE_NM=90", "SOLVER=fast"], "SOLVER=fast is unknown"),
    ],
)
def test_bad_input(arguments, said):
    with pytest.raises(InputError) as error:
        asic.parse(arguments)
    assert said in str(error.value)


def test_missing_tool_is_one_line(tmp_path, monkeypatch):
    path = tmp_path / "two.lib"
    path.write_text(LIBERTY)
    monkeypatch.setattr(asic.shutil, "which", lambda tool: None)
    with pytest.raises(InputError, match="sta is not installed: run `apt-get install opensta`"):
        asic.run(*asic.parse([f"LIB={path}", "NODE_NM=90", f"OUT={tmp_path / 'out'}"]), "")
    assert not (tmp_path / "out").exists()


def test_exit_status():
    result = subprocess.run(
        [sys.executable, "-m", "commands.hardware.asic", "LIB=none.lib", "NODE_NM=90"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    assert result.stderr.startswith("make asic: LIB=none.lib: no such file")
    assert len(result.stderr.splitlines()) == 1
