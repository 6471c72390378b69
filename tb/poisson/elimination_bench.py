# SPDX-License-Identifier: Apache-2.0
"""Tests of Thomas's algorithm against its models: forward_elimination, wide_elimination and back_substitution.

The tests check codes, latency and saturation counts, with gaps, pauses and resets.
"""

import math
from collections.abc import Sequence
from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.back_substitution import LATENCY as BACK_SUBSTITUTION
from tactile_depth.chip.poisson.back_substitution import back_substitution
from tactile_depth.chip.poisson.forward_elimination import LATENCY as FORWARD_ELIMINATION
from tactile_depth.chip.poisson.forward_elimination import forward_elimination
from tactile_depth.chip.poisson.wide_elimination import LATENCY as WIDE_ELIMINATION
from tactile_depth.chip.poisson.wide_elimination import wide_elimination
from tb.pins import Read
from tb.stream import MANY, check_bursts, configuration, parametrize, sample, uniform, with_and_without_en
from tb.wide import WideDriver, WideMonitor

MODELS = {
    "forward_elimination": forward_elimination,
    "wide_elimination": wide_elimination,
    "back_substitution": back_substitution,
}
LATENCIES = {
    "forward_elimination": FORWARD_ELIMINATION,
    "wide_elimination": WIDE_ELIMINATION,
    "back_substitution": BACK_SUBSTITUTION,
}
# Amplitudes at which nothing clips.
UNCLIPPED = {"forward_elimination": 0.01, "wide_elimination": 0.01, "back_substitution": 0.05}


class Eliminated(WideMonitor):
    """Monitor of the words that count: d of a frame's last row, and e of the row above in all rows but the first."""

    def __init__(self, dut: Any, clocks: int, words: int, rows: int) -> None:
        super().__init__(dut, "out", ["last", "ahead"], clocks, words)
        self.rows, self.row = rows, 0

    def word(self, reads: Sequence[Read]) -> Any:
        if len(self.words) % self.length == 0:
            self.row = 0 if self.frame_starts[-1] else self.row + 1
        zero = (0,) * self.paths
        last = super().word(reads[: self.paths]) if self.row == self.rows - 1 else zero
        return last + (super().word(reads[self.paths :]) if self.row else zero)


def words_per_clock(dut: Any) -> int:
    return configuration().down_words if dut._name == "wide_elimination" else 1


async def check(dut: Any, amplitude: Any, frames: int = 3, **behaviour: Any) -> None:
    """Send frames of random words up to an amplitude, and compare the output with the model of the device.

    An amplitude of None gives mostly the lowest and the highest word, infinity the highest word only.
    """
    config, core, paths = configuration(), dut._name, words_per_clock(dut)
    width = config.data_width if core == "back_substitution" else config.arithmetic_width
    clocks = config.columns // paths
    shape = (frames * config.rows, clocks, paths)
    words = np.full(shape, (1 << width - 1) - 1) if amplitude == math.inf else uniform(shape, width, amplitude)

    def model(words: Any, monitor: Monitor) -> Any:
        out = MODELS[core](words.reshape(-1, config.rows, config.columns), config, monitor)
        if core != "wide_elimination":
            return out
        seen = np.zeros((2, *out.shape), np.int64)
        seen[0, :, -1] = out[:, -1]
        seen[1, :, 1:] = out[:, :-1]
        return np.moveaxis(seen.reshape(2, -1, clocks, paths), 0, 2)

    behaviour |= {"in_fields": ["data"] * paths, "out_fields": ["data"], "frame": config.rows}
    if core == "wide_elimination":
        behaviour |= {
            "out_fields": ["data"] * 2 * paths,
            "driver": WideDriver(dut, "in", ["data"], paths),
            "source": WideMonitor(dut, "in", ["data"], clocks, paths),
            "sink": Eliminated(dut, clocks, paths, config.rows),
        }
    await check_bursts(dut, words, model, LATENCIES[core], **behaviour)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize((("gap", "pause"), sample([(0, 0.0), (30, 0.0), (0, 0.3), (30, 0.3)])), ("full_scale", [False, True]))
async def frames(dut: Any, gap: float, pause: float, full_scale: bool) -> None:
    await check(dut, 1.0 if full_scale else UNCLIPPED[dut._name], gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.003, 0.1, None])
async def many_frames(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    await check(dut, amplitude, frames=MANY)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def reset_in_mid_frame(dut: Any, amplitude: float) -> None:
    """Reset as the first words enter and leave and in the middle of a frame; None: while values are clipped."""
    config = configuration()
    clocks = config.columns // words_per_clock(dut)
    inner = clocks * (config.rows // 2) + clocks // 2
    counts = [*range(1, LATENCIES[dut._name] + 4), *range(inner, inner + 4)]
    await check(dut, amplitude, interrupts=with_and_without_en(counts))


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 0.1, frames=1, strays=strays)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def reset_as_the_mean_is_clipped(dut: Any) -> None:
    """Reset in each cycle after the addend of the last row but one: nothing is counted."""
    config = configuration()
    last_addend = config.columns // words_per_clock(dut) * (config.rows - 2) + LATENCIES[dut._name]
    await check(dut, math.inf, interrupts=with_and_without_en(range(last_addend - 4, last_addend + 7)))
