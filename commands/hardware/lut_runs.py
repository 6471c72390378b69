# SPDX-License-Identifier: Apache-2.0
"""`python -m commands.hardware.lut_runs A/resources.json .. CHECK B/resources.json ..`: record runs of `make synth`.

Takes reports, and writes them to commands/cost/luts.json. Those before CHECK are fitted by
commands/cost/luts.py, those behind it are not; of equal runs the first counts. Without a report it prints all
recorded runs beside the model, the table of docs/hardware.md.
"""

import json
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

from commands.common import variables
from commands.common.tabular import Table
from commands.cost.cost import cost
from commands.cost.luts import REST, RUNS, grouped, logic, memories
from commands.hardware import synth, synthesis, targets
from commands.hardware.targets import MEMORY
from tactile_depth.chip.configuration import Configuration


def runs_of(report: Path, fitted: bool) -> list[dict[str, Any]]:
    """Return commands, configurations and counts of a resources.json."""
    document = json.loads(report.read_text())
    words = [word for word in document["command"].split()[2:] if word.partition("=")[0] not in ("OUT", "TARGET")]
    of = variables.read(synth.SynthRun, words)
    device = targets.TARGETS[document["target"]].device
    default = asdict(Configuration())
    runs = []
    for (each, reason), design in zip(synth.designs(of.request, of.grids), document["designs"], strict=False):
        if reason:
            continue
        config = synthesis.design(each)[2]
        chosen = [word for word in words if not word.startswith("GRIDS=")]
        chosen += [f"N={each.columns}", f"SOLVER={each.solver}"] if of.grids else []
        found: Counter[str] = Counter()
        of_luts: Counter[str] = Counter()
        for core in design["cores"]:
            found[core["name"]] += int(core["counts"]["LUT"] - core["counts"][MEMORY])
            of_luts[core["name"]] += int(core["counts"][MEMORY])
        runs.append(
            {
                "device": device.name,
                "fitted": fitted,
                "variables": " ".join(chosen),
                "rtl": document["rtl"],
                "configuration": {name: value for name, value in asdict(config).items() if value != default[name]},
                "multipliers": design["totals"][device.multiplier],
                "blocks": design["totals"][device.block],
                "memories": of_luts.total() - int(grouped(of_luts, config).get(REST, 0)),
                "logic": grouped(found, config),
            }
        )
    return runs


def runs_and_model() -> Table:
    """Return the table of all runs beside the model."""
    devices = {target.device.name: target.device for target in targets.TARGETS.values()}
    rows = []
    for run in json.loads(RUNS.read_text()):
        count, device = cost(Configuration(**run["configuration"])), devices[run["device"]]
        numbers = {
            "multipliers": count.multipliers_of(device),
            "blocks": count.blocks_of(device),
            "memories": memories(count.config, device),
        }
        both = [f"{n:,g}" if n == run[name] else f"{n:,g}, tool {run[name]:,g}" for name, n in numbers.items()]
        tool, model = sum(run["logic"].values()), sum(logic(count.config, device).values())
        difference = f"{100 * (model / tool - 1):+.1f} %"
        fitted = "yes" if run["fitted"] else "no"
        rows.append((device.name, f"`{run['variables']}`", *both, f"{model:,.0f}", f"{tool:,.0f}", difference, fitted))
    heads = ("multipliers", "block memories", "LUT of memories", "of logic: model", "tool", "difference", "fitted")
    return Table(("device", "`make synth` with", *heads), rows)


def main() -> None:
    reports = sys.argv[1:]
    if reports:
        behind = reports.index("CHECK") if "CHECK" in reports else len(reports)
        runs: dict[tuple[str, str], dict[str, Any]] = {}
        for k, name in enumerate(reports):
            for run in runs_of(Path(name), k < behind) if k != behind else []:
                runs.setdefault((run["device"], run["variables"]), run)
        RUNS.write_text("[\n" + ",\n".join(sorted(map(json.dumps, runs.values()))) + "\n]\n")
    print(runs_and_model().markdown())


if __name__ == "__main__":
    main()
