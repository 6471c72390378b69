# SPDX-License-Identifier: Apache-2.0
"""Netlist with all mutants of a core and a register that selects one, and runs of the testbench on each mutant.

The structure of the core stands in its bench (tb/structures.py).
"""

import json
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from commands.common import header, repository
from commands.common import simulator as simulation
from tb.settings import RunSettings
from tb.structures import Structure

SELECTOR = "mutsel"
# A register becomes an input (its value) and an output (its next value).
OUTSIDE = """select -set register w:{name} %ci1:+[Q] w:{name} %d
dffunmap @register
expose -evert-dff -sep __ w:{name} @register %u
opt_clean
"""
# Warnings in Verilog of Yosys are off.
AS_IT_IS = """`verilator_config
lint_off -file "*mutants.v"
lint_off -file "*wrapper.sv"
lint_off -rule UNOPTFLAT -file "*mutants.v"
lint_off -rule UNOPTFLAT -file "*wrapper.sv"
"""


def yosys(script: str, folder: Path, name: str) -> None:
    """Run a script of Yosys (the native one of pyosys) in a folder; its log is <name>.log. Raises RuntimeError."""
    (folder / f"{name}.ys").write_text(script)
    code = f"from pyosys import libyosys; libyosys.run_pass('tee -q -o {name}.log script {name}.ys', libyosys.Design())"
    result = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode:
        raise RuntimeError(f"Yosys, {folder / name}.ys: {(result.stdout + result.stderr)[-2000:]}")


def read_commands(core: str, structure: Structure, options: str = "") -> str:
    sources = [str(path) for path in repository.sources(core)]
    parameters = [f"-G {name}={value}" for name, value in structure.parameters.items()]
    return f"read_slang --threads 1 {options} --top {core} {' '.join(parameters)} {' '.join(sources)}"


@dataclass(frozen=True)
class Mutant:
    number: int
    what: str  # description for the report: kind, port of the cell, wire, position in the source


def options(line: str) -> dict[str, str]:
    """Return the options of a line of Yosys' `mutate`, name to the word behind it; the first of several."""
    words = line.split()
    return dict(reversed([*pairwise(words)]))


def described(line: str) -> str:
    option = options(line)
    place = f" {Path(option['-src']).name}" if "-src" in option else ""
    wire = f" {option['-wire']}[{option['-wirebit']}]" if "-wire" in option else ""
    return f"{option['-mode']} {option['-port']}[{option['-portbit']}]{wire}{place}"


def initialised(names: Mapping) -> set[int]:
    """Return the bits with an initial value; `names` are the nets in Yosys' JSON."""
    return {
        bit
        for net in names.values()
        for bit, value in zip(net["bits"], reversed(net["attributes"].get("init", "")), strict=False)
        if value in "01"
    }


def counts(line: str, cells: Mapping, initial: set[int]) -> bool:
    """Return True if a mutant measures the tests.

    A register without a clock does not, nor a constant replaced by itself, nor a constant pin that configures a memory.
    After a register with an initial value Yosys would replace the register by the mutant and lose the value; the pins
    that the register drives are mutated instead.
    """
    option = options(line)
    mode, name, port, bit = (option[f"-{each}"] for each in ("mode", "cell", "port", "portbit"))
    cell = cells[name.removeprefix("\\")]
    driver = cell["connections"][port][int(bit)]
    if port == "Q" and driver in initial:
        return False
    if port.upper().endswith("CLK") or (cell["type"] == "$mem_v2" and isinstance(driver, str)):
        return False
    return driver != mode.removeprefix("const")


def base(core: str, structure: Structure, outside: Sequence[str] = (), flat: bool = True) -> str:
    """Return the script that makes the netlist base.il of a core, and ports.json; unless `flat`, it keeps the cores
    inside.

    The units have no testbenches and become a part of the top. The registers `outside` become ports of the netlist, so
    that a testbench can write them.
    """
    read = read_commands(core, structure, "" if flat else "--keep-hierarchy")
    units = " ".join(f"{unit}$*" for unit in repository.units())
    keep = "setattr -mod -{} keep_hierarchy{} *\n".format
    dissolve = f"{keep('set', ' 1')}setattr -mod -unset keep_hierarchy {units}\nflatten\n{keep('unset', '')}"
    return (
        f"{read}\nprep {'-flatten ' if flat else ''}-top {core}\n"
        f"{'' if flat else dissolve}opt -full\nopt_clean -purge\n"
        f"{''.join(OUTSIDE.format(name=name) for name in outside)}write_rtlil base.il\nwrite_json ports.json\n"
    )


def make(
    core: str, structure: Structure, count: int, seed: int, folder: Path, outside: Sequence[str] = (), flat: bool = True
) -> tuple[list[Mutant], bool]:
    """Write <folder>/mutants.v and mutants.il, module <core>_netlist; return the mutants, and True if there are no
    more.

    `outside` is as in `base`. Unless `flat`, only the core's own cells and the pins of the cores inside are mutated.
    Constant logic is removed first, so that every mutant can have an effect.
    """
    if structure.roms:
        structure.roms(folder)
    width = 12
    control = f"-ctrl {SELECTOR} {width} 1"
    listing = f"mutate -list {2 * count} -seed {seed} {control} -o all.txt {core}\n"
    yosys(base(core, structure, outside, flat) + listing, folder, "list")
    module = json.loads((folder / "ports.json").read_text())["modules"][core]
    every = (folder / "all.txt").read_text().splitlines()
    initial = initialised(module["netnames"])
    lines = [line for line in every if counts(line, module["cells"], initial)][:count]
    (folder / "mutants.txt").write_text("\n".join(lines) + "\n")
    yosys(
        f"read_rtlil base.il\nscript mutants.txt\nflatten\nrename {core} {core}_netlist\nopt_clean\n"
        "write_rtlil mutants.il\n"
        "write_verilog -noattr mutants.v\n",
        folder,
        "mutants",
    )
    made = [Mutant(int(line.partition(" -ctrl ")[2].split()[2]), described(line)) for line in lines]
    return made, len(made) < count and len(every) < 2 * count


def ports(core: str, folder: Path) -> dict[str, tuple[str, int]]:
    """Return the ports of the netlist, name to (direction, bits), without the selector and registers outside."""
    module = json.loads((folder / "ports.json").read_text())["modules"][core]
    return {name: (port["direction"], len(port["bits"])) for name, port in module["ports"].items() if "__" not in name}


def registers_outside(core: str, folder: Path) -> dict[str, int]:
    """Return the registers outside, name to bits."""
    module = json.loads((folder / "ports.json").read_text())["modules"][core]
    return {name[:-3]: len(port["bits"]) for name, port in module["ports"].items() if name.endswith("__q")}


def instance(core: str, folder: Path, selector: str = SELECTOR) -> str:
    """Return Verilog of the cell `netlist` with its registers outside; no mutants without `selector`."""
    outside = registers_outside(core, folder)
    connections = [f".{name}({name})" for name in (*ports(core, folder), *([selector] if selector else []))]
    lines = []
    for name, bits in outside.items():
        lines += [f"  reg [{bits - 1}:0] {name};", f"  wire [{bits - 1}:0] {name}__d;"]
        lines += [f"  always @(posedge clk) {name} <= {name}__d;"]
        connections += [f".{name}__q({name})", f".{name}__d({name}__d)", f".{name}__c()"]
    return "\n".join([*lines, f"  {core}_netlist netlist (", "    " + ",\n    ".join(connections), "  );\n"])


def wrapper(core: str, folder: Path, selector: str = SELECTOR) -> str:
    """Return a module with the ports of the core around the netlist and the selecting register, if any.

    A port that the netlist drives has no value at power-up of its own.
    """
    selecting = f"  logic [11:0] {selector} = 12'd0;\n" if selector else ""
    head = re.sub(r"^( *output .*\w) = [^,\n]*", r"\1", header.read(repository.cores()[core].hdl).text, flags=re.M)
    return f"{head}\n{selecting}{instance(core, folder, selector)}\nendmodule\n"


def run(
    core: str,
    structure: Structure,
    mutants: Sequence[Mutant],
    folder: Path,
    simulator: str,
    jobs: int,
    seed: int,
    repeats: int,
) -> list[dict]:
    """Run the testbench of the core on each mutant; return a dict with the verdict of each, with the core as number 0.

    `repeats`: repetitions of rare cases.

    Raises RuntimeError: the netlist without a mutant fails, or the simulator does.
    """
    (folder / "wrapper.sv").write_text(wrapper(core, folder))
    (folder / "waivers.vlt").write_text(AS_IT_IS)
    build = folder / simulator
    simulation.build(
        simulator,
        core,
        [folder / "waivers.vlt", *repository.packages(), folder / "mutants.v", folder / "wrapper.sv"],
        structure.parameters,
        build,
        fast=True,
        log=folder / "build.log",
    )
    results = folder / f"{simulator}.jsonl"
    results.unlink(missing_ok=True)
    settings = RunSettings(
        full=True,
        repeats=repeats,
        netlist=True,
        level=structure.level,
        device=structure.device,
        mutants={"numbers": [mutant.number for mutant in mutants], "jobs": jobs, "results": str(results)},
    )
    environment = settings.environment | {"OPENBLAS_NUM_THREADS": "1"}
    _, failed = simulation.run(
        core,
        f"tb.mutants,{repository.testbench(core)}",
        build,
        folder,
        simulator=simulator,
        seed=seed,
        environment=environment,
        log=folder / f"{simulator}.log",
    )
    verdicts = [json.loads(line) for line in results.read_text().splitlines()] if results.exists() else []
    if failed or len(verdicts) != len(mutants) + 1:
        reason = f" ({verdicts[0]['reason']})" if verdicts and verdicts[0]["verdict"] != "survived" else ""
        log = folder / f"{simulator}.log"
        raise RuntimeError(f"{core}: the tests fail without a mutant{reason}, or the simulator does: {log}")
    return verdicts
