# SPDX-License-Identifier: Apache-2.0
"""Tables of docs/architecture.md: latency by core, number formats, multipliers and memories.

`python -m commands.study.architecture` writes them between the two marks of the page, from the models.
"""

from commands.common.markdown import compact, with_tables
from commands.common.repository import ROOT
from tactile_depth import latency
from tactile_depth.configuration import Configuration, Format
from tactile_depth.cost import CORES, KINDS, Cost, cost

PAGE = ROOT / "docs" / "architecture.md"
BEGIN, END = "<!-- tables: python -m commands.study.architecture -->", "<!-- end of the tables -->"
SENSOR = {"flat_field": True, "gradient_model": "quadratic", "neumann": True, "zero_offset": True}
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
    """Return unit, core and cycles on the way from the last pixel of a frame to its first depth value.

    Raises AssertionError: they do not add up to the latency of the pipeline.
    """
    size = config.columns
    forward, inverse = latency.dst_forward_latency(size), latency.dst_inverse_latency(size)
    rows: list[tuple[str, str, int]] = [
        ("video_unit", "td_axis_skid", latency.AXIS_SKID),
        ("video_unit", "frame_guard", latency.FRAME_GUARD),
        ("gradient_unit", "flat_field", latency.FLAT_FIELD if config.flat_field else 0),
        ("gradient_unit", "quadratic_gradient", latency.QUADRATIC_GRADIENT)
        if config.gradient_model == "quadratic"
        else ("gradient_unit", "gradient_lookup", latency.GRADIENT_LOOKUP),
        ("poisson_unit", "divergence", latency.DIVERGENCE),
        ("poisson_unit", "row_reorder", latency.ROW_REORDER),
        ("poisson_unit", "dst_forward, of the last row", forward),
    ]
    if config.solver == "tridiagonal":
        rows += [
            ("poisson_unit", "forward_elimination", latency.FORWARD_ELIMINATION),
            ("poisson_unit", "frame_stack, turns the order of the rows", latency.FRAME_STACK),
            ("poisson_unit", "back_substitution", latency.BACK_SUBSTITUTION),
        ]
    else:
        rows += [
            ("poisson_unit", "transpose, to columns", latency.TRANSPOSE),
            ("poisson_unit", "dst_forward, of a column", forward),
            ("poisson_unit", "spectral_divide", latency.SPECTRAL_DIVIDE),
            ("poisson_unit", "dst_inverse, of a column", inverse),
            ("poisson_unit", "all other columns", size * (size - 1)),
            ("poisson_unit", "transpose, to rows", latency.TRANSPOSE),
        ]
    rows += [
        ("poisson_unit", "dst_inverse, of the first row out", inverse),
        ("poisson_unit", "row_reorder, waits for the whole row", size - 1 + latency.ROW_REORDER),
        ("depth_unit", "zero_offset", latency.zero_latency(config)),
        ("contact_unit", "depth_gate", latency.AXIS_SKID),
    ]
    total = sum(row[2] for row in rows)
    assert total == latency.last_pixel_to_first_depth(config)
    return [*(row for row in rows if row[2]), ("", "**sum**", f"**{total:,}**")]


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
        for core in CORES
        if any(core in count for count in counts)
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
