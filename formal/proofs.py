# SPDX-License-Identifier: Apache-2.0
"""The table of proofs: what is proven of each core, at which sizes, and why these sizes suffice."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from formal.tables import (
    factor_rom,
    floor_rom,
    gain_rom,
    gradient_rom,
    quadratic_roms,
    reciprocal_rom,
    thomas_roms,
    transform_roms,
)
from tactile_depth.contact import contact_events
from tactile_depth.latency import dst_forward_latency, dst_inverse_latency, sdf_fft_latency


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
