# SPDX-License-Identifier: Apache-2.0
"""Area and power at 45 nm: logic by the ratios of recorded runs, memories by size, and what placement adds.

commands/hardware/nangate45.json holds `make asic` with NanGate FreePDK45 and, of the same RTL, with the default
library. `python -m commands.hardware.estimate COMMIT NAME=AT_45/asic.json,AT_180/asic.json ..` writes it.
"""

import json
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from commands.common import published, recorded
from commands.hardware import memory_model

FILE = Path(__file__).with_name("nangate45.json")
PUBLISHED = (
    f"published, {published.CLOCK_MHZ:g} MHz",
    published.ASIC_AREA_MM2,
    published.ASIC_POWER_MW,
    "docs/results.md: NanGate FreePDK45, typical corner, single-port SRAM by CACTI and bsg_fakeram, another pipeline",
)
# Placed and routed with NanGate FreePDK45 in public: before placement and after routing, or without and with the tree.
CELLS_UM2 = {"jpeg": (96_427, 100_819), "tinyRocket": (49_942, 58_967)}
SWITCHING_MW = {"jpeg": (192.7, 225.5), "tinyRocket": (30.28, 55.66)}
TREE_MW_NS_FLOPS = {"Ariane": (825.089 - 778.305, 1.3, 19_807), "tinyRocket": (159.006 - 139.304, 1.2, 4_035)}
ROWS_FILLED = 0.68  # with cells, in Ariane

Range = tuple[float, float]  # least and greatest


class Estimate(NamedTuple):
    """Areas in mm2 and powers in mW at 45 nm and published.CLOCK_MHZ; memories have one port or two."""

    logic_mm2: float
    logic_mw: float
    memory_mm2: Range
    memory_mw: float
    placed_mm2: Range
    placed_mw: Range


def logic_of(report: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is kept of the logic of an asic.json, and its memories."""
    cores, parts = report["cores"], [row["without_delays_mw"] for row in report["cores"]]
    power_mw = sum(row["with_delays_mw"] for row in cores)
    clock_mw, leakage_mw = (sum(part[name] for part in parts) for name in ("clock", "leakage"))
    return {
        "area_mm2": sum(row["area_um2"] for row in cores) / 1e6,
        "power_mw": power_mw,
        "clock_mw": clock_mw,
        "leakage_mw": leakage_mw,
        "toggling_mw": power_mw - clock_mw - leakage_mw,
        "switching_mw": sum(row["without_delays_mw"]["switching"] * row["delay_factor"] for row in cores),
        "flip_flops": sum(row["flip_flops"] for row in cores),
        "clock_mhz": report["timing"]["clock_mhz"],
        "worst_slack_ns": report["timing"]["worst_slack_ns"],
        "codes": report["codes"],
        "codes_wrong": report["codes_wrong"] + report["clocks_wrong_with_delays"],
        "memories": report["memories"],
    }


@cache
def recorded_runs() -> dict[str, dict[str, Any]]:
    """Return commit, command, and the logic "at_45" and "at_180" of each design."""
    runs: dict[str, dict[str, Any]] = json.loads(FILE.read_text())
    return runs


class Ratios(NamedTuple):
    """Figures at 45 nm over those of the same design with the default library, and leakage at 45 nm in mW per mm2."""

    area: float
    clock: float  # energy of clock pins
    toggling: float  # energy of what else toggles, with delays
    leakage: float


def ratios(name: str) -> Ratios:
    """Return the ratios of a recorded design."""
    small, large = (recorded_runs()[name][node] for node in ("at_45", "at_180"))
    per_clock = large["clock_mhz"] / small["clock_mhz"]
    clock, toggling = (small[part] / large[part] * per_clock for part in ("clock_mw", "toggling_mw"))
    return Ratios(small["area_mm2"] / large["area_mm2"], clock, toggling, small["leakage_mw"] / small["area_mm2"])


def mean_ratios() -> Ratios:
    """Return the mean of the ratios of the recorded designs."""
    each = list(zip(*map(ratios, recorded_runs()), strict=True))
    return Ratios(*(sum(values) / len(values) for values in each))


def capacitances() -> float:
    """Return the share of pins' capacitances in what toggling takes at 45 nm, the mean of the designs."""
    runs = [run["at_45"] for run in recorded_runs().values()]
    return sum(run["switching_mw"] / run["toggling_mw"] for run in runs) / len(runs)


def grown(pairs: Iterable[tuple[float, float]]) -> Range:
    """Return the least and the greatest factor from the first to the second of pairs."""
    factors = [after / before for before, after in pairs]
    return min(factors), max(factors)


def at_45_nm(logic: Mapping[str, Any]) -> Estimate:
    """Return the estimate of logic at 45 nm, with its memories: words, bits of a word, reads and writes in a clock.

    A memory that is accessed more than once in a clock needs a second port, or words of two in one port.
    """
    clock, node = published.CLOCK_MHZ, memory_model.NODE_NM
    one_port = two_ports = picojoules = leakage = 0.0
    for depth, width, reads, writes in logic["memories"]:
        one_port += memory_model.area_um2(depth, width, node) / 1e6
        two_ports += memory_model.area_um2(depth, width, node, two_ports=reads + writes > 1) / 1e6
        picojoules += (reads + writes) * memory_model.energy_pj(depth, width, node, memory_model.VOLTAGE)
        leakage += memory_model.leakage_mw(depth, width)
    faster, memory_mw = clock / logic["clock_mhz"], picojoules * clock / 1e3 + leakage
    toggling_mw = logic["toggling_mw"] * faster
    logic_mw = logic["clock_mw"] * faster + toggling_mw + logic["leakage_mw"]
    cells, wires = grown(CELLS_UM2.values()), grown(SWITCHING_MW.values())
    trees = [milliwatts * ns / flops for milliwatts, ns, flops in TREE_MW_NS_FLOPS.values()]  # nJ a clock
    placed_mm2 = [
        logic["area_mm2"] * factor / ROWS_FILLED + memory
        for factor, memory in zip(cells, (one_port, two_ports), strict=True)
    ]
    placed_mw = [
        logic_mw + toggling_mw * capacitances() * (factor - 1) + logic["flip_flops"] * tree * clock / 1e3 + memory_mw
        for factor, tree in zip(wires, (min(trees), max(trees)), strict=True)
    ]
    return Estimate(
        logic["area_mm2"],
        logic_mw,
        (one_port, two_ports),
        memory_mw,
        (placed_mm2[0], placed_mm2[1]),
        (placed_mw[0], placed_mw[1]),
    )


def of_default_library(logic: Mapping[str, Any]) -> Estimate:
    """Return the estimate of logic that was measured with the default library."""
    by = mean_ratios()
    area_mm2 = logic["area_mm2"] * by.area
    clock_mw, toggling_mw = logic["clock_mw"] * by.clock, logic["toggling_mw"] * by.toggling
    scaled = {"area_mm2": area_mm2, "clock_mw": clock_mw, "toggling_mw": toggling_mw}
    return at_45_nm({**logic, **scaled, "leakage_mw": area_mm2 * by.leakage})


def designs() -> Iterator[tuple[str, str, Estimate, str]]:
    """Yield design, how its logic is known, estimate and commit; that of later RTL is known by the ratios."""
    old = recorded_runs()
    for name, run in old.items():
        yield name, "", at_45_nm(run["at_45"]), run["commit"]
    runs = [entry for line, entry in recorded.load().items() if line.startswith("make asic ") and "figures" in entry]
    later = {entry["name"]: entry for entry in runs if "name" in entry}
    for name, run in old.items():
        if name in later and later[name]["commit"] != run["commit"]:
            logic = later[name]["figures"]["logic"]
            yield name, ", by the ratios", of_default_library(logic), later[name]["commit"]


def rows(estimate: Estimate, logic: str) -> list[tuple[str, float, float, str]]:
    """Return name, area in mm2, power in mW and source of the lines that `make asic` prints."""
    at = f"45 nm, {published.CLOCK_MHZ:g} MHz"
    least, most = zip(estimate.placed_mm2, estimate.placed_mw, strict=True)
    whole = estimate.logic_mm2 + estimate.memory_mm2[0], estimate.logic_mw + estimate.memory_mw
    source = "estimate: wires and clock tree as in public runs with NanGate FreePDK45"
    return [
        (f"{at}, before placement", *whole, f"{logic}; memories by size, one port, with leakage"),
        (f"{at}, placed and routed, at least", *least, source),
        (f"{at}, placed and routed, at most", *most, f"{source}; second ports of memories"),
    ]


def main(commit: str, *designs: str) -> None:
    """Write FILE, a line for each design."""
    lines = []
    for design in designs:
        name, _, files = design.partition("=")
        small, large = (json.loads(Path(file).read_text()) for file in files.split(","))
        run = {"commit": commit, "command": small["command"], "library": small["library"]["sha256"]}
        run |= {"at_45": logic_of(small), "at_180": logic_of(large)}
        lines.append(f"{json.dumps(name)}: {json.dumps(recorded.rounded(run))}")
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
