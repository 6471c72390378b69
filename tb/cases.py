# SPDX-License-Identifier: Apache-2.0
"""Cases of a testbench: coroutines that get a bench of the device, reset and running."""

import inspect
from collections.abc import Callable
from typing import Any

import cocotb


def on_bench(bench: Callable[..., Any], milliseconds: float = 1, **fixed: Any) -> Callable[[Any], Any]:
    """Make a coroutine a test, which gets a bench of the device; a bench that can start has started.

    The bench is made of the device, of `fixed`, and of the parameters of the test that it names too. The coroutine gets
    the parameters that it names, and `dut`. A bench that has `finish` is finished after it.

    Parameters
    ----------
    milliseconds : float
        Simulated time after which the test fails.
    """

    def made(test: Any) -> Any:
        generator = cocotb.test(timeout_time=milliseconds, timeout_unit="ms")(test)
        play = generator.func

        def named(values: dict[str, Any], function: Callable[..., Any]) -> dict[str, Any]:
            names = inspect.signature(function).parameters
            return {name: value for name, value in values.items() if name in names}

        async def run(dut: Any, **values: Any) -> None:
            device = bench(dut, **fixed, **named(values, bench))
            if hasattr(device, "start"):
                await device.start()
            await play(device, **named({"dut": dut, **values}, play))
            if hasattr(device, "finish"):
                await device.finish()

        generator.func = run
        return generator

    return made
