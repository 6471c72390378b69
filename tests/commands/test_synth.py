# SPDX-License-Identifier: Apache-2.0
"""`make synth`: its counts on a tiny grid, the plain rule of memories, and errors for bad input."""

import json
import re
import shutil
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import repository, variables
from commands.cost.cost import cost
from commands.hardware import synth
from commands.hardware.fpga_memory import Memory, memories, path_of
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.sensor.synthetic import synthetic

TINY = Configuration(columns=16, rows=8, solver="tridiagonal", bits_per_channel=1)
XCZU7EV = synth.TARGETS["xczu7ev"]


def memory(depth: Any, width: Any, style: Any = "block") -> Any:
    return Memory("u_ram", depth, width, style, rom=False)


@pytest.mark.parametrize("lanes", [1, 2])
def test_memories_and_cores_are_those_of_the_rtl(tmp_path: Path, lanes: int) -> None:
    tiny = replace(TINY, lanes=lanes)
    _, modules = synth.elaborate(tiny, synthetic(tiny.bits_per_channel), tmp_path, XCZU7EV)
    arrays = memories(tmp_path / "design.json")
    behind_wrapper = Counter(
        (memory.width, memory.depth) for memory in arrays if memory.style and not memory.path.startswith("u_registers.")
    )
    assert behind_wrapper == Counter((memory.width, memory.words) for memory in cost(tiny).memories)
    assert len({memory.path for memory in arrays}) == len(arrays)
    cores = {path_of(module) for module in synth.kept(modules)}
    assert {"u_video.u_guard", "u_contact.u_events", "u_registers"} <= cores
    assert {f"u_poisson.u_solver.{name}" for name in ("u_forward", "u_up", "u_inverse")} <= cores
    assert not cores & {"u_poisson", "u_poisson.u_solver"}


@pytest.mark.regress
def test_the_front_end_of_a_camera_is_a_row_of_its_own(tmp_path: Path) -> None:
    """One multiplier for each channel's gain; the weights are not worth one. The memory is a line of totals."""
    camera = CameraConfiguration((24, 48), (8, 16), "raw8")
    core, arrays = synth.camera_unit(TINY, synthetic(TINY.bits_per_channel), camera, XCZU7EV, tmp_path)
    assert (core.name, core.path) == ("camera_unit", "u_camera")
    assert [(memory.path, memory.depth) for memory in arrays] == [
        ("u_camera.u_front_end.u_average.u_block_totals.u_line", 16)
    ]
    assert core.counts["LUT"] > core.counts["FF"] / 4 > 0
    assert core.counts["DSP48E2"] >= 1


def test_a_multiplication_of_27_by_18_bits_is_one_dsp_with_its_registers(tmp_path: Any) -> None:
    """Map td_dot_product alone to logic: the result is two DSPs and nothing else."""
    for source in repository.sources("td_dot_product"):
        (tmp_path / source.name).write_text(source.read_text().replace("module td_dot_product", f"module {synth.TOP}"))
    lines = [
        f"read_slang --threads 1 --top {synth.TOP} td_dot_product.sv td_multiply.sv",
        f"hierarchy -top {synth.TOP}",
        "proc",
    ]
    cells = synth.mapped(XCZU7EV, lines, [], [], tmp_path, "")
    assert cells["logic"][synth.TOP]["DSP48E1"] == 2
    counts = synth.counted(XCZU7EV, cells, synth.TOP, [], [])
    assert (counts["DSP48E2"], counts["LUT"], counts["FF"]) == (2, 0, 0)
    path = synth.logic_depth(tmp_path / synth.DEPTH)
    assert path["start"].endswith("(DSP48E1.CLK->PCOUT)")
    assert path["end"].endswith("(DSP48E1.PCIN)")
    assert 1.0 < path["ns"] < 2.0
    design = synth.Design({}, {}, {}, {}, [], [], "", 0.0, path)
    assert synth.depth_text(design) == [f"logic depth: {path['ns']:.2f} ns, {path['start']} -> {path['end']}"]


def test_a_memory_that_is_left_out_of_the_mapping_has_no_delay(tmp_path: Path) -> None:
    """Map a sum behind an UltraRAM: the longest path is in the sum."""
    (tmp_path / "top.sv").write_text("""module top (input wire clk, input wire [7:0] in, output logic [7:0] out);
  logic [7:0] word;
  td_ram #(.Width(8), .Depth(4096), .Style(2)) u_ram (.clk, .write_en(1'b1), .write_address({4'd0, in}),
    .write_data(in), .read_en(1'b1), .read_address({4'd1, in}), .read_data(word));
  always_ff @(posedge clk) out <= word + out;
endmodule
""")
    sources = [*repository.packages(), *repository.sources("td_ram")]
    for source in sources:
        shutil.copy(source, tmp_path)
    files = " ".join(dict.fromkeys(source.name for source in sources))
    lines = [f"read_slang --threads 1 -DSYNTHESIS --top top --keep-hierarchy {files} top.sv", "hierarchy -top top"]
    target = replace(XCZU7EV, mappings={"logic": XCZU7EV.mappings["logic"]})
    cells = synth.mapped(target, lines, [], ["td_ram$top.u_ram"], tmp_path, "a memory")
    assert cells["logic"]["top"]["td_ram$top.u_ram"] == 1
    assert 1.0 < synth.logic_depth(tmp_path / synth.DEPTH)["ns"] < 2.0


def test_the_7_series_has_multipliers_of_25_bits_and_no_ultraram(tmp_path: Path) -> None:
    """Map two products and a memory for UltraRAM: 25 x 18 bits are one DSP, 26 x 18 two, and the memory is blocks."""
    (tmp_path / "top.sv").write_text(f"""
module {synth.TOP}(input wire clk, input wire signed [25:0] a, input wire signed [17:0] b, input wire [12:0] place,
  input wire we, output logic signed [42:0] one, output logic signed [43:0] two, output logic [17:0] word);
  (* ram_style = "ultra" *) logic [17:0] words [8192];
  always_ff @(posedge clk) begin
    one <= $signed(a[24:0]) * b;
    two <= a * b;
    if (we) words[place] <= b;
    word <= words[place];
  end
endmodule
""")
    target = synth.SEVEN_SERIES["xc7z020"]
    lines = [f"read_slang --threads 1 --top {synth.TOP} top.sv", f"hierarchy -top {synth.TOP}", "proc"]
    counts = synth.counted(target, synth.mapped(target, lines, [], [], tmp_path, ""), synth.TOP, [], [])
    device = target.device
    assert counts["DSP48E1"] == device.multipliers(25, 18) + device.multipliers(26, 18) == 3
    assert counts["BRAM36"] == device.blocks(8192, 18) == 4
    assert synth.logic_depth(tmp_path / synth.DEPTH)["ns"] > 1


@pytest.mark.regress
@pytest.mark.parametrize("lanes", [1, 2])
def test_a_design_on_the_7_series_has_the_multipliers_and_memories_of_the_model(tmp_path: Path, lanes: int) -> None:
    config, target = replace(TINY, lanes=lanes), synth.SEVEN_SERIES["xc7a35t"]
    design = synth.synthesize(config, synthetic(TINY.bits_per_channel), target, tmp_path)
    assert design.model == {name: design.totals[name] for name in ("DSP48E1", "BRAM36")}
    assert "sum by the model" in synth.text(design, target)


def test_a_device_without_delays_has_no_logic_depth(tmp_path: Path) -> None:
    assert synth.logic_depth(tmp_path / synth.DEPTH) == {}
    (tmp_path / synth.DEPTH).write_text("No timing paths found.\n")
    with pytest.raises(RuntimeError, match="found no path"):
        synth.logic_depth(tmp_path / synth.DEPTH)


@pytest.mark.parametrize(
    ("depth", "width", "ultras", "blocks"),
    [
        (16384, 24, 4, 12),
        (4096, 72, 1, 8),
        (4097, 73, 4, 15),
        (512, 36, 1, 0.5),
        (512, 37, 1, 1),
        (1024, 18, 1, 0.5),
        (1024, 19, 1, 1),
        (65536, 24, 16, 48),
    ],
)
def test_the_plain_rule(depth: np.ndarray, width: int, ultras: Any, blocks: Any) -> None:
    assert memory(depth, width, "ultra").plain()["UltraRAM"] == ultras
    assert memory(depth, width).plain()["BRAM36"] == blocks


def test_style_decides_what_a_memory_takes() -> None:
    assert memory(4096, 72, "ultra").plain() == {"UltraRAM": 1, "BRAM36": 0}
    assert memory(4096, 72, "block").plain() == {"UltraRAM": 0, "BRAM36": 8}
    assert memory(16, 72, "distributed").plain() == {"UltraRAM": 0, "BRAM36": 0}


def test_a_cell_that_nobody_counts_is_an_error() -> None:
    with pytest.raises(RuntimeError, match="RAMS64E"):
        XCZU7EV.counts({"device": Counter(), "logic": Counter({"LUT2": 1, "RAMS64E": 1})}, [])


def test_what_does_not_fit_is_named_with_how_much() -> None:
    assert synth.misfit({"UltraRAM": 96, "BRAM36": 312.0}, XCZU7EV) == ""
    assert synth.misfit({"UltraRAM": 128, "BRAM36": 312.5}, XCZU7EV) == (
        "BRAM36 312.5 of 312, 0.5 too many; UltraRAM 128 of 96, 32 too many"
    )


def test_a_design_too_large_ends_with_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_command: Any) -> None:
    small = replace(XCZU7EV, has={**XCZU7EV.has, "BRAM36": 10})
    monkeypatch.setattr(synth, "TARGETS", {"xczu7ev": small})
    ended = run_command("synth", "PRESET=published", "N=16", "SOLVER=tridiagonal", f"OUT={tmp_path}")
    (error,) = ended.errors
    assert ended.status == 1
    assert error == "make synth: it does not fit the XCZU7EV: BRAM36 13 of 10, 3 too many"
    (design,) = json.loads((tmp_path / "resources.json").read_text())["designs"]
    assert design["misfit"]
    assert not list(tmp_path.glob(".work*"))


def test_a_grid_that_one_solver_has_is_built_with_that_solver() -> None:
    """Build the solver that has the grid; the report names the reason why the other one is missing."""
    of = variables.read(synth.SynthRun, ["PRESET=published", "GRIDS=1024"])
    reasons = {each.solver: reason for each, reason in synth.designs(of.request, of.grids)}
    assert reasons["tridiagonal"] == ""
    assert "1024" in reasons["spectral"]


def test_tables_replace_those_of_the_run_before_and_no_others(tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / synth.ROMS).mkdir(parents=True)
    (out / synth.ROMS / "mine.hex").touch()
    for name in ("first", "second"):
        made = tmp_path / name
        made.mkdir()
        (made / f"{name}.hex").touch()
        synth.keep_sources(made, TINY, out)
    assert {path.name for path in (out / synth.ROMS).glob("*.hex")} == {"mine.hex", "second.hex"}
    assert (out / synth.PARAMETERS).read_text().startswith("Config=")
    script = (repository.ROOT / "constraints" / "xczu7ev_ooc.tcl").read_text()
    assert f"cd [file join $made {synth.ROMS}]" in script
    patterns = [found.split() for found in re.findall(r"\[file join \$root ([^]]*\.sv)\]", script)]
    assert {*repository.sources()} == {path for words in patterns for path in repository.ROOT.glob("/".join(words))}


def test_a_missing_tool(refused: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(synth.yosys, "YOSYS", "/nowhere/yosys")
    assert "run `make setup`" in refused("synth")
