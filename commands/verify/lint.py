# SPDX-License-Identifier: Apache-2.0
"""`make lint`: every checker over every core and over the whole in its structures; any finding fails.

Waivers, each with its reason, are in hdl/verilator.vlt, hdl/verible.rules and slang_lint.py; Yosys, Icarus and mypy
have none, ruff's are in pyproject.toml.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from commands.common import repository, variables
from commands.common import simulator as simulation
from commands.common.signals import threads
from commands.hardware import fpga
from commands.hardware import yosys as yosys_runner
from tactile_depth.calibration.auto_zero import no_floor
from tactile_depth.calibration.flat_field import unit_gains
from tactile_depth.configuration import COLUMNS, POLYNOMIAL, Configuration
from tactile_depth.rom_files import write_floor, write_gains, write_quadratic, write_words
from tactile_depth.sensor import load
from tactile_depth.tactile_depth import top_parameters, write_roms

GRIDS = (16, 128, 512)
TOP = "tactile_depth"
FOLDER = repository.ROOT / "build" / "lint"
BIN = Path(sys.executable).parent
TIMEOUT_S = 300
DEFAULT_ROM = (128, 54)  # words and bits of hdl/common/rom.sv


@dataclass(frozen=True)
class Structure:
    """A top with parameters; without any it is a core at its defaults."""

    top: str
    config: Configuration | None = None

    @property
    def name(self) -> str:
        if self.config is None:
            return self.top
        c = self.config
        colours = f"-{c.gradient_model}" if c.flat_field else ""
        return f"{self.top}-{c.solver}-{'neumann' if c.neumann else 'dirichlet'}-{c.rows}x{c.columns}{colours}"

    @property
    def parameters(self) -> dict[str, int]:
        return {} if self.config is None else top_parameters(self.config)


@dataclass(frozen=True)
class Check:
    """One run of a tool; it gives what the tool says, nothing when all is well."""

    tool: str
    name: str
    run: Callable[[], str]


def modules(files: Iterable[Path]) -> list[str]:
    return [path.stem for path in files if path.stem != "frame_bench" and not path.stem.endswith("_pkg")]


def structures() -> list[Structure]:
    """The whole, both solvers and boundaries, at the smallest, the usual and the largest square grid; flat-fielded."""
    flat = [
        Structure(TOP, Configuration(columns=size, solver=solver, flat_field=True, gradient_model=model))
        for size, solver, model in ((16, "spectral", "quadratic"), (128, "tridiagonal", "lut"))
    ]
    return flat + [
        Structure(TOP, Configuration(columns=size, solver=solver, neumann=neumann))
        for size, solver, neumann in product(GRIDS, COLUMNS, (False, True))
    ]


def told(command: Sequence[str | Path]) -> str:
    """Everything a command prints; a failure without a word is a finding too."""
    result = subprocess.run(
        [str(word) for word in command],
        cwd=repository.ROOT,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    text = (result.stdout + result.stderr).strip()
    return text or (f"exit status {result.returncode}" if result.returncode else "")


# The tools.


def verilator(structure: Structure, files: Sequence[Path]) -> str:
    parameters = [f"-G{name}={value}" for name, value in structure.parameters.items()]
    top = ["--top-module", structure.top]
    return told(
        ["verilator", "--lint-only", "-Wall", "--quiet", *top, *parameters, repository.HDL / "verilator.vlt", *files]
    )


def icarus(structure: Structure, files: Sequence[Path]) -> str:
    top = structure.top
    parameters = [f"-P{top}.{name}={value}" for name, value in structure.parameters.items()]
    return told(["iverilog", "-g2012", "-Wall", "-t", "null", "-s", top, *parameters, *files])


def slang(tops: Sequence[str], parameters: dict[str, int], files: Sequence[Path]) -> str:
    given = [f"-G{name}={value}" for name, value in parameters.items()]
    return told([sys.executable, "-m", "commands.verify.slang_lint", ",".join(tops), *given, *files])


def verible(files: Sequence[Path]) -> str:
    rules = ["--ruleset", "all", "--rules_config", repository.HDL / "verible.rules"]
    return told([BIN / "verible-verilog-lint", *rules, *files])


def yosys(structures: Sequence[Structure], files: Sequence[Path], folder: Path) -> str:
    """Elaborate with slang and check the netlist, one top after another; a warning of Yosys is an error."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in files:
        shutil.copy(path, folder)  # it takes no path outside its working folder
    names = " ".join(path.name for path in files)
    script = folder / "check.ys"
    text = ""
    for structure in structures:
        parameters = "".join(f" -G{name}={value}" for name, value in structure.parameters.items())
        text += (
            f"log checking {structure.name}\ndesign -reset\nread_slang -j 1 --top {structure.top}{parameters} {names}\n"
        )
        text += f"hierarchy -check -top {structure.top}\nproc\nopt_clean\ncheck -assert\n"
    script.write_text(text)
    return yosys_runner.run(script, "-e", ".*", timeout_s=TIMEOUT_S)


def yosys_cores(files: Sequence[Path]) -> str:
    """Every core at its defaults, which are those of the default configurations."""
    folder = FOLDER / "yosys"
    folder.mkdir(parents=True, exist_ok=True)
    for solver in COLUMNS:
        write_roms(folder, load("synthetic"), Configuration(solver=solver))
    words, width = DEFAULT_ROM
    write_words(folder / "rom.hex", range(words), width)
    write_gains(folder, unit_gains(Configuration()))
    write_floor(folder, no_floor(Configuration()), Configuration().depth.width)
    write_quadratic(folder, np.zeros((2, 3, 6), np.int64), POLYNOMIAL.width)
    return yosys([Structure(name) for name in modules(files)], files, folder)


def yosys_structure(structure: Structure, files: Sequence[Path]) -> str:
    folder = FOLDER / f"yosys-{structure.name}"
    folder.mkdir(parents=True, exist_ok=True)
    assert structure.config is not None
    write_roms(folder, load("synthetic"), structure.config)
    return yosys([structure], files, folder)


def columns(files: Iterable[Path], limit: int = 120) -> str:
    """Lines that are too long: verible passes over comments."""
    return "\n".join(
        f"{os.path.relpath(path)}:{number}: {len(line)} columns, at most {limit}"
        for path in files
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if len(line) > limit
    )


def checks() -> list[Check]:
    files = repository.sources()
    benches = sorted((repository.ROOT / "tb").glob("*.sv"))
    boards = [path for sources in fpga.SOURCES.values() for path in sources]
    tops = [Structure(name) for name in modules(boards)]
    cores, whole = [Structure(name) for name in modules(files)], structures()
    found = [Check("verilator", s.name, lambda s=s: verilator(s, files)) for s in (*cores, *whole)]
    found += [Check("icarus", s.name, lambda s=s: icarus(s, files)) for s in (*cores, *whole)]
    found += [Check("verilator", s.name, lambda s=s: verilator(s, [*files, *boards])) for s in tops]
    found += [Check("icarus", s.name, lambda s=s: icarus(s, [*files, *boards])) for s in tops]
    found.append(Check("slang", "cores", lambda: slang(modules(files), {}, files)))
    found.append(Check("slang", "boards", lambda: slang(modules(boards), {}, [*files, *boards])))
    found += [Check("slang", s.name, lambda s=s: slang([s.top], s.parameters, files)) for s in whole]
    found.append(Check("yosys", "cores", lambda: yosys_cores(files)))
    found += [
        Check("yosys", s.name, lambda s=s: yosys_structure(s, files))
        for s in whole
        if s.config is not None and s.config.columns == GRIDS[0]
    ]
    found.append(Check("verible", "rules", lambda: verible([*files, *boards, *benches, *fpga.TECHNOLOGY])))
    found.append(Check("verible", "columns", lambda: columns([*files, *boards, *benches, *fpga.TECHNOLOGY])))
    python = [sys.executable, "-m"]
    found.append(Check("ruff", "check", lambda: told([*python, "ruff", "check", "--quiet", "."])))
    found.append(Check("ruff", "format", lambda: told([*python, "ruff", "format", "--quiet", "--diff", "."])))
    found.append(Check("mypy", "models", lambda: told([*python, "mypy", "--no-error-summary", "models"])))
    return found


def main() -> None:
    with variables.reported("lint"):
        variables.given(sys.argv[1:], ())
        for simulator in simulation.SIMULATORS:
            simulation.check(simulator)
        sys.exit(run())


def run() -> int:
    """Run every check and print what it finds; returns the exit status."""
    begin = time.monotonic()
    found = checks()
    failed: list[str] = []
    with threads(2) as pool:
        pending = [(check, pool.submit(check.run)) for check in found]
        for tool in dict.fromkeys(check.tool for check in found):
            results = [(check, future.result()) for check, future in pending if check.tool == tool]
            bad = [(check, text) for check, text in results if text]
            for check, text in bad:
                print(f"{check.tool} {check.name}:\n{text}")
            failed += [f"{check.tool} {check.name}" for check, _ in bad]
            verdict = f"{len(bad)} NOT clean" if bad else "clean"
            print(f"{tool:10} {len(results):3} checks  {verdict}", flush=True)
    print(
        f"lint: {len(found) - len(failed)} checks clean, {time.monotonic() - begin:.0f} s"
        + (f", {len(failed)} not: {', '.join(failed)}" if failed else "")
    )
    return variables.MISMATCH if failed else variables.EQUAL


if __name__ == "__main__":
    main()
