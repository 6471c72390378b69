# SPDX-License-Identifier: Apache-2.0
"""Routed delays of the pointer bits that cross between the clocks of hdl/common/td_async_fifo.sv.

nextpnr takes no constraint between two clocks (its issue 967). The Gray code asks that each bit arrives within one
period of the clock that it comes from, so the delays are read from its report and compared with that period.
"""

import re
from typing import Any

CATCHING = re.compile(r"(written|fetched)_code_q_TRELLIS_FF")
"""Name of a register that catches a bit of a pointer, in nextpnr's report."""


def pointer_delays(report: dict[str, Any]) -> dict[str, float]:
    """Return the delay in ns from the clock edge to the other clock's register, by the name of that register.

    Parameters
    ----------
    report : nextpnr's report, with its option --detailed-timing-report
    """
    return {
        end["cell"]: max(end["delay"])
        for net in report["detailed_net_timings"]
        for end in net["endpoints"]
        if end["event"] != net["event"] and CATCHING.search(end["cell"])
    }


def longest(report: dict[str, Any], bits: int) -> float:
    """Return the longest delay of a pointer bit in ns.

    Raises RuntimeError: the report has not as many bits, so a delay is not known.
    """
    delays = pointer_delays(report)
    if len(delays) != bits:
        raise RuntimeError(f"nextpnr reports {len(delays)} bits of pointers between the clocks, the design has {bits}")
    return max(delays.values())


def source_period(report: dict[str, Any]) -> float:
    """Return the shorter period in ns of the clocks that are constrained: each is the source of one pointer."""
    return 1e3 / max(clock["constraint"] for clock in report["fmax"].values())
