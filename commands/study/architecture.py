# SPDX-License-Identifier: Apache-2.0
"""Tables of docs/architecture.md: latency by core, number formats, multipliers and memories.

`python -m commands.study.architecture` writes them between the two marks of the page, from the models.
"""

from commands.common.repository import ROOT
from commands.common.tabular import compact, with_tables
from commands.cost.cost import KINDS, Cost, cost
from tactile_depth.chip import latency
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format

PAGE = ROOT / "docs" / "architecture.md"
BEGIN, END = "<!-- tables: python -m commands.study.architecture -->", "<!-- end of the tables -->"
SENSOR = {"flat_field": True, "gradient_model": "cubic", "light_gains": True, "neumann": True, "zero_offset": True}
BUILDS = {
    "tridiagonal, real sensor": Configuration(solver="tridiagonal", **SENSOR),  # type: ignore[arg-type]
    "tridiagonal, as sent": Configuration(solver="tridiagonal"),
    "spectral, as sent": Configuration(),
}
TRIDIAGONAL_NODES = {
    "slope": "gradient",
    "divergence": "divergence",
    "forward transform of a row": "row_forward",
    "elimination": "elimination",
    "stored word of the frame store": "elimination_store",
    "inverse transform of a row": "row_inverse",
    "depth": "depth",
}
SPECTRAL_NODES = {
    "slope": "gradient",
    "divergence": "divergence",
    "forward transform of a row": "row_forward",
    "stored word of the first frame store": "row_modes",
    "forward transform of a column": "column_forward",
    "inverse transform of a column": "column_inverse",
    "stored word of the second frame store": "depth_modes",
    "inverse transform of a row": "row_inverse",
    "depth": "depth",
}


def cycles(config: Configuration) -> list[tuple[object, ...]]:
    """Return unit, core and cycles from the last pixel of a frame to its first depth value, and their sum."""
    rows = [row for row in latency.by_core(config) if row[2]]
    return [*rows, ("", "**sum**", f"**{sum(row[2] for row in rows):,}**")]


def formats(config: Configuration, nodes: dict[str, str]) -> list[tuple[object, ...]]:
    """Return the fixed-point format of each node: bits, bits behind the point, full scale, least step."""
    rows_of_nodes: list[tuple[object, ...]] = []
    for name, attribute in nodes.items():
        form: Format = getattr(config, attribute)
        rows_of_nodes.append((name, form.width, form.fraction, f"{form.limit:g}", f"2^-{form.fraction}"))
    return rows_of_nodes


def by_core(costs: list[Cost]) -> list[tuple[object, ...]]:
    """Return for each core its multipliers and bits of memory in each build."""
    counts = [one.by_core() for one in costs]
    return [
        (core, *("{} / {:,}".format(*count[core]) if core in count else "" for count in counts))
        for core in dict.fromkeys(core for count in counts for core in count)
    ]


def tables() -> str:
    """Return the text between the marks."""
    text = "### Latency by core\n\nFrom the last pixel of a 128 x 128 frame to its first depth value, in cycles.\n"
    for name, config in BUILDS.items():
        text += f"\nBuild: {name}.\n\n" + compact(("unit", "core", "cycles"), cycles(config))
    text += "\n### Number formats\n\nWords are signed: value = code / 2^fraction, in the unit of the signal.\n"
    head = ("signal", "bits", "fraction", "full scale", "step")
    for name, nodes in (("tridiagonal, as sent", TRIDIAGONAL_NODES), ("spectral, as sent", SPECTRAL_NODES)):
        text += f"\nBuild: {name}, 128 x 128.\n\n" + compact(head, formats(BUILDS[name], nodes))
    text += "\n### Multipliers and memories\n\nOf a 128 x 128 build. A multiplier is one of 27 x 18 bits.\n\n"
    costs = {name: cost(config) for name, config in BUILDS.items()}
    rows: list[tuple[object, ...]] = [
        (name, one.tiles, *(f"{one.bits_of(kind):,}" for kind in KINDS), f"{one.memory_bits:,}")
        for name, one in costs.items()
    ]
    text += compact(("build", "multipliers", *(f"{kind}, bits" for kind in KINDS), "all memories, bits"), rows)
    text += "\nBy core: multipliers / bits of memory. The spectral solver has each transform and `transpose` twice.\n\n"
    return text + compact(("core", *costs), by_core(list(costs.values())))


def document() -> str:
    """Return the page with fresh tables."""
    return with_tables(PAGE, BEGIN, END, tables())


if __name__ == "__main__":
    PAGE.write_text(document())
