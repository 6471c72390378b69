# SPDX-License-Identifier: Apache-2.0
"""Tests of the sine transforms, dst_forward and dst_inverse, against their models.

The tests check codes, latency and saturation counts, with gaps, pauses, extreme words and resets.
"""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_forward import latency as dst_forward_latency
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse
from tactile_depth.chip.poisson.transform.dst_inverse import latency as dst_inverse_latency
from tactile_depth.chip.poisson.transform.transform import Transform
from tb.stream import MANY, check_bursts, extremes, parameters, parametrize, sample, uniform, with_and_without_en

# Parameters of dst_forward and dst_inverse, in the order of their structures.
TRANSFORM_PARAMETERS = ("Size", "InWidth", "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")


def transform_parameters(*values: int) -> dict[str, int]:
    """Return the parameters of a sine transform by name."""
    return dict(zip(TRANSFORM_PARAMETERS, values, strict=True))


CORES: dict[str, tuple[Any, Any]] = {
    "dst_forward": (dst_forward, dst_forward_latency),
    "dst_inverse": (dst_inverse, dst_inverse_latency),
}
CLOCKS_OF_A_BURST_EDGE = 12  # cycles in which a burst begins to enter, or to leave


async def check(dut: Any, words: Any, **behaviour: Any) -> Any:
    """Send bursts (count, size, 1) and compare the output with the model of the device."""
    formats: Any = parameters(dut, "InputDrop", "Width", "CoeffWidth", "OutputDrop", "OutWidth", "Sine")
    transform, latency = CORES[dut._name]

    def model(words: Any, monitor: Any) -> Any:
        return transform(words[..., 0], Transform(*formats), monitor)

    return await check_bursts(
        dut, words, model, latency(words.shape[1]), in_fields=["data"], out_fields=["data"], **behaviour
    )


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (0, 0.3)]), ("amplitude", sample([0.3, 1.0, None])))
async def bursts(dut: Any, gap: float, pause: float, amplitude: float) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, uniform((5, size, 1), width, amplitude), gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@parametrize(amplitude=[0.1, None])
async def many_bursts(dut: Any, amplitude: float) -> None:
    """Reach ties of every rounding, and clip every value that can clip."""
    size, width = parameters(dut, "Size", "InWidth")
    await check(dut, uniform((2 * MANY, size, 1), width, amplitude))


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def limits(dut: Any) -> None:
    size, width = parameters(dut, "Size", "InWidth")
    _, sink = await check(dut, extremes(size, width))
    assert not np.any(sink.words[:size]), "zero in, but not zero out"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("late", "clips"), sample([(False, True), (False, False), (True, False), (True, True)])))
async def reset_in_mid_burst(dut: Any, late: bool, clips: bool) -> None:
    """Reset in each cycle in which a burst begins to enter, or to leave; a clip after the reset is not counted."""
    size, width = parameters(dut, "Size", "InWidth")
    _, latency = CORES[dut._name]
    first = latency(size) - 3 if late else 1
    words = uniform((2, size, 1), width, None if clips else 1.0)
    await check(dut, words, interrupts=with_and_without_en(range(first, first + CLOCKS_OF_A_BURST_EDGE)))
