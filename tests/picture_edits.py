# SPDX-License-Identifier: Apache-2.0
"""Edits of pictures that are refused or warned of, each with the message, and light that is right."""

from collections.abc import Callable
from typing import Any

import numpy as np
from PIL import Image

Edit = Callable[[np.ndarray], np.ndarray]
X, Y = np.linspace(-1, 1, 320)[None, :, None], np.linspace(-1, 1, 240)[:, None, None]


def in_light(light: Any) -> Edit:
    return lambda picture: np.clip(np.rint(picture * np.asarray(light)), 0, 255).astype(np.uint8)


def torn(first: int, shift: int) -> Edit:
    return lambda picture: np.concatenate((picture[:first], np.roll(picture[first:], shift, axis=1)))


def lost_bytes(first: int, count: int) -> Edit:
    def edit(picture: np.ndarray) -> np.ndarray:
        sent, begin = picture.reshape(-1), first * picture[0].size
        rest = np.concatenate((sent[begin + count :], np.zeros(count, np.uint8)))
        return np.concatenate((sent[:begin], rest)).reshape(picture.shape)

    return edit


def rest_of(first: int, colour: Any) -> Edit:
    def edit(picture: np.ndarray) -> np.ndarray:
        edited = picture.copy()
        edited[first:] = picture[first] if colour is None else colour
        return edited

    return edit


def channel(index: int, level: int) -> Edit:
    def edit(picture: np.ndarray) -> np.ndarray:
        edited = picture.copy()
        edited[..., index] = level
        return edited

    return edit


def grey(picture: np.ndarray) -> np.ndarray:
    return np.repeat(picture.mean(axis=-1, keepdims=True), 3, axis=-1).astype(np.uint8)


def saturated(share: float) -> Edit:
    def edit(picture: np.ndarray) -> np.ndarray:
        level = picture.mean(axis=-1, keepdims=True)
        return np.clip(np.rint(level + share * (picture - level)), 0, 255).astype(np.uint8)

    return edit


def ordered(*order: int) -> Edit:
    return lambda picture: np.ascontiguousarray(picture[..., order])


def few_colours(picture: np.ndarray) -> np.ndarray:
    return np.array(Image.fromarray(picture).quantize(256).convert("RGB"))


def mirrored(picture: np.ndarray) -> np.ndarray:
    return picture[:, ::-1].copy()


REFUSED: dict[str, tuple[Edit, str]] = {
    "black": (lambda p: np.zeros_like(p), "it is black"),
    "white": (lambda p: np.full_like(p, 255), "100.0 % of its pixels are clipped"),
    "one grey": (lambda p: np.full_like(p, 128), "one colour everywhere"),
    "one colour": (lambda p: np.full_like(p, (90, 110, 70)), "one colour everywhere"),
    "green alone": (in_light((0, 1, 0)), "has no red and no blue"),
    "no blue": (channel(2, 0), "has no blue"),
    "constant red": (channel(0, 70), "has no red"),
    "grey": (grey, "is grey"),
    "tinted grey": (lambda p: in_light((0.8, 1, 1.1))(grey(p)), "is grey"),
    "red and blue": (ordered(2, 1, 0), "red and blue are exchanged"),
    "red and green": (ordered(1, 0, 2), "red and green are exchanged"),
    "green and blue": (ordered(0, 2, 1), "green and blue are exchanged"),
    "blue first": (ordered(2, 0, 1), "in the order blue, red, green"),
    "red last": (ordered(1, 2, 0), "in the order green, blue, red"),
    "mirrored": (mirrored, "mirrored left to right"),
    "upside down": (lambda p: p[::-1].copy(), "mirrored top to bottom"),
    "rotated": (lambda p: np.rot90(p, 2).copy(), "rotated by 180 degrees"),
    "rotated and BGR": (lambda p: p[::-1, ::-1, ::-1].copy(), "red and blue are exchanged and it is rotated by 180"),
    "torn by 40 pixels": (torn(80, 40), "it is torn"),
    "torn by -33 pixels": (torn(97, -33), "it is torn"),
    "torn near the end": (torn(200, 40), "it is torn"),
    "40 pixels lost": (lost_bytes(80, 120), "it is torn"),
    "begun late": (lambda p: np.roll(p, 77, axis=0), "it is torn"),
    "half black": (rest_of(120, 0), "[45]. % of it are dark"),
    "the end black": (rest_of(200, 0), "1. % of it are dark"),
    "the rest grey": (rest_of(100, 128), "of its rows are one row, repeated"),
    "the rest green": (rest_of(170, (0, 135, 0)), "of its rows are one row, repeated"),
    "the rest a row": (rest_of(100, None), "of its rows are one row, repeated"),
    "clipped": (in_light(2.2), "of its pixels are clipped"),
    "few colours": (few_colours, "it has 2.. colours in all, as if reduced to a palette"),
    "clipped at 125": (lambda p: np.minimum(p, 125), "of its pixels are clipped"),
}
DOUBTED: dict[str, tuple[Edit, str]] = {
    "right side brighter": (
        in_light(1 + 0.02 * X),
        r"changes across it by 4 % in red, [34] % in green, [34] % in blue",
    ),
    "lower side brighter": (in_light(1 + 0.02 * Y), "changes across it by"),
    "one lamp": (in_light(1 + 0.03 * X * (1, 0, 0)), "changes across it by [56] % in red, 0 % in green, 0 % in blue"),
    "vignette": (in_light(1 - 0.06 * (X * X + Y * Y)), "changes across it by"),
    "a lamp's shadow": (in_light(np.where(X > 0.85, 0.9, 1)), "in all colours alike"),
    "saturated": (saturated(1.3), "changes across it by"),
    "30 % across": (in_light(1 + 0.3 * X), "changes across it by"),
    "a quarter of the light": (in_light(0.25), "differs from that of the reference by -75 % in red, -75 % in green"),
    "a little clipped": (in_light(1.62), "of its pixels are clipped, heights there are too small"),
    "a little clipped at 235": (
        lambda p: np.minimum(in_light(1.5)(p), 235),
        "of its pixels are clipped, heights there are too small",
    ),
    "a reflection": (
        lambda p: np.where(np.hypot(320 * X / 2 - 60, 240 * Y / 2 + 30) < 8, 255, p).astype(np.uint8),
        "of its pixels are white, as in a reflection",
    ),
    "rows of a damaged file": (
        lambda p: np.vstack((p[:-32], np.clip(p[-32:] * (0.5, 1.1, 0.7), 0, 255).astype(np.uint8))),
        "its lowest 12 % have other colours along the whole width",
    ),
    "noise": (
        lambda p: np.random.default_rng(1).integers(0, 256, p.shape, np.uint8),
        "differs by .* % from its",
    ),
    "other bytes lost": (lost_bytes(80, 40), "differs by .* % from its"),
}
LIGHTS = (0.8, 0.9, 0.95, 1.05, 1.1, 1.2, (1.05, 1, 0.95), (0.95, 1.05, 1), (1.1, 1, 0.9))
