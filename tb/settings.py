# SPDX-License-Identifier: Apache-2.0
"""Settings of a run of the tests or of a testbench: one JSON object in the environment variable RUN_SETTINGS.

The commands set it for pytest, and pytest sets it for the simulator. SIM and SEED, which a user may set for pytest, and
what cocotb reads are the only other variables.
"""

from __future__ import annotations

import gc
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

VARIABLE = "RUN_SETTINGS"
gc.set_threshold(100_000)  # objects: to look for circles of them, of which tests make few, took 5 % of their time


@dataclass(frozen=True)
class RunSettings:
    """Settings of a run.

    Attributes
    ----------
    full : bool
        Tests run every case (`make regress`) instead of a sample; on Icarus benches of RTL do not, which take minutes.
    repeats : int
        Frames or bursts of tests whose cases are rare: ties, values that just clip. 0: 15 in full, otherwise 2.
    power_ups : int
        Random states from which the first structure of a core begins.
    cores : tuple of str
        Cores whose files `make lint` checks, and whose netlists `make netlists` runs; none: all.
    level : str
        Last level of the testbench of the whole that is played (tb/selection.py).
    second_client : bool
        cocotbext-axi drives the ports of the whole.
    netlist : bool
        The device is a netlist: it has pins and parameters, but no names of inner signals.
    device : mapping
        Facts about the device that its testbench must know: `configuration`, `camera`, ..
    mutants : mapping
        Arguments of the runner of mutants (tb/mutants.py).
    """

    full: bool = False
    repeats: int = 0
    power_ups: int = 1
    cores: tuple[str, ...] = ()
    level: str = ""
    second_client: bool = False
    netlist: bool = False
    device: Mapping[str, Any] = field(default_factory=dict)
    mutants: Mapping[str, Any] = field(default_factory=dict)

    @property
    def environment(self) -> dict[str, str]:
        """Return the environment variable that gives a process these settings."""
        return {VARIABLE: json.dumps(asdict(self))}


RUN = RunSettings(**json.loads(os.environ.get(VARIABLE, "{}")))
