# SPDX-License-Identifier: Apache-2.0
"""Draws panels side by side, with PIL alone: pictures, maps with their scales, and lines over the width of a map."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont

GAP, MARGIN, BAR = 96, 24, 16  # pixels
TITLE, LABEL = 20, 16  # sizes of letters
BACKGROUND, PLAIN, INK, FADED = (255, 255, 255), (244, 244, 244), (32, 32, 32), (160, 160, 160)
OUTSIDE, DARK = (255, 165, 0), (255, 0, 255)  # of doubtful pixels: orange and magenta
# Nine colours of viridis, evenly spaced: https://bids.github.io/colormap (CC0).
VIRIDIS = ("#440154", "#472c7a", "#3b518b", "#2c718e", "#21908d", "#27ad81", "#5cc863", "#aadc32", "#fde725")
AROUND_ZERO = ("#7f3b08", "#f1a340", "#f7f7f7", "#998ec3", "#2d004b")

Colour = tuple[int, int, int]
Curve = tuple[Colour, np.ndarray]
"""Colour of a line, and its points across and down, float64 (2, n), in shares of a panel's width and height."""


@dataclass(frozen=True)
class Panel:
    """A picture, uint8 (rows, columns, 3), with its title, the scale at its right, and lines over it."""

    title: str
    pixels: np.ndarray
    scale: Scale | None = None
    curves: Sequence[Curve] = ()


@dataclass(frozen=True)
class Scale:
    """Colours of values from `low` to `high`."""

    low: float
    high: float
    unit: str = "mm"
    palette: tuple[str, ...] = VIRIDIS

    def colours(self, values: np.ndarray) -> np.ndarray:
        """Return the colours of values, uint8 (.., 3)."""
        steps = np.linspace(self.low, self.high, len(self.palette))
        channels = np.transpose([ImageColor.getrgb(colour) for colour in self.palette])
        return np.rint(np.stack([np.interp(values, steps, each) for each in channels], axis=-1)).astype(np.uint8)

    def map(
        self,
        title: str,
        values: np.ndarray,
        marks: Iterable[tuple[np.ndarray, Colour]] = (),
        curves: Sequence[Curve] = (),
    ) -> Panel:
        """Return the panel of a map (rows, columns), painted as `painted` does."""
        return Panel(title, painted(self.colours(values), marks), self, curves)

    def profile(self, title: str, lines: Iterable[tuple[Colour, np.ndarray]]) -> Panel:
        """Return a panel of lines, each from values at evenly spaced places; it has gaps where a value is NaN."""
        curves = []
        for colour, values in lines:
            at = np.flatnonzero(np.isfinite(values))
            down = (self.high - values[at]) / (self.high - self.low)
            curves.append((colour, np.stack(((at + 0.5) / len(values), down))))
        return Panel(title, np.full((1, 1, 3), PLAIN, np.uint8), self, curves)


def painted(pixels: np.ndarray, marks: Iterable[tuple[np.ndarray, Colour]]) -> np.ndarray:
    """Return a picture with the pixels of masks in the colours of the masks."""
    pixels = pixels.copy()
    for mask, colour in marks:
        pixels[mask] = colour
    return pixels


def round_number(limit: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a limit."""
    power = 10.0 ** math.floor(math.log10(limit))
    return max(step * power for step in (1, 2, 5) if step * power <= limit)


def sheet(
    rows: Sequence[Sequence[Panel]],
    width: int,
    size_mm: tuple[float, float],
    notes: Sequence[tuple[Colour, str]],
    caption: str,
) -> Image.Image:
    """Draw rows of panels, below them a length in mm, the meaning of colours and a caption.

    Parameters
    ----------
    width : int
        Width of a panel in pixels.
    size_mm : (float, float)
        Width and height of what a panel shows.
    """
    across_mm, down_mm = size_mm
    size = (width, round(width * down_mm / across_mm))
    across, down = width + GAP, size[1] + TITLE + MARGIN
    below = MARGIN + down * len(rows)
    canvas = Image.new("RGB", (MARGIN + across * len(rows[0]), below + 2 * (LABEL + MARGIN)), BACKGROUND)
    draw = ImageDraw.Draw(canvas)
    label = ImageFont.load_default(LABEL)
    for y, panels in enumerate(rows):
        for x, panel in enumerate(panels):
            _draw_panel(canvas, panel, (MARGIN + x * across, MARGIN + y * down + TITLE + 8), size)
    length_mm = round_number(across_mm / 3)
    left, middle = MARGIN + round(length_mm / across_mm * width), below + LABEL // 2
    draw.line((MARGIN, middle, left, middle), INK, 3)
    for colour, text in ((None, f"{length_mm:g} mm"), *notes):
        if colour is not None:
            draw.rectangle((left, below + 2, left + LABEL - 4, below + LABEL - 2), colour)
            left += LABEL - 8
        draw.text((left + 8, below), text, INK, label)
        left += 32 + round(draw.textlength(text, label))
    text = _shortened(draw, label, caption, canvas.width - 2 * MARGIN)
    draw.text((MARGIN, below + LABEL + MARGIN // 2), text, INK, label)
    return canvas


def _draw_panel(canvas: Image.Image, panel: Panel, corner: tuple[int, int], size: tuple[int, int]) -> None:
    """Draw a panel whose upper left corner is there, with the scale at its right."""
    draw, title, label = ImageDraw.Draw(canvas), ImageFont.load_default(TITLE), ImageFont.load_default(LABEL)
    (left, top), (width, height) = corner, size
    draw.text((left, top - TITLE - 8), _shortened(draw, title, panel.title, width + GAP // 2), INK, title)
    canvas.paste(Image.fromarray(panel.pixels).resize(size, Image.Resampling.BOX), corner)
    for colour, points in panel.curves:
        draw.line((points.T * size + corner).ravel().tolist(), colour, 2)
    if (scale := panel.scale) is None:
        return
    left += width + 8
    bar = scale.colours(np.linspace(scale.high, scale.low, height)[:, None].repeat(BAR, axis=1))
    canvas.paste(Image.fromarray(bar), (left, top))
    step = round_number((scale.high - scale.low) / 3)
    digits = max(0, -math.floor(math.log10(step)))
    for multiple in range(math.ceil(scale.low / step), math.floor(scale.high / step) + 1):
        y = top + round((scale.high - multiple * step) / (scale.high - scale.low) * (height - 1))
        draw.line((left + BAR, y, left + BAR + 4, y), INK)
        draw.text((left + BAR + 7, y - LABEL // 2 - 1), f"{multiple * step:.{digits}f}", INK, label)
    draw.text((left + BAR + 7, top - TITLE - 4), scale.unit, INK, label)


def _shortened(
    draw: ImageDraw.ImageDraw, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, text: str, width: int
) -> str:
    """Replace what is no character of a line, which has a path, and cut its beginning until the line fits."""
    text = "".join(each if each.isprintable() else "?" for each in text)
    if draw.textlength(text, font) <= width:
        return text
    while text and draw.textlength(".." + text, font) > width:
        text = text[1:]
    return ".." + text
