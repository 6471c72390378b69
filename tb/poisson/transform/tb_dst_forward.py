# SPDX-License-Identifier: Apache-2.0
"""dst_forward against its model: codes, latency, saturations; gaps, pauses, extremes, reset."""

from typing import Any

from formal.entries import Proof
from formal.tables import transform_roms
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_forward import latency as dst_forward_latency
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.rom_files import write_direction
from tb.flips import no_flips as no_flips
from tb.poisson.burst_core import BurstCore
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

PARAMETERS = ("Size", "Words", "InWidth", "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def built(*values: int, **runs: Any) -> Structure:
    parameters = dict(zip(PARAMETERS, values, strict=True))
    size, words, coeff = (parameters[name] for name in ("Size", "Words", "CoeffWidth"))
    return Structure(parameters, roms=lambda folder: write_direction(folder, size, words, False, coeff), **runs)


STRUCTURES = (
    built(16, 4, 23, 0, 27, 18, 3, 24, 1, on=VERILATOR),
    built(16, 2, 23, 0, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 8, 15, 0, 15, 10, 3, 12, 1, on=ICARUS),
    built(8, 4, 9, 0, 9, 7, 3, 6, 1, on=ICARUS, mutants=ICARUS),
    built(32, 4, 9, 0, 9, 7, 1, 6, 0, on=ICARUS),
    built(32, 1, 24, -3, 27, 18, 3, 24, 1, on=ICARUS),
    built(16, 1, 9, 1, 9, 7, 1, 6, 0, mutants=ICARUS),
    built(128, 4, 27, 0, 27, 18, 0, 27, 1),
)
PROTOCOL = {"protocol_beats": {"Beats": "Size / Words"}}
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "the smallest transform, every core of a longer one is in it",
        {"Size": 8, "Words": 2, "Latency": dst_forward_latency(8, 2)},
        roms=transform_roms(2, 4),
    ),
)


def model(dut: Any, x: Any, monitor: Monitor) -> Any:
    formats: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    _, beats, paths, _ = x.shape
    rows = from_beats(x[..., 0], beats.bit_length() - 1)
    return to_beats(dst_forward(rows, Transform(*formats), monitor), paths, 0)[..., None]


CORE = BurstCore(model, lambda dut: dst_forward_latency(*parameters(dut, "Size", "Words")), "InWidth", ("data",))
bursts, many_bursts, limits, reset_in_mid_burst, *_ = CORE.tests()
