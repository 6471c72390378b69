# SPDX-License-Identifier: Apache-2.0
"""Index of the repository: the files of each core in hdl/, models/, tb/ and formal/, by the name of the core.

These folders hold the same units (`hdl/poisson/divergence.sv`, `tb/poisson/tb_divergence.py`), so the index is read
from the tree, and no list is kept by hand.
"""

import importlib
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

from tactile_depth.base.errors import InputError
from tb.structures import Mutants, Structure

ROOT = Path(__file__).resolve().parents[2]
HDL = ROOT / "hdl"
WAIVERS = sorted(HDL.glob("*.vlt"))  # of Verilator
GENERATED = ROOT / "docs" / "generated"  # pages and drawings that commands write as a whole
BOARDS = {name: sorted((ROOT / "boards" / name).glob("*.sv")) for name in ("ulx3s", "nexus")}
TECHNOLOGY = sorted((ROOT / "boards" / "ecp5").glob("*.sv"))  # in place of cores of the same name
PACKAGE = "_pkg"  # end of the name of a SystemVerilog package, which is no core


@dataclass(frozen=True)
class Core:
    """Files of one core. A file that does not exist is None."""

    name: str
    block: str  # folder below hdl/, "" for the top
    hdl: Path
    model: Path | None
    benches: tuple[Path, ...]  # cocotb testbenches: tb_<name>.py, or the tb_*.py of a folder <name>
    proof: Path | None

    @property
    def bench_folder(self) -> Path:
        """Return the folder of a testbench of several files."""
        return ROOT / "tb" / self.block / self.name

    @property
    def settings(self) -> Path | None:
        """Return the file that states the builds, mutants and proofs: the testbench, or settings.py of its folder."""
        return self.benches[0] if len(self.benches) == 1 else _existing(self.bench_folder / "settings.py")


def _existing(path: Path) -> Path | None:
    return path if path.is_file() else None


def _benches(folder: Path, name: str) -> tuple[Path, ...]:
    file = folder / f"tb_{name}.py"
    return (file,) if file.is_file() else tuple(sorted((folder / name).glob("tb_*.py")))


@cache
def _files() -> Mapping[str, Path]:
    return {file.stem: file for file in sorted(HDL.rglob("*.sv"), key=lambda file: file.stem)}


@cache
def cores() -> Mapping[str, Core]:
    """Return every core of hdl/ by name, in the order of the names."""
    index = {}
    for name, file in _files().items():
        folder = file.parent.relative_to(HDL)
        if name.endswith(PACKAGE):
            continue
        index[name] = Core(
            name,
            "" if folder == Path() else str(folder),
            file,
            _existing(ROOT / "models" / "tactile_depth" / "chip" / folder / f"{name}.py"),
            _benches(ROOT / "tb" / folder, name),
            _existing(ROOT / "formal" / folder / f"fv_{name}.sv"),
        )
    return MappingProxyType(index)


def units() -> list[str]:
    """Return the units of the tops and of the boards: `<folder>_unit` in each folder of hdl/ that has one."""
    return [core.name for core in cores().values() if core.name == f"{core.block}_unit"]


def chosen(names: str) -> list[str]:
    """Return the names of the cores in a value of CORE=a,b. Raises InputError: a name is no core."""
    wanted = [name.strip() for name in names.split(",")]
    unknown = [name for name in wanted if name not in cores()]
    if unknown:
        raise InputError(f"CORE={','.join(unknown)}: no such core; accepted are {', '.join(cores())}")
    return wanted


def tested(names: Sequence[str]) -> list[str]:
    """Return the cores whose testbenches test the cores with these names: a unit without one through its top.

    Raises InputError: a core has no testbench.
    """
    without = [name for name in names if name in units() and stated(name, "STRUCTURES") is None]
    tops = dict.fromkeys(without, "tactile_depth") | {"camera_unit": "tactile_sensor"}
    found = list(dict.fromkeys(tops.get(name, name) for name in names))
    for core in (cores()[name] for name in found):
        if not core.benches:
            file = Path("tb", core.block, f"tb_{core.name}.py")
            raise InputError(f"{core.name} has no testbench {file}: see 'Add a core' in CONTRIBUTING.md")
    return found


def sources(top: str | None = None, without: Iterable[str] = ()) -> list[Path]:
    """Return the files of hdl/ that a core needs, itself among them, packages first; all of them if top is None.

    The cores `without` are left out, with what only they need.
    """
    files = _files()
    packages = {name for name in files if name.endswith(PACKAGE)}
    needed = set(files)
    if top is not None:
        needed, waiting = set(packages), [top]
        while waiting:
            name = waiting.pop()
            needed.add(name)
            waiting += [used for used in _instances(files[name]) if used in files and used not in needed | {*without}]
    return [files[name] for name in sorted(needed, key=lambda name: (name not in packages, name))]


def packages() -> list[Path]:
    """Return the packages of hdl/."""
    return [path for path in sources() if path.stem.endswith(PACKAGE)]


@cache
def _instances(file: Path) -> list[str]:
    """Return the names of what may be modules that a file instantiates."""
    return re.findall(r"^ +(\w+) (?:#\(|u_\w+ \()", file.read_text(), re.MULTILINE)


Cores = Annotated[list[str], lambda argument: chosen(argument.value), "CORE"]


@cache
def outermost() -> Sequence[str]:
    """Return the cores that no other core uses: together they contain all others."""
    inside = {path.stem for name, core in cores().items() for path in sources(name) if path != core.hdl}
    return [name for name in cores() if name not in inside]


def stated(core: str, name: str) -> Any:
    """Return what the bench of a core states under a name (tb/structures.py), None if it states nothing."""
    file = cores()[core].settings
    return getattr(importlib.import_module(module(file)), name, None) if file else None


def code(text: str) -> str:
    """Return SystemVerilog without comments, each run of white space as one space."""
    return " ".join(re.sub(r"//.*|/\*.*?\*/", "", text).split())


def structures(core: str) -> list[Structure]:
    """Return the structures of a core that are mutated, and that run as netlists; none for a unit."""
    return [structure for structure in stated(core, "STRUCTURES") or () if structure.mutants]


def mutants(core: str) -> Mutants:
    """Return the settings of a core for its mutants."""
    return stated(core, "MUTANTS") or Mutants()


def git(*words: str) -> bytes | None:
    """Return the output of a git command in the root of the repository, None if it fails."""
    ended = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, check=False)
    return ended.stdout if ended.returncode == 0 else None


def module(file: Path) -> str:
    """Return the name under which a Python file of the repository is imported."""
    return ".".join(file.relative_to(ROOT).with_suffix("").parts)


def testbench(top: str) -> str:
    """Return the modules of the cocotb testbench of a top level, with commas: of a core, or of a part of a board."""
    core = cores().get(top)
    files = core.benches if core else _benches(ROOT / "tb" / "boards", top)
    if not files:
        raise KeyError(f"no testbench of {top}")
    return ",".join(map(module, files))
