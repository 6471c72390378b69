# SPDX-License-Identifier: Apache-2.0
"""Tables and sentences of make reflex and of the report."""

import math
from typing import Any

from commands.common.tabular import Table
from commands.run.reflex_model import SCALES


def plus_minus(values: dict[str, Any]) -> str:
    return f"{values['mean']:.1f} +- {values['sd']:.1f}"


def deciding_depths(document: dict[str, Any]) -> Table:
    """Return a row for each solver: where in the frame that leaves the deciding depth stands."""
    clock = document["clock_mhz"]
    rows = []
    for solver, result in document["sub_frame"]["solvers"].items():
        place, contact = result["place"], result["last_pixel_to_contact"]
        rows.append(
            (
                solver,
                f"{result['last_pixel_to_first_depth']:,}",
                f"{place['mean']:,.0f} ({place['min']:,.0f} to {place['max']:,.0f})",
                f"{100 * place['mean'] / math.prod(document['grid']):.0f} %",
                f"{contact['mean']:,.0f} ({contact['min']:,.0f} to {contact['max']:,.0f})",
                f"{contact['mean'] / clock:.1f}",
                ", ".join(map(str, result["deciding_to_contact"])),
            )
        )
    head = (
        *("solver", "last pixel to first depth", "depths before the deciding one", "of the frame"),
        *("last pixel to contact", "us", "deciding depth to contact"),
    )
    return Table(head, rows, f"The deciding depth in the frame that leaves, clocks (at {clock:g} MHz)")


def tables(document: dict[str, Any]) -> list[Table]:
    """Return the tables that the command prints and the report shows."""
    near, host, published = document["near"], document["host"], document["published"]

    def row(name: str, path: dict[str, Any], against: str) -> tuple[object, ...]:
        motion = path["motion"]
        spread = f"{motion['min']:.1f} to {motion['max']:.1f}"
        return (name, motion["trials"], plus_minus(path["command"]), plus_minus(motion), spread, against)

    def printed(name: str) -> dict[str, Any]:
        """Return published figures in the form of measured ones."""
        path = published[name]
        command, motion = (dict(zip(("mean", "sd"), path[key], strict=True)) for key in ("command", "motion"))
        low, high = path["range"]
        return {"command": command, "motion": motion | {"trials": path["trials"], "min": low, "max": high}}

    comparison = []
    for solver, path in near.items():
        against = " / ".join(f"{path[f'{key}_against_host']['U']:g}" for key in ("command", "motion"))
        comparison.append(row(f"near the sensor, {solver}", path, against))
    comparison.append(row("near the sensor, published", printed("near"), "0 / 0"))
    comparison += [row("host", host, "-"), row("host, published", printed("host"), "-")]
    first = next(iter(near))
    paths = {"near": (f"near, {first}", near[first]), "host": ("host", host)}
    parts = [
        (label, name, f"{part['mean']:.2f}", f"{part['sd']:.2f}")
        for label, path in paths.values()
        for name, part in path["parts"].items()
    ]
    sensitive = []
    for key, (name, base) in paths.items():
        for line in document["sensitivity"][key]:
            scaled = [line[f"x{scale:g}"] for scale in SCALES]
            shifts = [f"{one['mean'] - base['motion']['mean']:+.2f}" if one else "-" for one in scaled]
            spreads = [f"{one['sd']:.1f}" if one else "-" for one in scaled]
            sensitive.append((name, line["delay"], f"{line['value']:.4g}", *shifts, *spreads))
    return [
        Table(
            ("path", "trials", "to command", "to motion", "range", "U to command / to motion"),
            comparison,
            "Contact to command and to motion, ms",
        ),
        Table(("path", "part", "mean", "sd"), parts, "Where the time goes, ms"),
        Table(
            ("path", "delay", "distribution", "source"),
            [tuple(delay.values()) for delay in document["delays"]],
            "The delays",
        ),
        Table(
            ("path", "number", "value", "mean moves by, x 0.5", "x 2", "sd, x 0.5", "x 2"),
            sensitive,
            "Contact to motion with one number halved or doubled, ms",
        ),
        deciding_depths(document),
    ]


def sentences(document: dict[str, Any]) -> list[str]:
    """Return sentences that sum up the tables."""
    first, result = next(iter(document["near"].items()))
    earlier, why = document["sub_frame"]["tridiagonal_earlier_clocks"], document["difference"]
    share = 100 * earlier["mean_us"] / 1000 / result["command"]["mean"]
    verdict = "within" if all(one["within_published"] for one in document["near"].values()) else "NOT within"
    mean, spread = document["published"]["near"]["command"]

    def speed(key: str) -> str:
        return "infinitely many" if why[key] is None else f"{why[key]:.0f}"

    return [
        f"contact to motion near the sensor is {verdict} the published mean and trial-to-trial spread, both solvers",
        f"the tridiagonal solver's early start: {earlier['mean']:,.0f} clocks, {earlier['mean_us']:.1f} us, "
        f"{share:.1f} % of contact to command",
        f"growing to the threshold takes {why['growth_ms']:.1f} ms here; the published mean of {mean} ms would leave "
        f"it {why['growth_for_published_mean_ms']:.1f}, an approach of {speed('speed_for_published_mean_mm_s')} mm/s",
        f"the mean contact to motion stays within the published mean +- spread for an approach of about "
        f"{speed('slowest_within_mm_s')} to {speed('quickest_within_mm_s')} mm/s",
        f"the frame clock alone gives a spread of {why['spread_of_frame_clock_ms']:.2f} ms; of the published {spread} "
        f"ms {why['spread_left_ms']:.1f} ms are left to what differs from press to press and is not simulated",
        f"double precision decides in the same frame in {document['same_frame_by_double_precision']} of "
        f"{result['motion']['trials']} trials ({first})",
    ]
