# SPDX-License-Identifier: Apache-2.0
"""block_totals against its model: frames of random sums and of extremes, whole and cut short, gaps, pauses, resets;
frames that no camera sends, with a sum in each clock and rows of any colours.
"""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.camera.block_totals import LATENCY, block_areas, block_totals
from tactile_depth.chip.camera.row_sums import sums_over_blocks
from tb.camera.slots import Slot, Slots, Window, packed, unpacked
from tb.cases import on_bench
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, Structure


def built(columns: int, numerator: int, denominator: int, width: int, bayer: int, **runs: Any) -> Structure:
    ratio = {"Numerator": numerator, "Denominator": denominator}
    return Structure({"Columns": columns, **ratio, "Width": width, "Bayer": bayer}, **runs)


STRUCTURES = (
    built(8, 15, 4, 12, 1, on=VERILATOR),
    built(5, 4, 3, 5, 0, on=ICARUS, mutants=ICARUS),
    built(4, 5, 2, 4, 1, on=ICARUS, mutants=ICARUS),
    built(8, 1, 1, 10, 0),
    built(4, 8, 1, 14, 1),
    built(128, 15, 4, 10, 0),
    built(8, 2, 1, 10, 1),
)
PROOFS = tuple(
    Proof(
        "columns are only counted; totals are left to simulation where a block has several rows",
        {"Numerator": numerator, "Denominator": denominator, "Bayer": bayer, "Totals": totals},
    )
    for numerator, denominator, bayer, totals in ((1, 1, 0, 1), (3, 2, 0, 0), (5, 2, 1, 0))
)


ROWS = 3
FRAMES = 6
OUTPUTS = ["out_valid", "out_totals", "out_areas"]


class Bench:
    """Frames to send, and the words expected in their order."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        names = ("Columns", "Numerator", "Denominator", "Width", "Bayer")
        self.columns, self.numerator, self.denominator, self.width, self.bayer = parameters(dut, *names)
        self.window = Window(ROWS, self.columns, self.numerator, self.denominator)
        self.lanes = 2 if self.bayer else 3
        self.sum_width = len(dut.in_sums) // self.lanes
        pins = {name: len(getattr(dut, name)) for name in ("in_blue_row", "in_sums", "in_red_columns")}
        self.slots = Slots(pins, ("in_row_start", "in_frame_start", "in_ends", "rst"))
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        self.stimuli: list[Slot] = []
        self.expected: list[tuple[int, Any]] = []  # slot in which a block is complete, word that leaves

    def frame(self, kind: str, gap: float = 0.0, rows: int | None = None, is_of_camera: bool = True) -> None:
        """Append a frame, of which only `rows` rows are sent."""
        window, lanes, first = self.window, self.lanes, self.slots.random.getrandbits(1)
        limit = self.numerator << (self.width - 1)
        shape = (window.height, self.columns, lanes)
        sums = self.rng.integers(-limit, limit - self.numerator, shape, endpoint=True)
        if kind != "random":
            sums[:] = {"lowest": -limit, "highest": limit - self.numerator}[kind]
        alternating = np.arange(window.height) + first & 1
        blue = (alternating if is_of_camera else self.rng.integers(0, 2, window.height)) == 1
        column_ends = window.column_ends if is_of_camera else [True] * self.columns
        red_columns = self.rng.integers(0, self.numerator, self.columns, endpoint=True)
        args = (self.numerator, self.denominator)
        totals = block_totals(sums, blue if self.bayer else None, *args)
        areas = np.full(totals.shape, self.numerator**2)
        if self.bayer:
            areas = block_areas(sums_over_blocks((~blue).astype(np.int64), *args), red_columns, self.numerator)
        for row in range(window.height if rows is None else rows):
            block = 0
            for column, ends in enumerate(map(bool, column_ends)):
                while self.slots.random.random() < gap:
                    self.stimuli.append(self.slots.idle())
                pins = {"in_row_start": column == 0, "in_frame_start": row == column == 0, "in_blue_row": blue[row]}
                if ends:
                    pins |= {"in_ends": 1, "in_sums": packed(sums[row, block], self.sum_width)}
                    pins |= {"in_red_columns": red_columns[block]}
                    if window.row_ends[row]:
                        place = int(window.row_ends[:row].sum()), block
                        self.expected.append((len(self.stimuli), (totals[place].tolist(), areas[place].tolist())))
                    block += 1
                self.stimuli.append(self.slots.idle(**pins))

    async def check(self, pause: float = 0.0) -> None:
        self.stimuli += [self.slots.idle() for _ in range(LATENCY + 1)]
        outputs = await drive(self.dut, self.stimuli, OUTPUTS, pause)
        total_width, area_width = len(self.dut.out_totals) // 3, len(self.dut.out_areas) // 3
        got = []
        for clock in range(LATENCY, len(self.stimuli)):
            if int(outputs["out_valid"][clock]):
                totals = unpacked(outputs["out_totals"][clock], total_width, 3)
                areas = [area % (1 << area_width) for area in unpacked(outputs["out_areas"][clock], area_width, 3)]
                got.append((clock - LATENCY, (totals, areas)))
        assert got == self.expected


@on_bench(Bench, milliseconds=2)
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.4, 0.0), (0.3, 0.3)]))
async def frames(bench: Bench, gap: float, pause: float) -> None:
    for kind in ("lowest", "highest", *["random"] * FRAMES):
        bench.frame(kind, gap)
        bench.frame(kind, gap, is_of_camera=False)
        if kind == "random":
            bench.frame(kind, gap, rows=bench.slots.random.randrange(bench.window.height))
    await bench.check(pause)


@on_bench(Bench, milliseconds=2)
async def resets(bench: Bench) -> None:
    """Reset inside a frame: every block inside is dropped, and the next frame is right."""
    for age in range(1, LATENCY + 2):
        bench.frame("random")
        del bench.stimuli[len(bench.stimuli) - age + 1 :]
        reset = len(bench.stimuli)
        bench.expected = [(slot, word) for slot, word in bench.expected if slot + LATENCY <= reset]
        bench.stimuli.append(bench.slots.idle(rst=1))
    bench.frame("random")
    await bench.check()
