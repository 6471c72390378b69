# SPDX-License-Identifier: Apache-2.0
"""Draws a result: the picture, the height map with its scales, and the surface in three dimensions."""

from __future__ import annotations

import math

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from tactile_depth.depth.result import Result

PANEL_WIDTH, GAP, MARGIN, BAR = 480, 96, 24, 16  # pixels
TITLE, LABEL = 20, 16  # sizes of letters
BACKGROUND, INK, FADED = (255, 255, 255), (32, 32, 32), (120, 120, 120)
OUTSIDE, DARK = (255, 165, 0), (255, 0, 255)  # of pixels, as in make sim: orange and magenta
SMOOTHING = 2  # the surface is drawn so many times larger
LARGEST_MESH = 128  # columns of the drawn surface
TALLEST = 0.35  # height of the drawn surface over its width, up to which small heights are exaggerated ..
LARGEST_EXAGGERATION = 5.0  # .. so many times
ELEVATION, AZIMUTH = math.radians(38), math.radians(-25)
LIGHT = np.array([-0.48, -0.36, 0.8])
# Nine colours of viridis, evenly spaced: https://bids.github.io/colormap (CC0).
VIRIDIS = np.array(
    [
        (68, 1, 84),
        (71, 44, 122),
        (59, 81, 139),
        (44, 113, 142),
        (33, 144, 141),
        (39, 173, 129),
        (92, 200, 99),
        (170, 220, 50),
        (253, 231, 37),
    ]
)

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


def colours(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """Return the colours of values, uint8 (.., 3), from `low`, dark blue, to `high`, yellow."""
    share = (values - low) / max(high - low, 1e-9) * (len(VIRIDIS) - 1)
    channels = [np.interp(share, range(len(VIRIDIS)), VIRIDIS[:, channel]) for channel in range(3)]
    return np.rint(np.stack(channels, axis=-1)).astype(np.uint8)


def round_number(limit: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a limit."""
    power = 10.0 ** math.floor(math.log10(limit))
    return max(step * power for step in (1, 2, 5) if step * power <= limit)


def draw_overview(picture: np.ndarray, result: Result, caption: str) -> Image.Image:
    """Draw one result.

    Parameters
    ----------
    picture : uint8 array (rows, columns, 3)
    result : Result
        Of a single picture.
    caption : str
    """
    rows, columns = result.codes.shape
    height = result.height_mm
    low, high = min(float(height.min()), 0.0), max(float(height.max()), result.threshold_mm)
    size = (PANEL_WIDTH, round(PANEL_WIDTH * rows / columns / result.pixel_aspect))
    top = MARGIN + TITLE + 12
    width = 3 * PANEL_WIDTH + GAP + 2 * MARGIN + MARGIN
    canvas = Image.new("RGB", (width, top + size[1] + 24 + 3 * (LABEL + 8)), BACKGROUND)
    draw = ImageDraw.Draw(canvas)
    title, label = ImageFont.load_default(TITLE), ImageFont.load_default(LABEL)
    lefts = (MARGIN, 2 * MARGIN + PANEL_WIDTH, 2 * MARGIN + 2 * PANEL_WIDTH + GAP)
    for left, text in zip(lefts, ("picture", "height", "surface"), strict=True):
        draw.text((left, MARGIN), text, INK, title)
    canvas.paste(_whole(picture, rows, columns).resize(size, Image.Resampling.LANCZOS), (lefts[0], top))
    pixels = colours(height, low, high)
    pixels[result.outside], pixels[result.dark] = OUTSIDE, DARK
    canvas.paste(Image.fromarray(pixels).resize(size, Image.Resampling.NEAREST), (lefts[1], top))
    _colour_bar(draw, label, (lefts[1] + PANEL_WIDTH + 8, top, size[1]), low, high)
    surface, exaggeration = _surface(height, result.pixel_pitch_mm, low, high, size)
    canvas.paste(surface, (lefts[2], top))

    below = top + size[1] + 10
    _scale_bar(draw, label, (lefts[1], below), columns * result.pixel_pitch_mm * result.pixel_aspect)
    draw.text((lefts[2], below), f"height drawn {exaggeration:.3g} times as tall", FADED, label)
    left = lefts[1]
    for colour, text, mask in (
        (OUTSIDE, "steeper than calibrated", result.outside),
        (DARK, "without light", result.dark),
    ):
        draw.rectangle((left, below + LABEL + 12, left + LABEL - 4, below + 2 * LABEL + 8), colour)
        text = f"{text}: {int(mask.sum()):,} px"
        draw.text((left + LABEL + 2, below + LABEL + 8), text, FADED, label)
        left += LABEL + 18 + round(draw.textlength(text, label))
    draw.text((MARGIN, below + 2 * (LABEL + 8)), _shortened(draw, label, caption, width - 2 * MARGIN), INK, label)
    return canvas


def _whole(picture: np.ndarray, rows: int, columns: int) -> Image.Image:
    """Crop a picture to the part that the grid shows: centred, of the grid's aspect ratio."""
    height, width = picture.shape[:2]
    across = min(width, round(height * columns / rows))
    down = min(height, round(width * rows / columns))
    y, x = (height - down) // 2, (width - across) // 2
    return Image.fromarray(picture[y : y + down, x : x + across])


def _colour_bar(
    draw: ImageDraw.ImageDraw,
    font: Font,
    place: tuple[int, int, int],
    low: float,
    high: float,
) -> None:
    """Draw the scale of heights right of the map; `place`: left, top, height."""
    left, top, height = place
    for row in range(height):
        value = high - (high - low) * row / (height - 1)
        colour = tuple(int(c) for c in colours(np.array(value), low, high))
        draw.line((left, top + row, left + BAR, top + row), colour)
    step = round_number((high - low) / 3)
    digits = max(0, -math.floor(math.log10(step)))
    for multiple in range(math.ceil(low / step), math.floor(high / step) + 1):
        y = top + round((high - multiple * step) / (high - low) * (height - 1))
        draw.line((left + BAR, y, left + BAR + 4, y), INK)
        draw.text((left + BAR + 7, y - LABEL // 2 - 1), f"{multiple * step:.{digits}f}", INK, font)
    draw.text((left, top - LABEL - 8), "mm", INK, font)


def _scale_bar(
    draw: ImageDraw.ImageDraw,
    font: Font,
    place: tuple[int, int],
    width_mm: float,
) -> None:
    """Draw a length of about a quarter of the width below the map."""
    left, top = place
    length_mm = round_number(width_mm / 3)
    length = round(length_mm / width_mm * PANEL_WIDTH)
    middle = top + LABEL // 2
    draw.line((left, middle, left + length, middle), INK, 3)
    draw.text((left + length + 8, top), f"{length_mm:g} mm", INK, font)


def _surface(
    height: np.ndarray, pitch: float, low: float, high: float, size: tuple[int, int]
) -> tuple[Image.Image, float]:
    """Draw the surface, farthest cells first, and say how much taller it is drawn than it is."""
    step = max(1, math.ceil(height.shape[1] / LARGEST_MESH))
    z = height[::step, ::step]
    rows, columns = z.shape
    y, x = np.mgrid[:rows, :columns].astype(np.float64)
    x, y = x - (columns - 1) / 2, (rows - 1) / 2 - y
    tallest = TALLEST * columns * step * pitch / max(high - low, 1e-9)
    exaggeration = min(round_number(max(tallest, 1.0)), LARGEST_EXAGGERATION)
    z = z * exaggeration / (pitch * step)
    slope_y, slope_x = np.gradient(z)
    normal = np.stack([-slope_x, slope_y, np.ones_like(z)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    shade = 0.35 + 0.65 * np.clip(normal @ LIGHT, 0, 1)
    shaded = np.clip(colours(height[::step, ::step], low, high) * shade[..., None], 0, 255).astype(np.uint8)
    across = x * math.cos(AZIMUTH) - y * math.sin(AZIMUTH)
    depth = x * math.sin(AZIMUTH) + y * math.cos(AZIMUTH)  # larger: farther away
    up = depth * math.sin(ELEVATION) + z * math.cos(ELEVATION)
    spans = (float(np.ptp(across)), float(np.ptp(up)))
    scale = SMOOTHING * min((length - 8) / span for length, span in zip(size, spans, strict=True))
    to_x = SMOOTHING * size[0] / 2 + (across - (across.min() + across.max()) / 2) * scale
    to_y = SMOOTHING * size[1] / 2 - (up - (up.min() + up.max()) / 2) * scale
    canvas = Image.new("RGB", (SMOOTHING * size[0], SMOOTHING * size[1]), BACKGROUND)
    draw = ImageDraw.Draw(canvas)
    corners = np.stack([to_x, to_y], axis=-1)
    cells = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]], axis=2)
    order = np.argsort(-depth[:-1, :-1], axis=None)
    shaded = shaded[:-1, :-1].reshape(-1, 3)
    flat = cells.reshape(-1, 8)
    for index in order:
        draw.polygon(flat[index].tolist(), fill=tuple(shaded[index].tolist()))
    return canvas.resize(size, Image.Resampling.LANCZOS), exaggeration


def _shortened(draw: ImageDraw.ImageDraw, font: Font, text: str, width: int) -> str:
    """Cut the beginning of a line, which is a path, until the line fits."""
    if draw.textlength(text, font) <= width:
        return text
    while text and draw.textlength(".." + text, font) > width:
        text = text[1:]
    return ".." + text
