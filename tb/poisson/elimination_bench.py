# SPDX-License-Identifier: Apache-2.0
"""Tests of the two halves of Thomas's algorithm, forward_elimination and back_substitution, against their models.

The tests check codes, latency and saturation counts, with gaps, pauses and resets.
"""

import math
from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.back_substitution import LATENCY as BACK_SUBSTITUTION
from tactile_depth.chip.poisson.back_substitution import back_substitution
from tactile_depth.chip.poisson.forward_elimination import LATENCY as FORWARD_ELIMINATION
from tactile_depth.chip.poisson.forward_elimination import forward_elimination
from tb.stream import MANY, check_bursts, configuration, parametrize, sample, uniform, with_and_without_en

MODELS = {"forward_elimination": forward_elimination, "back_substitution": back_substitution}
LATENCIES = {"forward_elimination": FORWARD_ELIMINATION, "back_substitution": BACK_SUBSTITUTION}
UNCLIPPED = {"forward_elimination": 0.01, "back_substitution": 0.05}  # amplitude at which nothing clips


async def check(dut: Any, amplitude: Any, frames: int = 3, **behaviour: Any) -> None:
    """Send frames of random words up to an amplitude, and compare the output with the model of the device.

    An amplitude of None gives mostly the lowest and the highest word, infinity the highest word only.
    """
    config, core = configuration(), dut._name

    def model(words: Any, monitor: Monitor) -> Any:
        return MODELS[core](words.reshape(-1, config.rows, config.columns), config, monitor)

    width = config.arithmetic_width if core == "forward_elimination" else config.data_width
    shape = (frames * config.rows, config.columns, 1)
    words = np.full(shape, (1 << width - 1) - 1) if amplitude == math.inf else uniform(shape, width, amplitude)
    behaviour |= {"in_fields": ["data"], "out_fields": ["data"], "frame": config.rows}
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
    inner = config.columns * (config.rows // 2) + config.columns // 2
    counts = [*range(1, LATENCIES[dut._name] + 4), *range(inner, inner + 4)]
    await check(dut, amplitude, interrupts=with_and_without_en(counts))


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 0.1, frames=1, strays=strays)
