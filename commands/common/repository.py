# SPDX-License-Identifier: Apache-2.0
"""Index of the repository: the files of each core in hdl/, models/, tb/, tests/ and formal/, by the name of the core.

These folders hold the same blocks (`hdl/transform/sdf_fft.sv`, `tb/transform/tb_sdf_fft.py`), so the index is read
from the tree, and no list is kept by hand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

from tactile_depth.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
HDL = ROOT / "hdl"
PACKAGE = "_pkg"  # end of the name of a SystemVerilog package, which is no core


@dataclass(frozen=True)
class Core:
    """Files of one core. A file that does not exist is None."""

    name: str
    block: str  # folder below hdl/, "" for a core at the root
    hdl: Path
    model: Path | None
    bench: Path | None  # cocotb testbench
    test: Path | None
    proof: Path | None


def _existing(path: Path) -> Path | None:
    return path if path.is_file() else None


@cache
def cores() -> Mapping[str, Core]:
    """Return every core of hdl/ by name, in the order of the names."""
    index = {}
    for file in sorted(HDL.rglob("*.sv"), key=lambda file: file.stem):
        name, folder = file.stem, file.parent.relative_to(HDL)
        if name.endswith(PACKAGE):
            continue
        index[name] = Core(
            name,
            "" if folder == Path() else str(folder),
            file,
            _existing(ROOT / "models" / "tactile_depth" / folder / f"{name}.py"),
            _existing(ROOT / "tb" / folder / f"tb_{name}.py"),
            _existing(ROOT / "tests" / folder / f"test_{name}.py"),
            _existing(ROOT / "formal" / folder / f"fv_{name}.sv"),
        )
    return MappingProxyType(index)


def chosen(names: str) -> list[str]:
    """Return the names of the cores in a value of CORE=a,b.

    Raises
    ------
    InputError
        A name is no core.
    """
    given = [name.strip() for name in names.split(",")]
    unknown = [name for name in given if name not in cores()]
    if unknown:
        raise InputError(f"CORE={','.join(unknown)}: no such core; accepted are {', '.join(cores())}")
    return given


def sources(names: Sequence[str] | None = None) -> list[Path]:
    """Return the files of hdl/ with the given file names, packages first; all of them if names is None.

    Raises
    ------
    KeyError
        A name is no file of hdl/.
    """
    files = {file.name: file for file in HDL.rglob("*.sv")}
    found = list(files.values()) if names is None else [files[name] for name in names]
    return sorted(found, key=lambda file: (not file.stem.endswith(PACKAGE), file.name))


def formal(name: str) -> Path | None:
    """Return the file of formal/ that holds the module with this name, None if there is none."""
    return next((ROOT / "formal").rglob(f"{name}.sv"), None)


def module(file: Path) -> str:
    """Return the name under which a Python file of the repository is imported."""
    return ".".join(file.relative_to(ROOT).with_suffix("").parts)


def testbench(top: str) -> str:
    """Return the module name of the cocotb testbench of a top level: of a core, or of a part of a board."""
    core = cores().get(top)
    file = core.bench if core else _existing(ROOT / "tb" / "boards" / f"tb_{top}.py")
    if file is None:
        raise KeyError(f"no testbench of {top}")
    return module(file)
