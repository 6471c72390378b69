# SPDX-License-Identifier: Apache-2.0
"""Selection of tests: a test states its level and its needs, and a run states the last level that it plays.

A run with the level `formats` in its settings plays the tests of that level and of the levels before it. The default is
`whole`, and `long` in a full run. cocotb plays the levels in their order.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import Any, TypeVar

import cocotb

from tactile_depth.chip.configuration import Configuration
from tb.settings import RUN
from tb.stream import configuration

Value = TypeVar("Value")


class Level(IntEnum):
    """Level of a test, or the last level that a run plays."""

    FIRST = 0  # one frame
    STREAM = 1  # frames back to back, random gaps and stalls, a reset
    FORMATS = 2  # tests that depend on word lengths, boundary and options of the build
    DISTURBED = 3  # half of the pairs of gaps and stalls
    WHOLE = 4  # each other test once
    LONG = 5  # repetitions of a test under another disturbance


LEVEL = Level[(RUN.level or ("long" if RUN.full else "whole")).upper()]


def up_to(values: Mapping[Level, Sequence[Value]]) -> list[Value]:
    """Return the values of a test's parameter at the levels that this run plays."""
    return [value for level, some in values.items() if level <= LEVEL for value in some]


def named(values: Sequence[str]) -> list[Any]:
    """Return values of a parameter that appear in the names of tests, even if they are long."""
    return [cocotb.Param(value, value) for value in values]


def case(
    level: Level = Level.WHOLE,
    *,
    needs: Callable[[Configuration], bool] | None = None,
    whole_rows: bool = False,
    inside: bool = False,
    milliseconds: float = 3,
) -> Callable[[Any], Any]:
    """Make a coroutine a test of this run, if the run plays its level and the device meets its needs.

    Parameters
    ----------
    needs : function of the configuration, or None
        Returns True if the build has the feature under test.
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
        and (whole_rows or not RUN.second_client)
        and not (inside and RUN.netlist)
    )
    return cocotb.test(timeout_time=milliseconds, timeout_unit="ms", stage=level) if chosen else lambda _: None
