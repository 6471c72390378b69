# SPDX-License-Identifier: Apache-2.0
"""make asic: parser and sums against numbers by hand, a small core from RTL to power, and bad input."""

import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import repository, variables
from commands.hardware import asic, estimate, gate_sim, memory_model, synthesis
from commands.hardware.gate_power import CLOCK, INTERNAL, LEAKAGE, SWITCHING, power_of, typical
from commands.hardware.gate_sim import Activity, Macro, Stimulus
from commands.hardware.gates import Instance, Netlist, clock_pin, from_yosys, verilog
from commands.hardware.liberty import Cell, Pin, functions, groups_of, read, truth
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.sensor.synthetic import synthetic_for

LATENCY = 4  # of td_dot_product

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
def library(tmp_path: Path) -> Any:
    path = tmp_path / "two.lib"
    path.write_text(LIBERTY)
    return read(path)


def test_power_by_hand(library: Any) -> None:
    """Compute the power of a flip-flop (net 3) that an inverter (net 4) feeds back; it is an output and toggles each
    cycle."""
    gates: list[Any] = [
        Instance("DFF", "", {"CK": [2], "D": [4], "Q": [3]}),
        Instance("INV", "", {"A": [3], "Y": [4]}),
    ]
    netlist = Netlist("toggle", {"clk": ("input", [2]), "q": ("output", [3])}, gates, library, 2)
    load, _ = typical(library)
    assert load == 8  # four inverters
    flip_flop, inverter = power_of(netlist, clock_hz=1e6).of({3: 1.0, 4: 1.0})
    # Both edges of 1 fF at 2 V and 7 + 9 fJ; D takes 0.5 fJ; Q drives 2 fF and an output of 8 fF.
    assert flip_flop[CLOCK] == pytest.approx((1 * 4 + 16) * 1e-15 * 1e6)
    assert flip_flop[INTERNAL] == pytest.approx(0.5e-15 * 1e6)
    assert flip_flop[SWITCHING] == pytest.approx(0.5 * 10 * 4 * 1e-15 * 1e6)
    assert flip_flop[LEAKAGE] == pytest.approx(5e-9)
    # Y drives 2 fF: a rise costs 1.4 fJ, a fall 2.8 fJ.
    assert inverter[INTERNAL] == pytest.approx(2.1e-15 * 1e6)
    assert inverter[SWITCHING] == pytest.approx(0.5 * 2 * 4 * 1e-15 * 1e6)
    assert inverter.sum() == pytest.approx((2.1 + 4) * 1e-9 + 3e-9)


@pytest.mark.parametrize(
    ("text", "true_at"),
    [
        ("(!((A B)+C))", {0, 1, 2}),  # A lowest
        ("A^B C", {5, 6}),
        ("A' + B*C'", {0, 2, 3, 4, 6}),
        ("!(A|B)&C", {4}),
    ],
)
def test_boolean(text: str, true_at: Any) -> None:
    table = truth(text, ["A", "B", "C"])
    assert {i for i in range(8) if table >> i & 1} == true_at


@pytest.mark.parametrize("text", ["", "(A", "A)", "A +", "A @ B", "D", "__import__('os')", "A B C A.B"])
def test_what_is_no_boolean_function_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="is no Boolean function of up to 6 pins: A, B, C"):
        truth(text, ["A", "B", "C"])


def test_flip_flops() -> None:
    group = groups_of('library(a) { ff(IQ, IQN) { next_state : "!D"; clocked_on : "CK"; } }').groups[0]
    pins = {"D": Pin("input", 1, ""), "Q": Pin("output", 0, "IQ"), "QN": Pin("output", 0, "IQN")}
    cell = Cell("DFF", 1, 0, pins, group)
    assert functions(cell) == {"Q": (["D"], 0b01), "QN": (["D"], 0b10)}
    assert clock_pin(cell) == "CK"
    group.attributes["clocked_on"] = "!CK"
    with pytest.raises(InputError, match="the cell DFF was used"):
        clock_pin(cell)
    group.attributes |= {"clocked_on": "CK", "clear": "!R"}
    with pytest.raises(InputError, match="asynchronous reset"):
        clock_pin(cell)


def test_a_memory_has_the_figures_per_bit_of_the_nearest_macro() -> None:
    for ram in memory_model.RAMS:
        assert memory_model.nearest(ram.depth, ram.width) == ram
    assert memory_model.area_um2(512, 64, 45) == pytest.approx(17_301, rel=0.005)
    assert memory_model.area_um2(500, 32, 90) == pytest.approx(4 * 500 * 32 * 5_065.7 / 8_192)
    assert memory_model.energy_pj(512, 64, 45, 1.1) == pytest.approx(5.3)
    assert memory_model.energy_pj(512, 50, 90, 2.2) == pytest.approx(50 / 64 * 5.3 * 2 * 4)
    assert memory_model.leakage_mw(16_384, 24) == pytest.approx(16_384 * 24 * 1.8766 / (2_048 * 39))
    second = memory_model.area_um2(2, 3, 45, two_ports=True) - memory_model.area_um2(2, 3, 45)
    assert second == pytest.approx(6 * 148 * 0.045**2)
    assert memory_model.times_ns(90) == (0.87, 0.1)


LOGIC = {"area_mm2": 0.2, "clock_mw": 20.0, "toggling_mw": 60.0, "leakage_mw": 4.0, "flip_flops": 10_000}


def test_estimate_at_45_nm() -> None:
    """Compare with figures by hand, at twice the clock that the logic was measured at."""
    memories = [[512, 64, 1.0, 1.0], [2048, 39, 1.0, 0.0]]
    result = estimate.at_45_nm(LOGIC | {"clock_mhz": 83.0, "memories": memories})
    one_port = (17_301.4 + 45_478.8) / 1e6
    memory_mw = (2 * 5.3 + 6.855) * 0.166 + 0.8232 + 1.8766
    assert result.logic_mm2 == 0.2
    assert result.logic_mw == pytest.approx(2 * 80 + 4)
    assert result.memory_mm2 == pytest.approx((one_port, one_port + 512 * 64 * 148 * 0.045**2 / 1e6))
    assert result.memory_mw == pytest.approx(memory_mw)
    factors = (100_819 / 96_427, 58_967 / 49_942)
    assert result.placed_mm2 == pytest.approx(
        [0.2 * factor / 0.68 + memory for factor, memory in zip(factors, result.memory_mm2, strict=True)]
    )
    wires = (225.5 / 192.7 - 1, 55.66 / 30.28 - 1)
    trees = (46.784 * 1.3 / 19_807, 19.702 * 1.2 / 4_035)
    assert result.placed_mw == pytest.approx(
        [
            164 + 120 * estimate.capacitances() * wire + 10_000 * tree * 0.166 + memory_mw
            for wire, tree in zip(wires, trees, strict=True)
        ]
    )


@pytest.mark.parametrize("name", estimate.recorded_runs())
def test_ratios_of_one_design_lead_from_another_to_its_recorded_figures(name: str) -> None:
    """The designs have other shares of clock pins, toggling and leakage, and nearly the same ratios."""
    small, large = (estimate.recorded_runs()[name][node] for node in ("at_45", "at_180"))
    result = estimate.of_default_library(large | {"memories": []})
    assert result.logic_mm2 == pytest.approx(small["area_mm2"], rel=0.015)
    assert result.logic_mw == pytest.approx(small["power_mw"], rel=0.015)
    assert small["codes_wrong"] == large["codes_wrong"] == 0


@pytest.mark.parametrize("name", estimate.recorded_runs())
def test_accesses_of_recorded_memories_sum_up_to_what_was_counted(name: str) -> None:
    """That run counted accesses of all memories together; those of each follow from its kind."""
    run = estimate.recorded_runs()[name]["at_45"]
    bits = sum(width * (reads + writes) for _, width, reads, writes in run["memories"])
    assert bits == pytest.approx(run["accessed_bits"], rel=5e-4)


def test_whole_design_in_gates(library: Any, tmp_path: Path) -> None:
    """Simulate a substitute with the ports of the design: green of a pixel goes through a memory and leaves two cycles
    later. It takes pixels because a register begins with 1."""
    nets = iter(range(10, 200))
    bus = [next(nets) for _ in range(24)]
    rst, valid, last, user, ready, out_valid, late, held = (next(nets) for _ in range(8))
    read_data, out = [next(nets) for _ in range(8)], [next(nets) for _ in range(8)]
    inverse = [next(nets) for _ in range(8)]
    gates = [
        Instance("DFF", "", {"CK": [2], "D": [valid], "Q": [late]}),
        Instance("DFF", "", {"CK": [2], "D": [late], "Q": [out_valid]}),
        Instance("DFF", "", {"CK": [2], "D": [held], "Q": [held]}),
        Instance("macro_0", "memory", {
            "clk": [2], "write_en": ["0"], "write_address": ["0"], "write_data": ["0"] * 8,
            "read_en": [valid], "read_address": bus[:4], "read_data": read_data}),  # type: ignore[dict-item]
    ]  # fmt: skip
    for i in range(8):
        gates.append(Instance("INV", "", {"A": [read_data[i]], "Y": [inverse[i]]}))
        gates.append(Instance("DFF", "", {"CK": [2], "D": [inverse[i]], "Q": [out[i]]}))
    ports: dict[str, Any] = {
        "clk": ("input", [2]), "rst": ("input", [rst]), "s_axis_tdata": ("input", bus),
        "s_axis_tvalid": ("input", [valid]),
        "s_axis_tlast": ("input", [last]), "s_axis_tuser": ("input", [user]), "s_axis_tready": ("output", [held]),
        "m_axis_tready": ("input", [ready]), "m_event_tready": ("input", [next(nets)]),
        "s_axil_bready": ("input", [next(nets)]),
        "s_axil_rready": ("input", [next(nets)]),
        "m_axis_tvalid": ("output", [out_valid]), "m_axis_tdata": ("output", out),
    }  # fmt: skip
    netlist = Netlist("design", ports, gates, library, 2, [held])
    rng = np.random.default_rng(1)
    words = rng.integers(0, 256, 16)
    initial = "".join(f"{word:08b}" for word in reversed(words))
    pixels = rng.integers(0, 16, 64)
    codes = words[pixels] ^ 255
    macro = Macro(8, 16, initial)
    stimulus = Stimulus(pixels, codes, columns=8, frames=3, window=range(4, 9))
    delays = {i: {("A", "Y"): (0.2, 0.1), ("CK", "Q"): (0.3, 0.3)} for i in range(len(gates))}
    activity = gate_sim.simulate(netlist, [macro], stimulus, delays, 0.5, tmp_path)
    assert (activity.codes, activity.wrong, activity.wrong_with_delays) == (3 * 64 - 1, 0, 0)
    assert activity.accesses == [(1.0, 0.0)]
    steady = np.append(codes[-1], codes)
    assert activity.toggles[out[0]] * 64 == np.count_nonzero(np.diff(steady & 1))
    in_window = codes[1:7]  # two cycles later
    assert activity.window[out[0]] * 5 == np.count_nonzero(np.diff(in_window & 1))
    assert activity.window_with_delays == activity.window  # no logic that could glitch
    wrong = np.where(np.arange(64) == 5, codes ^ 1, codes)
    assert gate_sim.simulate(netlist, [macro], Stimulus(pixels, wrong, 8, 3, range(0)), {}, 0.5, tmp_path).wrong == 3


def test_registers_begin_as_yosys_has_them(library: Any) -> None:
    names = {"words": {"bits": [7, 8, 9], "attributes": {"init": "1x1"}}, "wire": {"bits": [2, "0"], "attributes": {}}}
    module = {"ports": {"clk": {"direction": "input", "bits": [2]}}, "cells": {}, "netnames": names}
    assert sorted(from_yosys({"modules": {"core": module}}, "core", library).high) == [7, 9]


def activity_of(toggles: Any, window: Any, window_with_delays: Any) -> Any:
    return Activity(9, 0, 0, [(0.5, 0.25)], toggles, window, window_with_delays)


def test_delays_count_for_the_cores_in_which_they_act(library: Any) -> None:
    """Compute the power of two inverters: one in a core that glitches in the window, one in a core that is idle
    there."""
    gates = [Instance("INV", path, {"A": [i], "Y": [i + 1]}) for i, path in ((5, "a"), (9, "b"))]
    netlist = Netlist("two", {"clk": ("input", [2])}, gates, library, 2)
    activity = activity_of({6: 0.2, 10: 0.1}, {6: 0.3}, {6: 0.9})
    rows = {
        row["core"]: row
        for row in asic.core_rows(netlist, {"a": "one", "b": "other"}, power_of(netlist, 1e6), activity)
    }
    assert (rows["one"]["delay_factor"], rows["other"]["delay_factor"]) == (pytest.approx(3), 1)
    still = library.cells["INV"].leakage * library.watt * 1e3
    for name, factor in (("one", 3), ("other", 1)):
        without = sum(rows[name]["without_delays_mw"].values())
        assert rows[name]["with_delays_mw"] == pytest.approx(still + factor * (without - still))


@pytest.mark.parametrize("node_nm", [180.0, 45.0])
@pytest.mark.parametrize("by_ratios", [False, True])
def test_figures(node_nm: float, by_ratios: bool) -> None:
    """Print area and power, the estimate where logic is at 45 nm or leads there, published figures at their node."""
    core = {"core": "one", "cells": 7, "flip_flops": 3, "area_um2": 2e6, "delay_factor": 2.0, "with_delays_mw": 30.0}
    core["without_delays_mw"] = {"clock": 10.0, "internal": 4.0, "switching": 5.0, "leakage": 1.0}
    report = {"node_nm": node_nm, "cores": [core], "power_mw_by_frame": [29.0, 31.0], "codes": 9, "codes_wrong": 0}
    report |= {"clocks_wrong_with_delays": 0, "memories": [[1000, 8, 0.5, 0.25]], "method": asic.METHOD}
    report["timing"] = {
        "worst_slack_ns": 0.5,
        "period_ns": 10.0,
        "clock_mhz": 100.0,
        "fastest_mhz": 105.3,
        "path": "ab",
    }
    report["figures"] = figures = asic.figures(report, 2.0, by_ratios=by_ratios)
    memory_mm2 = memory_model.area_um2(1000, 8, node_nm) / 1e6
    memory_mw = 0.75 * memory_model.energy_pj(1000, 8, node_nm, 2.0) * 100 / 1000
    assert [row["area_mm2"] for row in figures[:3]] == pytest.approx([2, memory_mm2, 2 + memory_mm2])
    assert [row["power_mw"] for row in figures[:3]] == pytest.approx([30, memory_mw, 30 + memory_mw])
    assert "with delays, 29.0 to 31.0 mW in 2 frames; 20.0 mW without" in figures[0]["source"]
    text = asic.text(report)
    assert "worst slack 0.50 of 10.00 ns (105 MHz): a to b" in text
    assert ("placed and routed, at most" in text) == (by_ratios or node_nm == 45)
    assert ("5.10" in text) == ("324.0" in text) == ("another pipeline" in text) == (node_nm == 45 and not by_ratios)


def test_powers_are_the_means_of_frames() -> None:
    frames = [
        [
            {
                "core": "one",
                "cells": 7,
                "delay_factor": x,
                "with_delays_mw": 10 * x,
                "without_delays_mw": dict.fromkeys(asic.NAMES, x),
            }
        ]
        for x in (1.0, 2.0)
    ]
    (row,) = asic.averaged(frames)
    assert row == {"core": "one", "cells": 7, "delay_factor": 1.5, "with_delays_mw": 15.0} | {
        "without_delays_mw": dict.fromkeys(asic.NAMES, 1.5)
    }


def test_delays() -> None:
    text = """(DELAYFILE (CELL (CELLTYPE "top") (INSTANCE) (DELAY (ABSOLUTE (INTERCONNECT a b (0.1)))))
     (CELL (CELLTYPE "DFF") (INSTANCE c1) (DELAY (ABSOLUTE
       (COND S (IOPATH (posedge CK) Q (0.1::0.3) (0.2::0.25))) (IOPATH CK Q (0.4::0.2))))
       (TIMINGCHECK (SETUP D CK (1))))
     (CELL (CELLTYPE "INV") (INSTANCE c20) (DELAY (ABSOLUTE (IOPATH A Y (0.1::0.1) (0.2::0.2))))))"""
    assert asic.delays(text) == {1: {("CK", "Q"): (0.4, 0.4)}, 20: {("A", "Y"): (0.1, 0.2)}}


def needs_tools(*tools: Any) -> None:
    for tool in tools:
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed: apt-get install {asic.TOOLS.get(tool, tool)}")
    if not asic.DEFAULT_LIB.exists():
        pytest.skip(f"{asic.DEFAULT_LIB} is not installed: apt-get install qflow-tech-osu018")


def cell_models(netlist: Any) -> Any:
    """Return the cells as Verilog for Icarus, with paths for an SDF file."""
    lines = ["`timescale 1ns/1ps"]
    for cell in {cell.name: cell for _, _, cell in netlist.gates}.values():
        lines.append(f"module {cell.name} ({', '.join(f'{pin.direction} {name}' for name, pin in cell.pins.items())});")
        paths = []
        for pin, (inputs, table) in functions(cell).items():
            value = f"{1 << len(inputs)}'d{table} >> {{{', '.join(reversed(inputs))}}} & 1'b1"
            if cell.flip_flop:
                lines.append(
                    f"  reg state = 0; always @(posedge {clock_pin(cell)}) state <= {value}; assign {pin} = state;"
                )
            else:
                lines.append(f"  assign {pin} = {value};")
            paths += [f"({cause} => {pin}) = 0;" for cause in ([clock_pin(cell)] if cell.flip_flop else inputs)]
        lines += [f"  specify {' '.join(paths)} endspecify", "endmodule"]
    return "\n".join(lines)


def icarus_toggles(
    folder: Any, netlist: Any, operands: Any, delays: Any, settle_ns: Any, period_ns: Any
) -> dict[Any, Any]:
    """Return the transitions of each net in the second pass of the operands, and the cycles with wrong outputs, by
    Icarus."""
    names = [
        name for name, (direction, _) in netlist.ports.items() if direction == "input" and name not in ("clk", "en")
    ]
    widths = [len(netlist.ports[name][1]) for name in names]
    words = ["".join(f"{int(value) & (1 << w) - 1:0{w}b}" for value, w in zip(row, widths, strict=True))
             for row in zip(*(operands[name] for name in names), strict=True)]  # fmt: skip
    (folder / "operands.txt").write_text("\n".join(words * 2))
    cells = []
    for i, instance, _ in netlist.gates:
        paths = [f"(IOPATH {a} {b} ({rise}) ({fall}))" for (a, b), (rise, fall) in delays.get(i, {}).items()]
        if paths:
            cells.append(f'(CELL (CELLTYPE "{instance.kind}") (INSTANCE c{i}) (DELAY (ABSOLUTE {" ".join(paths)})))')
    head = '(DELAYFILE (SDFVERSION "3.0") (DIVIDER .) (TIMESCALE 1ns)'
    (folder / "part.sdf").write_text("\n".join([head, *cells, ")"]))
    ports = f".clk(clk), .en(1'b1), {', '.join(f'.{name}({name})' for name in names)}"
    declared = " ".join(f"wire [{width - 1}:0] {name};" for name, width in zip(names, widths, strict=True))
    joined = f"{declared} assign {{{', '.join(names)}}} = in;"
    (folder / "part.v").write_text(
        f"{verilog(netlist)}\nmodule part (input clk, input [{sum(widths) - 1}:0] in); {joined} "
        f"{netlist.name} dut ({ports}); endmodule\n{cell_models(netlist)}\n"
    )
    defines = ["-gspecify", "-Ttyp", "-DDELAYS"] if delays else []
    values = {"Inputs": sum(widths), "Clocks": len(words), "Period": period_ns, "Settle": settle_ns}
    command = ["iverilog", "-g2012", *defines, "-s", "asic_part_bench", "-o", "part.vvp"]
    command += [f"-Pasic_part_bench.{name}={value}" for name, value in values.items()]
    subprocess.run([*command, str(repository.ROOT / "tb" / "asic_part_bench.sv"), "part.v"], cwd=folder, check=True)
    subprocess.run(["vvp", "-n", "part.vvp"], cwd=folder, check=True, capture_output=True)
    header, _, changes = (folder / "part.vcd").read_text().partition("$enddefinitions $end")
    codes = {int(net): code for code, net in re.findall(r"\$var wire 1 (\S+) n(\d+) \$end", header)}
    last: dict[Any, Any] = {}
    toggles: Counter[Any] = Counter()
    for value, code in re.findall(r"^([01xz])(\S+)$", changes, re.M):
        toggles[code] += {last.get(code), value} == {"0", "1"}
        last[code] = value
    return {net: toggles[code] for net, code in codes.items()}


def as_design(netlist: Any, operands: Any, widths: Any) -> tuple[Any, ...]:
    """Return a dot product with the ports of the design (pixels are operands, codes are sums), and the pixels."""
    ports = {name: nets for name, (_, nets) in netlist.ports.items()}
    pixels, place = 0, 0
    for name, width in widths.items():
        pixels = pixels + ((operands[name] & (1 << width) - 1) << place)
        place += width
    unused = ("rst", "s_axis_tlast", "s_axis_tuser", "s_axis_tvalid", *gate_sim.ALWAYS_READY[1:])
    design: dict[str, Any] = {name: ("input", [10**6 + i]) for i, name in enumerate(unused)}
    design |= {"s_axis_tready": ("output", ["1"]), "m_axis_tvalid": ("output", design["s_axis_tvalid"][1])}
    design |= {"m_axis_tready": ("input", ports["en"]), "m_axis_tdata": ("output", ports["sum"])}
    design["s_axis_tdata"] = ("input", [bit for name in widths for bit in ports[name]])
    return Netlist("design", design, netlist.instances, netlist.library, netlist.clock), pixels


def test_small_core_end_to_end(tmp_path: Any) -> None:
    """Map a small core: its products are right, its toggles equal those of Icarus, with delays nearly."""
    needs_tools("sta", "c++", "iverilog")
    widths = {"AWidth": 6, "BWidth": 5}
    cells = read(asic.DEFAULT_LIB)
    config = Configuration(columns=16)
    keep = "--keep-hierarchy"
    sensor = synthetic_for(config)
    reading = synthesis.read(tmp_path, config, sensor, top="td_dot_product", parameters=widths, options=keep)
    netlist, macros, where = asic.synthesise(tmp_path, reading, "td_dot_product", asic.DEFAULT_LIB, cells, 5.0)
    assert not macros
    assert where == {"": "td_dot_product", "u_product0": "td_multiply", "u_product1": "td_multiply"}
    stages = 2 * (6 + 5) + 11 + 11 + 11 + 11 + 12  # operands, twice for the second pair; products; the sum
    assert sum(cell.flip_flop is not None for _, _, cell in netlist.gates) == stages

    sdc = tmp_path / "clock.sdc"
    sdc.write_text("create_clock -name clk -period $period_ns [get_ports clk]\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asic, "SDC", sdc)
        slack, delays = asic.timing(tmp_path, netlist, 5.0, 180)
    assert 0 < slack["worst_slack_ns"] < 5
    assert slack["path"][1] in where

    rng = np.random.default_rng(2)
    bits = {"a0": 6, "b0": 5, "a1": 6, "b1": 5}
    operands = {name: rng.integers(-(1 << w - 1), 1 << w - 1, 40) for name, w in bits.items()}
    sums = operands["a0"] * operands["b0"] + operands["a1"] * operands["b1"]
    design, words = as_design(netlist, operands, bits)
    stimulus = Stimulus(words, np.roll(sums, LATENCY), 40, 3, range(1, 41))
    activity = gate_sim.simulate(design, [], stimulus, delays, 0.2, tmp_path)
    assert activity.codes == 3 * 40
    assert activity.wrong <= LATENCY  # those before the first sum
    assert activity.wrong_with_delays == 0

    outputs = {net for _, gate, cell in netlist.gates for pin in cell.outputs for net in gate.pins.get(pin, [])}
    plain = icarus_toggles(tmp_path, netlist, operands, {}, 0.0, 5.0)
    assert {net: round(40 * activity.window[net]) for net in outputs} == {net: plain[net] for net in outputs}
    timed = icarus_toggles(tmp_path, netlist, operands, delays, 0.2, 5.0)
    total, by_icarus = (sum(counts[net] for net in outputs) for counts in (activity.window_with_delays, timed))
    assert 40 * total == pytest.approx(by_icarus, rel=0.02)
    assert total > 1.2 * sum(activity.window[net] for net in outputs)  # glitches


def without(text: str, cell: Any) -> Any:
    return text.replace(f"cell({cell})", f"cell({cell}) {{}} other({cell})")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "can be used ([Errno 2] No such file"),
        ("not liberty at all", "no Liberty file that can be used (not stands where"),
        ("library(a) { cell(b) {", "is not closed"),
        ("cell(b) { }", "holds no library group"),
        (LIBERTY.replace('voltage_unit : "1V"', 'voltage_unit : "1mV"'), "not in V"),
        (without(LIBERTY, "DFF"), "no flip-flop among its 2 cells"),
        (LIBERTY.replace("nom_voltage : 2;", ""), "nom_voltage is missing"),
        (LIBERTY.replace('"1, 3"', '"1, 3, 5"'), "3 values for 2 points"),
        (LIBERTY.replace("area : 4", "area : four"), "could not convert string"),
        (without(LIBERTY, "INV"), "holds no inverter"),
    ],
)
def test_bad_library(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.lib"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError) as error:
        read(path)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_groups_nest() -> None:
    group = groups_of('library("x") { a : "1 2"; b(1, "2,3"); c(d) { e : f; } }')
    assert (group.attributes, group.lists) == ({"a": "1 2"}, {"b": ["1", "2,3"]})
    assert group.groups[0].attributes == {"e": "f"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["LIB=two.lib"], "NODE_NM is missing"),
        ([f"LIB={__file__}"], "no Liberty file that can be used"),
        (["LIB=two.lib", "NODE_NM=90", "CLOCK_MHZ=fast"], "CLOCK_MHZ=fast: accepted is a number"),
        (["NODE_NM=-1", "LIB=two.lib"], "NODE_NM=-1: accepted is a number"),
        (["LIB=two.lib", "NODE_NM=90", "TIMED=td_dot_product"], "TIMED=td_dot_product: unknown variable"),
        (["LIB=two.lib", "NODE_NM=90", "SOLVER=fast"], "SOLVER=fast is unknown"),
    ],
)
def test_bad_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: Any, message: str) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.lib").write_text(LIBERTY)
    with pytest.raises(InputError) as error:
        variables.read(asic.main, arguments)
    assert message in str(error.value)


def test_missing_tool_is_one_line(tmp_path: Path, monkeypatch: Any) -> None:
    path = tmp_path / "two.lib"
    path.write_text(LIBERTY)
    monkeypatch.setattr(asic.shutil, "which", lambda tool: None)
    with pytest.raises(InputError, match="sta is not installed: run `apt-get install opensta`"):
        variables.read(asic.main, [f"LIB={path}", "NODE_NM=90", f"OUT={tmp_path / 'out'}"])
    assert not (tmp_path / "out").exists()
