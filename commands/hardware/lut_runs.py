# SPDX-License-Identifier: Apache-2.0
"""`python -m commands.hardware.lut_runs A/resources.json ..`: write the runs that models/tactile_depth/luts.py fits.

Takes reports of `make synth` of one configuration each.
"""

import json
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

from commands.hardware import synth, synthesis
from tactile_depth.configuration import Configuration
from tactile_depth.luts import RUNS, grouped
from tactile_depth.tactile_depth import top_parameters


def run_of(report: Path) -> dict[str, Any]:
    """Return device, command, configuration and LUTs by core of a resources.json."""
    document = json.loads(report.read_text())
    (design,) = document["designs"]
    command = [word for word in document["command"].split()[2:] if not word.startswith("OUT=")]
    config = synthesis.design(synth.parse(command)[-1])[2]
    default = asdict(Configuration())
    counts: Counter[str] = Counter()
    for core in design["cores"]:
        counts[core["name"]] += int(core["counts"]["LUT"])
    return {
        "command": f"make synth {' '.join(command)}",
        "device": document["device"],
        "configuration": {name: value for name, value in asdict(config).items() if value != default[name]},
        "luts": grouped(counts, top_parameters(config)),
    }


def main() -> None:
    runs = [run_of(Path(report)) for report in sys.argv[1:]]
    lines = sorted(json.dumps(run) for run in runs)
    RUNS.write_text("[\n" + ",\n".join(lines) + "\n]\n")


if __name__ == "__main__":
    main()
