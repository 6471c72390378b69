# SPDX-License-Identifier: Apache-2.0
"""Name of this machine, printed with each figure measured on it."""

import os
import platform
from pathlib import Path


def machine() -> str:
    """Return the model of the processor and the number of cores that this process may use."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        lines = cpuinfo.read_text().splitlines()
        named = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
        model = named.get("model name", model)
        if named.get("model", "").isdecimal():
            model += f" (family {named['cpu family']}, model {named['model']})"
    return f"{model}, {len(os.sched_getaffinity(0))} cores"
