# SPDX-License-Identifier: Apache-2.0
"""The exit status of a simulation that another program than the suite starts: 1 where a test failed or none ran.

A simulator that cocotb ends has the status 0 whatever the tests say. FuseSoC starts `python3 -m tb.exit_status` before
the simulator, which requires what cocotb needs to start, and names this module first of the testbenches.
"""

from __future__ import annotations

import atexit
import os
import sys
from pathlib import Path

from cocotb_tools.check_results import get_results

RESULTS = Path(os.environ.get("COCOTB_RESULTS_FILE", "results.xml"))


def fail() -> None:
    """End the process of the simulator with status 1 where the results do not say that tests ran and passed."""
    try:
        tests, failed = get_results(RESULTS)
    except RuntimeError:
        tests, failed = 0, 0
    if failed or not tests:
        print(f"{failed} of {tests} tests failed" if tests else "no test ran", file=sys.stderr, flush=True)
        os._exit(1)


if __name__ != "__main__":
    atexit.register(fail)
elif os.environ.get("GPI_USERS"):
    RESULTS.unlink(missing_ok=True)
else:
    sys.exit("GPI_USERS is not set: cocotb would not start, and no test would run: docs/integrate.md shows its value")
