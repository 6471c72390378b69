# SPDX-License-Identifier: Apache-2.0
"""Choice of the tests that a run takes: a test states its level and what it needs, a run states how far it goes.

A run with the environment variable LEVEL=formats takes the tests of that level and of those before it. Without LEVEL a
run goes as far as `whole`, and with REGRESS=1 as far as `long`. cocotb runs the levels in their order.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import Any, TypeVar

import cocotb

from tactile_depth.configuration import Configuration
from tb.stream import REGRESS, configuration

Value = TypeVar("Value")


class Level(IntEnum):
    """Level of a run: the tests that it plays."""

    FIRST = 0  # one frame
    STREAM = 1  # frames without a pause, gaps and stalls at random, a reset
    FORMATS = 2  # what depends on word lengths, boundary and choices of the build
    DISTURBED = 3  # half of the pairs of gaps and stalls
    WHOLE = 4  # everything else, once
    LONG = 5  # what repeats a test under another disturbance


LEVEL = Level[os.environ.get("LEVEL", "long" if REGRESS else "whole").upper()]
SECOND_CLIENT = os.environ.get("CLIENT") == "second"  # cocotbext-axi drives the ports
NETLIST = os.environ.get("NETLIST") == "1"  # the device has pins and parameters, and no names inside


def up_to(values: Mapping[Level, Sequence[Value]]) -> list[Value]:
    """Return the values of a test's parameter at the levels that this run takes."""
    return [value for level, some in values.items() if level <= LEVEL for value in some]


def named(values: Sequence[str]) -> list[Any]:
    """Return values of a parameter that stand in the names of tests, however long they are."""
    return [cocotb.Param(value, value) for value in values]


def case(
    level: Level = Level.WHOLE,
    *,
    needs: Callable[[Configuration], bool] | None = None,
    whole_rows: bool = False,
    inside: bool = False,
    milliseconds: float = 3,
) -> Callable[[Any], Any]:
    """Make a coroutine a test of this run, if the run goes so far and the device has what the test needs.

    Parameters
    ----------
    needs : function of the configuration, or None
        Returns whether the build has what is tested.
    whole_rows : bool
        The test sends whole rows only, so that the second client can send them.
    inside : bool
        The test reads or sets a signal inside the device.
    milliseconds : float
        Simulated time after which the test fails.
    """
    chosen = (
        level <= LEVEL
        and (needs is None or needs(configuration()))
        and (whole_rows or not SECOND_CLIENT)
        and not (inside and NETLIST)
    )
    return cocotb.test(timeout_time=milliseconds, timeout_unit="ms", stage=level) if chosen else lambda _: None
