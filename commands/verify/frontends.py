# SPDX-License-Identifier: Apache-2.0
"""`make frontends`: Yosys' own Verilog front end and slang read every core as the same circuit.

Two front ends that agree are two opinions of what the text means. Each core is read by both at small parameters, with
the ROMs that the models write; registers and memory words are matched by name, and every next state and every output
is proven equal for all inputs and all states that match, so once the states match they do for ever.
"""

from __future__ import annotations

import re
import shutil
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from commands.common import repository, variables
from commands.common.signals import threads
from commands.hardware import yosys
from tactile_depth.calibration.flat_field import unit_gains
from tactile_depth.configuration import Configuration
from tactile_depth.errors import InputError
from tactile_depth.poisson import tridiagonal_solver
from tactile_depth.poisson.spectral_divide import reciprocals
from tactile_depth.rom_files import write_floor, write_gains, write_quadratic, write_words
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import top_parameters, write_roms

FOLDER = repository.ROOT / "build" / "frontends"
TIMEOUT_S = 900

# The smallest grids: sizes decide how many registers there are to match, widths how long each takes.
CHOICES: dict[str, Any] = {"columns": 16, "data_width": 12, "coefficient_width": 10, "bits_per_channel": 1}
SPECTRAL = Configuration(**CHOICES)
SPECTRAL_NEUMANN = Configuration(**CHOICES, neumann=True)
TRIDIAGONAL = Configuration(**CHOICES, rows=8, solver="tridiagonal")
TRIDIAGONAL_NEUMANN = Configuration(**CHOICES, rows=8, solver="tridiagonal", neumann=True)
QUADRATIC = {"Width": 3, "DeviationWidth": 3, "CoeffWidth": 3, "WordWidth": 5}
ROM = {"Width": 7, "Depth": 12}
FIELD = {"Rows": 5, "Columns": 8, "BlockLog2": 1, "Drop": 25, "OutWidth": 4, "Flat": 8}
CAPTURE = {"Rows": 5, "Columns": 8, "BlockLog2": 1, "Width": 12, "GainFraction": 14, "MaxLog2": 2}
FLOOR = {"Rows": 5, "Columns": 8, "BlockLog2": 1, "Width": 5}
WITHIN_THE_WHOLE = {"spectral_solver", "tridiagonal_solver"}


@dataclass(frozen=True)
class Case:
    """A core at some parameters, beside the ROMs of a configuration."""

    core: str
    parameters: dict[str, int] = field(default_factory=dict)
    config: Configuration = SPECTRAL
    label: str = ""

    @property
    def name(self) -> str:
        label = self.label or "-".join(f"{key}{value}" for key, value in self.parameters.items())
        return f"{self.core}-{label}"


def cases() -> list[Case]:
    """Every core of hdl/, in each of its structures; the solvers inside the whole."""
    size, coefficient = SPECTRAL.columns, SPECTRAL.coefficient_width
    fft = {"Size": size, "Width": 6, "CoeffWidth": coefficient}
    transform = fft | {"InWidth": 5, "OutWidth": 5, "OutputDrop": 1}
    twiddle = {"InWidth": 5, "OutWidth": 4, "CoeffWidth": coefficient, "Drop": coefficient - 1, "Size": size}
    butterfly = {"Width": 5, "Size": size}
    table = reciprocals(SPECTRAL)
    divide = {"Size": size, "CoeffWidth": coefficient, "ShiftWidth": table.shift_width, "Drop": table.drop, "Width": 8}
    small = [
        *(Case("auto_zero", FLOOR | {"Rows": rows}) for rows in (3, 5)),
        Case("axil_registers", {"Rows": 16, "Columns": 8, "GradientWidth": 9, "BitsPerChannel": 1}),
        Case("axis_skid", {"Width": 4}),
        Case("burst_counter", {"Size": 8}),
        *(
            Case("contact_events", {"Width": 3, "Rows": 4, "Columns": 8, "BottomFirst": bottom_first})
            for bottom_first in (0, 1)
        ),
        *(Case("delay_line", {"Width": 3, "Delay": delay}) for delay in (1, 3, 6)),
        Case("depth_gate", {"Width": 4}),
        *(Case("divergence", {"Width": 4, "Columns": 8, "Neumann": neumann}) for neumann in (0, 1)),
        Case("multiply", {"AWidth": 5, "BWidth": 4}),
        Case("dot_product", {"AWidth": 5, "BWidth": 4}),
        *(
            Case(core, transform | {"InputDrop": drop, "Alternate": alternate})
            for core in ("dst_forward", "dst_inverse")
            for drop, alternate in ((0, 1), (-1, 0))
        ),
        Case("frame_guard", {"Rows": 5, "Columns": 8}),
        Case("frame_output", {"Width": 4, "Rows": 5, "Columns": 8}),
        *(Case("frame_stack", {"Width": 3, "Rows": 5, "Size": 8, "WordsPerRow": words}) for words in (1, 3)),
        *(Case("flat_field", FIELD | more) for more in ({}, {"Drop": 22, "Offset": 4, "OutWidth": 5, "Flat": 0})),
        *(Case("floor_capture", FLOOR | {"MaxLog2": largest}) for largest in (0, 2)),
        *(Case("frame_tags", {"Width": 4, "Latency": latency, "Pixels": 8}) for latency in (6, 20)),
        *(Case("gain_map", {"Rows": rows, "Columns": 8, "BlockLog2": 1}) for rows in (3, 5)),
        Case("gradient_lookup", {"Width": SPECTRAL.gradient.width, "BitsPerChannel": SPECTRAL.bits_per_channel}),
        Case("mode_pairs", {"Width": 3, "Size": 8}),
        *(Case("quadratic_gradient", QUADRATIC | {"Drop": drop}) for drop in (3, -1)),
        *(Case("ram", {"Width": 3, "Depth": 8, "Style": style}) for style in (0, 1, 2)),
        Case("reference_capture", CAPTURE),
        Case("rom", ROM),
        *(
            Case("round_saturate", {"InWidth": 9, "Drop": drop, "OutWidth": width})
            for drop, width in ((3, 4), (1, 8), (1, 12), (0, 5), (-2, 8), (-2, 14))
        ),
        *(Case("row_reorder", {"Width": 3, "Size": 8, "ToBurst": to_burst}) for to_burst in (0, 1)),
        *(
            Case("sdf_butterfly", butterfly | more)
            for more in (
                {"Delay": 1},
                {"Delay": 8, "Halve": 1},
                {"Delay": 4, "RotateBlock": 16},
                {"Delay": 8, "RotateBlock": 16, "Inverse": 1, "Halve": 1},
            )
        ),
        *(Case("sdf_fft", fft | {"Inverse": inverse}) for inverse in (0, 1)),
        Case("spectral_divide", divide),
        Case("threshold_comparator", {"Width": 5}),
        *(Case("transpose", {"Width": 2, "Size": 8, "MakhoulIn": i, "MakhoulOut": 1 - i}) for i in (0, 1)),
        *(Case("twiddle_multiply", twiddle | {"Block": size, "RealOnly": real}) for real in (0, 1)),
    ]
    whole = []
    for config, boundary in ((SPECTRAL, "dirichlet"), (SPECTRAL_NEUMANN, "neumann")):
        whole.append(Case("tactile_depth", top_parameters(config), config, f"spectral-{boundary}"))
    for config, boundary in ((TRIDIAGONAL, "dirichlet"), (TRIDIAGONAL_NEUMANN, "neumann")):
        solver = tridiagonal_solver.solver_parameters(config)
        shared = {key: solver[key] for key in ("CoeffWidth", "Rows", "Size", "SettledWidth", "LastShiftWidth")}
        row = shared | {"TableWords": solver["TableWords"], "Width": 6}
        mean = {key: solver[key] for key in ("Neumann", "MomentDrop", "MeanReciprocal", "MeanDrop")}
        small.append(Case("thomas_table", shared | {"Words": solver["TableWords"]}, config, boundary))
        small.append(Case("back_substitution", row | {"InWidth": 5, "Lift": 1}, config, boundary))
        small.append(Case("forward_elimination", row | mean | {"StoreDrop": 1, "OutWidth": 5}, config, boundary))
        whole.append(Case("tactile_depth", top_parameters(config), config, f"tridiagonal-{boundary}"))
    return [*whole, *small]


def with_defaults(text: str, parameters: dict[str, int]) -> str:
    """The text of a core with other defaults: `chparam` takes no negative number, and both front ends read the same."""
    for name, value in parameters.items():
        text, count = re.subn(rf"(parameter int {name}\s*=\s*)-?\d+", rf"\g<1>{value}", text)
        if count != 1:
            raise ValueError(f"{name}: {count} parameters of that name")
    return text


def for_read_verilog(text: str) -> str:
    """The same text with a module header's import before the module: Yosys' own front end takes one only there."""
    return re.sub(r"^(module \w+)\n  (import \w+::\*;)", r"\2\n\1", text, flags=re.MULTILINE)


def prepare(core: str, sources: Sequence[Path], parameters: dict[str, int], folder: Path) -> Path:
    """Write sources and script into `folder`; the proof fails unless every pair of matched signals is equal."""
    names: dict[str, list[str]] = {"own": [], "slang": []}
    for source in sources:
        text = source.read_text()
        if source.stem == core:
            text = with_defaults(text, parameters)
        for reader, seen in (("own", for_read_verilog(text)), ("slang", text)):
            name = f"{source.stem}_{reader}.sv"
            (folder / name).write_text(seen)
            names[reader].append(name)
    read = {
        "own": f"read_verilog -sv -defer {' '.join(names['own'])}",
        "slang": f"read_slang -j 1 --top {core} {' '.join(names['slang'])}",
    }
    script = ""
    for unknown in ("zero", "one"):  # an x that only one front end makes shows in one of the two
        for reader, command in read.items():
            script += f"{command}\nhierarchy -check -top {core}\nproc\nflatten\nmemory -nordff\n"
            script += f"setundef -{unknown}\nopt_clean\nrename -top {reader}\ndesign -stash {reader}\n"
        for reader in read:
            script += f"design -copy-from {reader} {reader}\n"
        script += (
            "equiv_make own slang both\nhierarchy -top both\nequiv_simple -short\nequiv_simple\nequiv_status -assert\n"
        )
        script += "design -reset\n"
    path = folder / "prove.ys"
    path.write_text(script)
    return path


def prove(case: Case, folder: Path = FOLDER) -> tuple[str, float]:
    """Return one line on what is wrong with a case, or "", and the seconds it took."""
    begin = time.monotonic()
    place = folder / case.name
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    write_roms(place, synthetic(case.config.bits_per_channel), case.config)
    write_words(place / "rom.hex", (37 * i % (1 << ROM["Width"]) for i in range(ROM["Depth"])), ROM["Width"])
    write_gains(place, unit_gains(case.config))
    write_floor(place, np.arange(8) - 4, FLOOR["Width"])
    half = 1 << QUADRATIC["WordWidth"] - 1
    write_quadratic(place, np.arange(36).reshape(2, 3, 6) % (2 * half) - half, QUADRATIC["WordWidth"])
    problem = yosys.run(prepare(case.core, repository.sources(), case.parameters, place), timeout_s=TIMEOUT_S)
    return problem, time.monotonic() - begin


def main() -> None:
    with variables.reported("frontends"):
        values = variables.given(sys.argv[1:], ("CORE",))
        names = repository.chosen(values["CORE"]) if "CORE" in values else list(repository.cores())
        within = WITHIN_THE_WHOLE.intersection(names)
        if "CORE" in values and within:
            raise InputError(f"CORE={','.join(sorted(within))}: compared within tactile_depth: give CORE=tactile_depth")
        sys.exit(run([case for case in cases() if case.core in names]))


def run(chosen: list[Case]) -> int:
    """Compare both front ends on these cases; returns the exit status."""
    cores = set(repository.cores())
    unknown = cores - {case.core for case in cases()} - WITHIN_THE_WHOLE
    if unknown:
        raise variables.Mismatch(f"no case for {', '.join(sorted(unknown))}")
    begin, failed = time.monotonic(), []
    with threads(2) as pool:
        for case, (problem, seconds) in zip(chosen, pool.map(prove, chosen), strict=True):
            print(
                f"{'DIFFERS' if problem else 'agree':8} {seconds:6.1f} s  {case.name}  {problem}".rstrip(), flush=True
            )
            if problem:
                failed.append(case.name)
    verdict = f"{len(chosen) - len(failed)} of {len(chosen)} structures read alike by both front ends"
    print(f"{verdict}, {time.monotonic() - begin:.0f} s" + (f"; not: {', '.join(failed)}" if failed else ""))
    return variables.MISMATCH if failed else variables.EQUAL


if __name__ == "__main__":
    main()
