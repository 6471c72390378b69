# SPDX-License-Identifier: Apache-2.0
"""Map of the presses of a fit, as SVG: each contact on the picture's frame, with the recovered height of its cap."""

import csv
import math
from pathlib import Path

SIZE = (320, 240)  # columns and rows of the pictures
SCALE = 2  # pixels of the drawing for one
TURN = 1.11  # radians along the circle from label to label: those of the DIGIT of docs/digit.csv do not overlap
PAPER, INK = "#ffffff", "#202020"
COLOURS = {0.94: "#21908d", 0.88: "#5cc863", 0.0: "#fda525"}  # within 6 %, 12 % of the height, and worse


def colour(ratio: float) -> str:
    """Return the colour of recovered over true height; too high counts as too low."""
    return next(colour for least, colour in COLOURS.items() if 1 - abs(ratio - 1) >= least)


def press_map(table: Path) -> str:
    """Return the drawing of a table with columns centre_x_px, centre_y_px, contact_radius_px and cap_height."""
    width, height = (SCALE * length for length in SIZE)
    shapes = [f'<rect width="{width}" height="{height}" fill="{PAPER}" stroke="{INK}" paint-order="fill"/>']
    labels = []
    with table.open(encoding="utf-8", newline="") as file:
        for number, row in enumerate(csv.DictReader(file)):
            x, y, radius = (SCALE * float(row[f"{name}_px"]) for name in ("centre_x", "centre_y", "contact_radius"))
            ratio = float(row["cap_height"])
            across, down = x + radius * math.cos(TURN * number), y + radius * math.sin(TURN * number)
            shapes.append(
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="none" stroke="{colour(ratio)}" '
                'stroke-width="3"/>'
            )
            labels.append(f'<text x="{across:.1f}" y="{down:.1f}" stroke-width="5">{ratio:.2f}</text>')
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
    return "\n".join(
        [
            f'{head} font-family="sans-serif" font-size="15" text-anchor="middle" dominant-baseline="middle" '
            f'stroke="{PAPER}" paint-order="stroke" fill="{INK}">',
            *shapes,
            *labels,
            "</svg>\n",
        ]
    )
