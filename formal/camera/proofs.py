# SPDX-License-Identifier: Apache-2.0
"""The proofs of the camera block."""

from __future__ import annotations

from collections.abc import Mapping

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.camera_configuration import FORMATS

CAMERA_PROOFS: tuple[Proof, ...] = (
    Proof(
        "camera_registers",
        "every register as the map has it: words, settings that leave, sticky bits, counters",
        FULL_WIDTH,
    ),
    *(
        Proof(
            "block_weights",
            "the weight of a pixel is its overlap with the block it is in or begins in; the block's last pixel",
            "one counter; ratios of 1, of an integer, below and above 2",
            {"Numerator": numerator, "Denominator": denominator},
        )
        for numerator, denominator in ((1, 1), (3, 1), (4, 3), (15, 4))
    ),
    Proof(
        "round_divide",
        "the nearest integer, ties to even, clipped to 0..255; latency 10",
        "a stage for each bit of the quotient, the same at every width of the divisor",
        {"TotalWidth": 13, "WeightWidth": 2, "Drop": 3},
    ),
    *(
        Proof(
            "row_sums",
            "a word with the last pixel of each block, with the sums of the lanes over it; latency 3",
            "sums are exact at any width",
            {"Numerator": numerator, "Denominator": denominator, "Bayer": bayer},
            depth=30,
        )
        for numerator, denominator, bayer in ((1, 1, 0), (4, 3, 0), (2, 1, 1), (5, 2, 1))
    ),
    *(
        Proof(
            "block_totals",
            "a word with each complete block, with its areas"
            + (" and totals" if totals else "")
            + "; latency 3; memory "
            "as td_ram.sv asks",
            "columns are only counted; totals are left to simulation where a block has several rows",
            {"Numerator": numerator, "Denominator": denominator, "Bayer": bayer, "Totals": totals},
            depth=60,
        )
        for numerator, denominator, bayer, totals in ((1, 1, 0, 1), (3, 2, 0, 0), (5, 2, 1, 0))
    ),
    *(
        Proof(
            "area_average",
            "a word 12 clocks behind each complete block and 18 behind each break, with the marks of its position",
            "rows and columns are only counted; what is complete is proven of row_sums and block_totals",
            {"Rows": rows, "Columns": columns},
            depth=50,
            free=("complete",),
        )
        for rows, columns in ((3, 4), (2, 5))
    ),
    *(
        Proof(
            "black_level",
            "the sample less the black level, beside the gains, of the frame's own settings; latency 1",
            FULL_WIDTH,
            {"Bits": bits, "Channels": channels},
        )
        for bits, channels in ((10, 1), (8, 3))
    ),
    *(
        Proof(
            "pixel_format",
            "samples of the window's pixels with their marks, in order; breaks behind them; latency 1",
            FULL_WIDTH,
            {"Format": FORMATS[form].code, "Phase": phase},
        )
        for form, phase in (
            *(("rgb888", 0), ("rgb565", 0), ("rgb565_bytes", 0), ("raw8", 1), ("raw10", 0), ("raw10_lsb", 2)),
            *(("raw12", 3), ("raw12_lsb", 0)),
        )
    ),
    Proof(
        "pixel_format",
        "YUYV: colours from luma and chroma of the pixel's own pair, in order; latency 3 and 4, breaks 4",
        FULL_WIDTH,
        {"Format": FORMATS["yuyv"].code},
    ),
    *(
        Proof(
            "camera_window",
            "pixels of whole pictures with the marks of the window; faults before its last pixel flagged once, with a "
            "break; an early start kept; latency 1",
            "rows and columns are only counted and compared",
            {"WordsPerPixel": words, "PixelPairs": pairs},
            depth=40,
        )
        for words, pairs in ((1, 0), (1, 1))
    ),
)

CAMERA_WITHOUT_CONTROL: Mapping[str, str] = {
    "camera_front_end": "a chain of proven cores, each of which takes what the one before it sends",
}
