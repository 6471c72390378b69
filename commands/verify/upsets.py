# SPDX-License-Identifier: Apache-2.0
"""`make upsets`: flips bits of registers and memories while frames stream through, and counts the outcomes."""

import json
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from commands.common import repository, tabular, variables
from commands.common import simulator as simulation
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic_for
from tb.settings import RunSettings

CASES: dict[str, dict[str, Any]] = {
    "spectral": {"columns": 16, "bits_per_channel": 2},
    "tridiagonal": {"columns": 16, "rows": 8, "solver": "tridiagonal", "neumann": True, "bits_per_channel": 2},
    "tridiagonal-lanes": {"columns": 16, "rows": 9, "solver": "tridiagonal", "lanes": 2, "bits_per_channel": 2},
}
OUTCOMES = {
    "hang": "a frame sent after the flip did not come out",
    "stays wrong": "a frame sent after the flip came out wrong",
    "flagged": "a frame in flight was damaged or lost, and a sticky bit is set",
    "not flagged": "a frame in flight was damaged or lost, and no bit is set",
    "false alarm": "a sticky bit, but every frame was right",
    "masked": "every frame right, no sticky bit",
}


def run(case: str, upsets: int, seed: int, folder: Path) -> list[dict[str, Any]]:
    """Run `upsets` experiments on one structure for each module and for its memories."""
    config = Configuration(**CASES[case])
    write_roms(folder, synthetic_for(config), config)
    (folder / "sim.vvp").unlink(missing_ok=True)  # the runner would keep a build with other parameters
    log = folder / "run.log"
    top = "tactile_depth"
    simulation.build("icarus", top, repository.sources(), hdl_parameters(config), folder, checked=False, log=log)
    count, failed = simulation.run(
        top,
        "tb.tb_upsets",
        folder,
        folder,
        simulator="icarus",
        seed=seed,
        environment=RunSettings(device={"configuration": CASES[case], "upsets": upsets}).environment,
        log=log,
    )
    if failed or not count:
        raise RuntimeError(f"{case}: the experiments failed, see {log}")
    results: list[dict[str, Any]] = json.loads((folder / "upsets.json").read_text())
    return results


def outcomes_by_module(results: list[dict[str, Any]]) -> tabular.Table:
    """Return a table with a row per module and a column per outcome; settings, which software rewrites, come last."""
    rows: dict[str, Counter[str]] = {}
    for result in results:
        name = "settings (held until rewritten)" if result["setting"] else result["group"]
        for row in (name, "all but settings") if not result["setting"] else (name,):
            rows.setdefault(row, Counter())[result["outcome"]] += 1
    names = sorted(rows, key=lambda row: (row.startswith(("all", "settings")), row))
    cells = [(name, *(f"{rows[name][outcome]}" for outcome in OUTCOMES)) for name in names]
    return tabular.Table(("module", *OUTCOMES), cells)


def main(upsets: variables.Count = 60, seed: variables.Seed = 1) -> int:
    """Flip bits in every case and print tables of the outcomes; return the exit status."""
    folders = {case: repository.ROOT / "build" / "upsets" / case for case in CASES}
    for folder in folders.values():
        folder.mkdir(parents=True, exist_ok=True)
    print(f"{upsets} flips in each module and its memories, each in a stream of its own ..", flush=True)
    with ProcessPoolExecutor(len(CASES)) as pool:
        runs = {case: pool.submit(run, case, upsets, seed, folder) for case, folder in folders.items()}
    print()
    for outcome, meaning in OUTCOMES.items():
        print(f"{outcome}: {meaning}")
    bad = 0
    for case, results in runs.items():
        print(f"\n{case}\n{outcomes_by_module(results.result())}")
        bad += sum(not r["setting"] and r["outcome"] in ("hang", "stays wrong") for r in results.result())
    print(f"\n{bad} hang or stay wrong")
    return variables.MISMATCH if bad else variables.EQUAL
