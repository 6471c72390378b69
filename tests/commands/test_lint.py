# SPDX-License-Identifier: Apache-2.0
"""make lint: each tool reports the defects that it must find, and a correct module passes all tools."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository, simulator
from commands.verify import items, lint
from commands.verify.slang_lint import WAIVERS, findings, instantiated, waiver
from conftest import chosen_structures
from tactile_depth.chip.configuration import Configuration
from tb.settings import RUN

HEADER = """\
// SPDX-License-Identifier: Apache-2.0
module seeded (
  input  logic              clk,
  input  logic              choose,
  input  logic signed [7:0] a,
  input  logic        [7:0] u,
  output logic signed [7:0] y
);

"""

SOUND = "  always_ff @(posedge clk) y <= choose ? a : $signed(u);\n"
CHILD = "\nmodule child (\n  input  logic x,\n  output logic z\n);\n  assign z = !x;\nendmodule\n"

# Seeded defects: the body of the module, and the tools that must report it.
DEFECTS = {
    "undriven signal": (
        "  logic signed [7:0] b;\n  always_ff @(posedge clk) y <= choose ? a + $signed(u) : b;\n",
        {"verilator", "slang"},
    ),
    "unused signal": (SOUND + "  logic [7:0] b;\n  assign b = u;\n", {"verilator", "slang"}),
    "narrowing": (
        "  logic signed [15:0] b;\n  assign b = a * a;\n  always_ff @(posedge clk) y <= choose ? b : $signed(u);\n",
        {"verilator", "slang"},
    ),
    "widening": (
        "  logic [15:0] b;\n  assign b = u;\n  always_ff @(posedge clk) y <= choose ? a : $signed(b[15:8]);\n",
        {"verilator", "slang"},
    ),
    "comparison of signed with unsigned": (
        "  always_ff @(posedge clk) y <= choose && a < u ? a : $signed(u);\n",
        {"slang"},
    ),
    "sum of signed and unsigned, widened": (
        "  logic signed [8:0] b;\n  assign b = 9'(a + u);\n"
        "  always_ff @(posedge clk) y <= choose ? b[8:1] : $signed({7'd0, b[0]});\n",
        {"slang"},
    ),
    "two registers drive one": (SOUND + "  always_ff @(posedge clk) y <= a;\n", {"slang", "yosys"}),
    "two assignments drive one": (
        "  logic signed [7:0] b;\n  assign b = a;\n  assign b = $signed(u);\n"
        "  always_ff @(posedge clk) y <= choose ? a : b;\n",
        {"verilator", "slang", "yosys", "icarus"},
    ),
    "latch": ("  always_comb if (choose && clk) y = a + $signed(u);\n", {"verilator", "slang", "yosys"}),
    "undeclared identifier": (SOUND + "  assign b = u[0] ^ choose;\n", {"verilator", "slang", "icarus"}),
    "missing port": (
        "  logic z;\n  child u_child (.z);\n" + SOUND.replace("choose", "choose ^ z") + "\nendmodule\n" + CHILD,
        {"verilator", "slang", "yosys", "icarus"},
    ),
    "blocking assignment to a register": (
        "  always_ff @(posedge clk) y = choose ? a : $signed(u);\n",
        {"verilator", "verible"},
    ),
    "index out of range": (
        "  always_ff @(posedge clk) y <= choose && u[8] ? a : $signed(u);\n",
        {"verilator", "slang", "yosys", "icarus"},
    ),
    "combinational loop": (
        "  logic b, c;\n  assign b = c ^ u[0];\n  assign c = b ^ choose;\n"
        "  always_ff @(posedge clk) y <= b ? a : $signed(u);\n",
        {"verilator", "yosys"},
    ),
    "always @*": ("  always @* y = choose && clk ? a : $signed(u);\n", {"verible"}),
    "a long line": (SOUND + "  logic " + "b" * 120 + ";\n", {"verible"}),
}


def reported(tool: str, folder: Path, body: str) -> str:
    """Return the output of a tool on a module."""
    files = [folder / "seeded.sv"]
    files[0].write_text(HEADER + body + ("" if "endmodule" in body else "\nendmodule\n"))
    structure = lint.Structure("seeded")
    if tool == "verilator":
        return lint.verilator(structure, files)
    if tool == "icarus":
        return lint.icarus(structure, files)
    if tool == "slang":
        return lint.slang(["seeded"], {}, files)
    if tool == "verible":
        return lint.verible(files)
    return lint.yosys([structure], lambda _: files, folder / "yosys")


TOOLS = ("verilator", "icarus", "slang", "verible", "yosys")


@pytest.fixture(autouse=True)
def tools() -> None:
    simulator.check("verilator")
    simulator.check("icarus")


@pytest.mark.parametrize("tool", TOOLS)
def test_a_sound_module_passes(tmp_path: Path, tool: Any) -> None:
    assert not reported(tool, tmp_path, SOUND)


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_seeded_defect_is_seen(tmp_path: Path, defect: Any) -> None:
    body, tools = DEFECTS[defect]
    assert tools == {tool for tool in sorted(tools) if reported(tool, tmp_path, body)}


def test_every_tool_sees_some_defect() -> None:
    assert set().union(*(tools for _, tools in DEFECTS.values())) == set(TOOLS)


def test_every_tool_looks_at_every_core_and_at_the_whole() -> None:
    cores = set(repository.cores())
    designs = {structure.name for structure in lint.structures()}
    names = {tool: {check.name for check in lint.checks() if check.tool == tool} for tool in TOOLS}
    for tool in ("verilator", "icarus"):
        assert cores | designs <= names[tool]
    for tool in ("slang", "yosys"):
        assert set(lint.modules(repository.sources())) == cores
        assert "cores" in names[tool]
    assert designs <= names["slang"]
    assert len(names["yosys"] & designs) == 6  # both solvers, both boundaries, the quadratic model, and lanes
    assert {(s.config.solver, s.config.neumann) for s in lint.structures() if s.name in names["yosys"]} == {  # type: ignore[union-attr]
        (solver, neumann) for solver in ("spectral", "tridiagonal") for neumann in (False, True)
    }


def test_yosys_sees_every_core_in_make_test() -> None:
    """Look inside what Yosys checks in `make test`, the outermost cores at their defaults and the small designs."""
    files, names = repository.sources(), {check.name for check in lint.checks() if check.tool == "yosys"}
    seen = instantiated(repository.outermost(), files, {})
    for structure in lint.structures():
        if structure.name in names:
            seen |= instantiated([structure.top], files, structure.parameters)
    assert set(repository.cores()) - seen == set()


def test_verilator_plays_every_core_in_make_test() -> None:
    """A core that another one contains plays alone on Icarus; look inside the builds that play on Verilator."""
    seen: set[str] = set()
    for core in ("tactile_depth", *repository.outermost()):
        for structure, late in chosen_structures("verilator", repository.stated(core, "STRUCTURES"), inside=False):
            if not late:
                parameters = {name: str(value) for name, value in structure.parameters.items()}
                seen |= instantiated([core], repository.sources(), parameters)
    assert set(repository.cores()) - seen == set()


@pytest.mark.parametrize("lanes", [2, 4, 8])
@pytest.mark.parametrize("columns", [16, 64])
def test_verilator_has_no_warning_with_any_lanes(lanes: int, columns: int) -> None:
    """A warning ends a run of make sim."""
    config = Configuration(columns=columns, solver="tridiagonal", lanes=lanes)
    assert not lint.verilator(lint.Structure(lint.TOP, config), repository.sources())


@pytest.mark.parametrize("first", [True, False])
def test_a_time_scale_of_the_user_gives_no_warning(tmp_path: Path, first: bool) -> None:
    """Lint a core with a file of another design, which has a time scale, in front of it or behind it."""
    other = tmp_path / "other.sv"
    instance = ".clk(1'b0), .write_en(1'b0), .write_address('0), .write_data('0), .read_en(1'b0), .read_address('0)"
    other.write_text(f"`timescale 1ns/1ps\nmodule other;\n  td_ram u_ram ({instance}, .read_data());\nendmodule\n")
    files = [other, *repository.sources("td_ram")] if first else [*repository.sources("td_ram"), other]
    command = [simulator.VERILATOR, "--lint-only", "-Wall", "-Wno-PINCONNECTEMPTY", "--top-module", "other"]
    ended = subprocess.run(
        [*command, *map(str, [*repository.WAIVERS, *files])], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, "%Warning" in ended.stderr) == (0, False), ended.stderr


def test_waivers_fit_old_versions_and_paths_from_the_root() -> None:
    """Lint with paths that begin with hdl/, and keep what Verilator 5.006 does not know in a file of its own."""
    rules = {path.stem: set(re.findall(r"-rule (\w+)", path.read_text())) for path in repository.WAIVERS}
    known = {"PINCONNECTEMPTY", "TIMESCALEMOD", "UNOPTFLAT", "UNUSEDPARAM", "UNUSEDSIGNAL"}  # to 5.006
    assert rules["verilator"] <= known
    assert not rules["verilator"] & rules["verilator_5038"]
    files = [path.relative_to(repository.ROOT) for path in (*repository.WAIVERS, *repository.sources())]
    command = [simulator.VERILATOR, "--lint-only", "-Wall", "--top-module", lint.TOP, *map(str, files)]
    ended = subprocess.run(command, cwd=repository.ROOT, capture_output=True, text=True, check=False)
    assert (ended.returncode, "%Warning" in ended.stderr) == (0, False), ended.stderr


def test_no_waiver_of_slang_is_idle() -> None:
    files, boards = repository.sources(), lint.board_sources()
    cores = findings(lint.modules(files), files)
    waived = {
        waiver(f) for f in (*cores, *findings(lint.modules(boards), [*files, *boards, *lint.wrappers_of_boards()]))
    }
    assert set(WAIVERS) <= waived


def test_a_finding_fails_its_item_and_is_in_the_table() -> None:
    item = items.Item("test", "a finding", 1.0, {"check": "verilator td_ram"})
    text = lint.table([item, items.Item("test", "", 1.0, {"check": "icarus td_ram"})])
    assert text.startswith("verilator td_ram:\na finding\n")
    assert text.endswith("lint: 1 checks clean, 1 not: verilator td_ram")
    with pytest.raises(pytest.fail.Exception, match="a finding"):
        test_nothing_is_found(lint.Check("tool", "bad", lambda: "a finding"), lambda *_: None)


def test_a_core_is_checked_alone() -> None:
    names = [check.label for check in lint.checks_of(["transpose"])]
    assert names[:2] == ["verilator transpose", "icarus transpose"]
    assert names[2:] == ["slang cores", "yosys cores", "verible rules", "verible columns", "ruff check", "ruff format"]


CHECKS = lint.checks_of(RUN.cores) if RUN.cores else lint.checks()
# For `make lint` and `make regress` alone: larger grids of a structure, cores by themselves in Yosys, which sees them
# inside the outermost ones, and types in testbenches and tests.
DESIGNS = () if RUN.cores else lint.structures()
LARGER = {s.name for s in DESIGNS if s.config and s.config.columns > lint.GRIDS[0] and not s.config.flat_field}


def marks(check: lint.Check) -> list[pytest.MarkDecorator]:
    """Return the marks of the item of a check: the longest begin first."""
    is_late = check.name in LARGER or (check.label == "yosys cores" and not RUN.cores) or check.label == "mypy tests"
    return [pytest.mark.long] * (check.tool == "mypy") + [pytest.mark.regress] * is_late


@pytest.mark.lint
@pytest.mark.parametrize("check", [pytest.param(check, marks=marks(check), id=check.label) for check in CHECKS])
def test_nothing_is_found(check: lint.Check, record_property: Callable[[str, object], None]) -> None:
    record_property("check", check.label)
    if text := check.run():
        pytest.fail(text, pytrace=False)
