# SPDX-License-Identifier: Apache-2.0
"""substitution against its model: codes, latency and clip counts, with gaps between frames, pauses and resets."""

from functools import partial
from typing import Any

import cocotb
import numpy as np

from formal.entries import ROUNDING, Proof
from formal.tables import up_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.frame_stack import LEAD as LEAD_IN
from tactile_depth.chip.poisson.substitution import LATENCY, substitution
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.chip.rom_files import write_thomas
from tb.beats import BeatsDriver, BeatsMonitor
from tb.pairs import AloneMonitor, side_by_side
from tb.poisson.burst_core import BurstCore
from tb.stream import configuration, of_configuration
from tb.structures import ICARUS, VERILATOR

DIRECT = 4  # clocks from z to the next product
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal", "lanes": 4}


def core_parameters(config: Configuration) -> Any:
    parameters = solver_parameters(config)
    table = {"TableWords": parameters["UpTableWords"], "SettledWidth": parameters["UpSettledWidth"]}
    widths = {"InWidth": config.data_width, "Drop": -parameters["StoreDrop"], "Paths": config.up_paths}
    return widths | table | {name: parameters[name] for name in ("Width", "CoeffWidth", "Rows", "Columns")}


built = of_configuration(core_parameters, write_thomas)


STRUCTURES = (
    built(CHOICES | {"rows": 9}, on=VERILATOR),
    built(CHOICES | {"lanes": 8, "neumann": True}, on=ICARUS),  # z goes straight into the next product
    built(CHOICES | {"rows": 11, "lanes": 2}, on=ICARUS),
    # Few bits are dropped: ties are common.
    built(CHOICES | {"data_width": 12, "coefficient_width": 10}, mutants=ICARUS, on=ICARUS),
    built(CHOICES | {"rows": 9, "data_width": 12, "coefficient_width": 10, "lanes": 8}, mutants=ICARUS),
    built(CHOICES | {"rows": 21, "data_width": 32, "coefficient_width": 24, "lanes": 1}),
    built(CHOICES | {"columns": 64, "lanes": 32}),
)
PROTOCOL = "protocol_pairs"
PROOFS = tuple(
    Proof(
        "z that goes straight into the next product, and z that waits; an even and an odd number of rows; three pairs, "
        f"so that a product follows a product; each of two words; {ROUNDING}",
        {"Rows": rows, "Columns": columns, "Word": word, "TableWords": 32},
        roms=up_roms((rows + 1) // 2, columns),
    )
    for rows, columns, word in ((5, 4, 0), (6, 4, 1), (5, 8, 1))
)


class PairDriver(BeatsDriver):
    """BeatsDriver of pairs of rows, the last one of an odd frame alone."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        self.rows, self.pair = configuration().rows, 0
        super().__init__(*arguments, **named)

    async def _driver_send(self, transaction: Any, sync: bool = True) -> None:
        self.pair = 0 if self.frame_start else self.pair + 1
        self.entity.in_alone.value = int(self.rows % 2 == 1 and self.pair == self.rows // 2)
        await super()._driver_send(transaction, sync)


class PairsCore(BurstCore):
    """BurstCore of pairs of rows, which follow each other in a frame without a pause if they have DIRECT beats."""

    def shape(self, dut: Any, frames: int) -> tuple[int, ...]:
        paths = configuration().up_paths
        return frames * self.frame(dut), configuration().columns // paths, 2 * paths, 1

    async def check(self, dut: Any, words: Any, **behaviour: Any) -> None:
        alone, pairs, odd = AloneMonitor(dut, "out"), self.frame(dut), configuration().rows % 2
        await super().check(dut, words, gap_every=pairs if words.shape[1] == DIRECT else 1, **behaviour)
        want = [odd != 0 and pair % pairs == pairs - 1 for pair in range(len(words))]
        assert alone.marks[-len(want) :] == want


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    """Return what leaves; beside a row alone come words of no meaning."""
    config = configuration()
    rows, paths = config.rows, config.up_paths
    both = np.moveaxis(x.reshape(-1, rows - rows // 2, config.columns // paths, 2, paths), 3, 2)
    z = substitution(both.reshape(len(both), -1, config.columns)[:, :rows], config, monitor)
    return side_by_side(z, paths).reshape(x.shape)


CORE = PairsCore(
    model,
    lambda dut: LATENCY,
    "InWidth",
    ("data",),
    {"driver": partial(PairDriver, lead=LEAD_IN), "source": partial(BeatsMonitor, lead=LEAD_IN)},
    lambda dut: (configuration().rows + 1) // 2,
)
bursts, many_bursts, limits, reset_in_mid_burst, a_frame_begins_afresh = CORE.tests()


@cocotb.test
async def clips_in_pauses(dut: Any) -> None:
    """Count a clip once, however long it stands."""
    await CORE.check(dut, CORE.words(dut, 2, None), pause=0.3)
