# SPDX-License-Identifier: Apache-2.0
"""The table of proofs: what is proven of each core, at which sizes, and why these sizes suffice."""

from __future__ import annotations

from collections.abc import Mapping

from commands.common.repository import units
from formal.camera.proofs import CAMERA_PROOFS, CAMERA_WITHOUT_CONTROL
from formal.entries import FULL_WIDTH, ONE_ORDER, ROUNDING, WORD_FREE, Cone, Proof
from formal.tables import (
    camera_list,
    factor_rom,
    gain_rom,
    gradient_rom,
    quadratic_roms,
    reciprocal_rom,
    thomas_roms,
    transform_roms,
    zero_lanes_rom,
    zero_rom,
)
from tactile_depth.common import td_divide, td_node_map
from tactile_depth.contact import centroid, contact_events
from tactile_depth.latency import (
    GAIN_MAP,
    dst_forward_latency,
    dst_inverse_latency,
    sdf_fft_latency,
    zero_offset_latency,
)

PROOFS: tuple[Proof, ...] = (
    *(
        Proof(
            "td_round_saturate",
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
    Proof("td_axis_skid", "no word lost, repeated, reordered or changed; stable under stall; latency 1", WORD_FREE),
    Proof(
        "td_async_fifo",
        "no word lost, repeated, reordered or changed, for clocks of any ratio and wires of any delay below a period; "
        "stable under stall; words and room are seen within 4 clocks of a code's arrival",
        f"codes of three bits, words are only counted; {WORD_FREE}",
        depth=60,
        free=("written_code_q", "fetched_code_q"),
        clocks=2,
    ),
    *(
        Proof(
            "td_burst_counter",
            "position counts the words of a burst, active just as long",
            why,
            {"Words": words},
            depth=20,
        )
        for words, why in ((2, "the smallest"), (8, "one counter, the same logic at every power of two"))
    ),
    *(
        Proof(
            "td_delay_line",
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
        "camera_setup",
        "entries in order; at the end each that is compared was right at last, or one was wrong often in a row; "
        "pins and waits as the list says",
        "a list with every kind of entry",
        {"Bus": 0},
        depth=40,
        roms=camera_list,
        free=("sent", "caught"),
    ),
    Proof(
        "dvp_receive",
        "a front for each frame, its bytes without a hole up to the first without room; each frame given up counted "
        "once; out of the queue the same, from the first front after a reset on",
        "the widths in use; td_async_fifo is proven by itself",
        free=("write_ready", "read_valid", "word"),
        clocks=2,
    ),
    *(
        Proof(
            "threshold_comparator",
            "contact within one clock of a beat with a depth above the threshold, never otherwise",
            f"{FULL_WIDTH}; of several depths, which are only compared, any one decides",
            {"Width": width, "Lanes": lanes},
        )
        for width, lanes in ((24, 1), (4, 2))
    ),
    Proof("beat_sums", "sums, limits and peak of an arbitrary beat, 2 clocks later", "sums are exact at any width"),
    *(
        Proof(
            "contact_sums",
            "area 2 and sums 3 + log2(Lanes) clocks after a frame's last beat; limits and peak enclose what is above, "
            "are attained",
            "positions are only counted; sums are exact at any width; either order of rows; the sums of a beat of "
            "several depths are proven of beat_sums",
            {"BottomFirst": bottom_first, "Columns": columns, "Lanes": lanes},
            depth=30,
        )
        for bottom_first, columns, lanes in ((0, 3, 1), (1, 3, 1), (0, 4, 2), (1, 4, 2))
    ),
    Proof(
        "contact_debounce",
        "touching changes after `debounce` frames in a row that speak against it, and for no other reason",
        "areas are only compared; a count of four frames",
        depth=20,
    ),
    Proof(
        "centroid",
        "both means to the nearest, a fixed number of clocks after the last start",
        f"every area and sum of this width; a bit is found in the same way at any width; {ROUNDING}",
        {"Latency": centroid.cycles(2)},
        depth=40,
    ),
    Proof(
        "record_packets",
        "the newest record kept; whole packets in order, each sent, or lost and said so",
        "words are sent alike; three of them to a packet",
        depth=20,
    ),
    Proof(
        "contact_events",
        "a record at a fixed latency, kept until the next, with number and time of its frame",
        "rows and columns are only counted; whatever sums, area and centroid come out: they have their own proofs",
        {"Rows": 3, "Columns": 8, "Latency": contact_events.latency(3, 8)},
        depth=90,
        free=("sums", "area", "mean_position"),
    ),
    *(
        Proof("td_ram", "a read returns what was last written to its address", WORD_FREE, {"Style": style})
        for style in (0, 1, 2)
    ),
    Proof(
        "depth_gate",
        "all words of a frame that waits, the first ones of one that does not; each looked at once, in time",
        f"words of a frame are only counted; {WORD_FREE}",
        depth=30,
    ),
    Proof(
        "td_banked_table",
        "a frame reads the bank named when it began; the free bank reads as it was written",
        WORD_FREE,
        depth=30,
    ),
    *(
        Proof(
            "td_block_sum",
            "a block's sum written 4 clocks behind its rows; an arbitrary word is added once to its block, to no other",
            "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width",
            {"Signed": signed, "ColumnLog2": column_log2},
            depth=40,
        )
        for signed, column_log2 in ((0, 1), (1, 1), (1, 0))
    ),
    Proof(
        "td_divide",
        "quotient and remainder, or overflow, a fixed number of clocks after the last start",
        "every numerator and divisor; a bit is found in the same way at any width",
        {"DivisorWidth": 3, "QuotientWidth": 4, "Latency": td_divide.cycles(4)},
        depth=30,
    ),
    Proof("td_multiply", "the exact product of every enabled clock's operands", "no control but en; no width enters"),
    Proof(
        "td_dot_product", "the exact sum of two products, 4 enabled clocks later", "no control but en; no width enters"
    ),
    *(
        Proof(
            "td_ramp",
            "an arbitrary word is the first and so many steps, log2(Count) enabled clocks later",
            "sums are exact at any width; no tree, and one of two levels",
            {"Count": count},
        )
        for count in (1, 4)
    ),
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
        "beside a pixel's gains, 10 enabled clocks after it came, stand its own colours, valid and place",
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
            free=("gains", "gain_valid", "gain_position", "colours", "dim"),
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
                "2^k good frames in a row behind a request, done a fixed number of clocks later; memory as td_ram asks",
            ),
            (1, "an arbitrary pixel is added once to its node, and to no other"),
        )
    ),
    *(
        Proof(
            "td_gain_map",
            claim,
            "blocks of 2, where every clock reads a node; a cut row of blocks; weights and sums are exact at any width",
            {"Along": along, "Columns": 4, "Channels": channels, "Latency": GAIN_MAP},
            depth=45,
            roms=gain_rom(4),
            free=("sums",) if along else (),
        )
        for along, channels, claim in (
            (
                0,
                3,
                "down a column: sums of the nodes of the bank named when the frame began; entries read; its latency",
            ),
            (0, 1, "the same of one channel alone"),
            (1, 3, "along a row: gains interpolated between any such sums, rounded to even; its latency"),
        )
    ),
    *(
        Proof(
            "td_node_map",
            claim,
            "a beat of a half, a whole block, two; a cut row of blocks; weights and sums are exact at any width",
            {
                "Along": along,
                "Rows": (2 << block_log2) + 1,
                "Columns": columns,
                "BlockLog2": block_log2,
                "Lanes": lanes,
                "Latency": td_node_map.latency(lanes, block_log2),
            },
            depth=50,
            roms=zero_lanes_rom(2 * (columns >> block_log2), td_node_map.side(lanes, block_log2)),
            free=("sums",) if along else (),
        )
        for along, claim in (
            (0, "down a column: sums of the nodes of the bank named when the frame began; entries read; its latency"),
            (1, "along a row: words interpolated between any such sums, rounded to even; its latency"),
        )
        for columns, block_log2, lanes in ((8, 2, 2), (4, 1, 2), (8, 1, 4))
    ),
    *(
        Proof(
            "zero_capture",
            "2^k frames behind a request, each node written once, 6 clocks behind its block, done after 7; memory as "
            "td_ram.sv asks; of several lanes all a clock later, depths of a block in a beat added up",
            "two rows of blocks and a cut one, and a single whole one; rows, columns and frames are only counted; a "
            "beat of a block, and of two",
            {"Sums": 0, "Rows": rows, "Columns": 4 * lanes, "Lanes": lanes},
            depth=60,
        )
        for rows, lanes in ((5, 1), (2, 1), (3, 2), (3, 4))
    ),
    Proof(
        "zero_capture",
        "an arbitrary depth is added once to its node, and to no other; a zero offset is the mean, ties to even",
        f"a cut row of blocks; sums are exact at any width; {ROUNDING}",
        {"Sums": 1, "Rows": 3},
        depth=60,
    ),
    *(
        Proof(
            "zero_offset",
            "the depths of an arbitrary beat less whatever td_gain_map or td_node_map holds, saturated, counted "
            "if clipped, with their marks; its latency; active while a frame is inside; zero offsets read back",
            f"subtraction is exact at any width; {ROUNDING}; td_gain_map and td_node_map are proven by themselves",
            {"Rows": 2, "Lanes": lanes, "Latency": zero_offset_latency(lanes, 1)},
            depth=45,
            roms=zero_rom,
            free=("zero_words",),
        )
        for lanes in (1, 2)
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
            {"Columns": size, "ToBurst": to_burst},
            depth=2 * size + 12,
        )
        for size in (4, 8)
        for to_burst in (0, 1)
    ),
    *(
        Proof(
            "corner_turn",
            "an arbitrary word at its place in its row, rows in turn; latency 3 from the last word of a row",
            f"{ONE_ORDER}; two lanes, and the fewest with more than one memory for each half; {WORD_FREE}",
            {"Columns": size, "Lanes": lanes},
            depth=36,
        )
        for size, lanes in ((4, 2), (8, 4))
    ),
    *(
        Proof(
            "transpose",
            "an arbitrary word at its place in its column; latency 2 from the first word of the last row",
            f"{ONE_ORDER}; {WORD_FREE}",
            {"Columns": 4, "MakhoulIn": makhoul_in, "MakhoulOut": makhoul_out},
            depth=45,
        )
        for makhoul_in, makhoul_out in ((0, 1), (1, 0))
    ),
    *(
        Proof(
            "frame_stack",
            "an arbitrary word at its place, last row first; latency 3 from the first word of the last row",
            "rows, positions and memory rows are only counted; rows and memory rows no power of two, and one; words to "
            f"a memory row that divide a burst, and not; rows that lanes divide, and not, and fewer; {WORD_FREE}",
            {"Rows": rows, "Columns": size, "WordsPerRow": words, "Lanes": lanes},
            depth=3 * rows * size + 5,
        )
        for rows, size, words, lanes in (
            (3, 4, 1, 1),
            (4, 4, 1, 1),
            (3, 4, 2, 1),
            (3, 4, 3, 1),
            (3, 5, 3, 1),
            (2, 3, 3, 1),
            (4, 4, 1, 2),
            (5, 4, 3, 2),
            (3, 8, 1, 4),
        )
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
            {"Columns": size},
            depth=40,
            roms=reciprocal_rom(size),
        )
        for size in (4, 8)
    ),
    Proof(
        "thomas_table",
        "the coefficient of a row and position: base + min(row, settled), in the last row its own; latency 5",
        "every row and position of a table with all its cases; contents do not matter",
        {"Rows": 6, "Columns": 4, "Words": 14},
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
    *(
        Proof(
            "axil_registers",
            "AXI4-Lite rules; every register reads, counts, sticks and clears as docs/registers.md says",
            f"{FULL_WIDTH}; either gradient model, all options",
            {"Quadratic": quadratic},
            depth=16,
        )
        for quadratic in (0, 1)
    ),
    Proof(
        "axil_port",
        "AXI4-Lite rules; each access reaches the registers once, with its own words, and has its own answer",
        FULL_WIDTH,
    ),
    *(
        Proof(
            "table_banks",
            "the bank of an arbitrary table changes with a frame alone, after a commit or a capture; closed until then",
            "all tables, and a build without some",
            {"Present": present},
        )
        for present in (15, 8)
    ),
    *(
        Proof(
            "forward_elimination",
            "the recursion down an arbitrary column" + (", and the mean" if neumann else "") + "; latency 9",
            f"the smallest burst that holds the loop of the recursion; {ROUNDING}",
            {"Rows": 3, "Columns": 8, "Words": 16, "Neumann": neumann},
            depth=60,
            roms=thomas_roms(3, 8, 16, 3, 2, 1),
        )
        for neumann in (0, 1)
    ),
    *(
        Proof(
            "back_substitution",
            "the recursion up an arbitrary column, from lane to lane; latency 8",
            f"z that waits in the memory, and z that goes straight on; {ROUNDING}",
            {"Rows": 3, "Columns": size, "Words": 2 * size, "Lanes": lanes},
            depth=60,
            roms=thomas_roms(3, size, 2 * size, 3, 2, 1),
        )
        for lanes, size in ((1, 8), (2, 16), (2, 8))
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
    *CAMERA_PROOFS,
)

STRUCTURES = tuple(
    Cone(
        "no pixel, no word of a memory, no table reaches a handshake or side-band: the latency is fixed",
        "a structural fact, the same generate blocks at every grid; narrow words, since no bit is left out",
        {"solver": solver, "rows": rows, "columns": 16, "neumann": neumann, "data_width": 12, "coefficient_width": 10}
        | colours,
    )
    for solver, rows in (("spectral", 16), ("tridiagonal", 8))
    for neumann, colours in (
        (0, {}),
        (1, {}),
        (1, {"flat_field": 1, "zero_offset": 1}),
        (0, {"flat_field": 1, "gradient_model": "quadratic"}),
    )
)

# Cores with nothing that a proof here would add to.
WITHOUT_CONTROL: Mapping[str, str] = {
    **dict.fromkeys(
        ("setting_registers", "event_registers", "table_access"),
        "every register and output of it is proven through the port: axil_registers",
    ),
    **dict.fromkeys(units(), "proven cores in a row; what it adds, the testbench of tactile_depth checks"),
    "td_rom": "one read register and no other state; its contents and addresses are proven of those that use it",
    **dict.fromkeys(
        ("spectral_solver", "tridiagonal_solver"),
        "a chain of proven cores, each of which takes what the one before it sends; no control of its own",
    ),
    **CAMERA_WITHOUT_CONTROL,
}
