# SPDX-License-Identifier: Apache-2.0
"""Reasons why a picture is refused, or why its heights are uncertain."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, Part, warn
from tactile_depth.sensor.verdict import BAD, Verdict

COLOURS = ("red", "green", "blue")
REFERENCE = Argument("reference")
TAKE_ANOTHER = ("take a ", REFERENCE, " with the sensor untouched, in the light of the pictures")

CLIPPED = 250  # grey levels from which a pixel counts as clipped
# A camera may clip below: at the largest level of a colour, if that holds more than `PILE` times the mean of so many
# levels below it, and pixels enough that it is no chance on a small grid. Where it holds 0.5 % of the pixels, of the
# picture or of its means on the grid: right, in light times 0.5 to 1.1, as JPEG of quality 50 to 95, with noise,
# enlarged: 1.2 times at most. Clipped at 130 to 235, where that makes a height 5 % too low: 2.6 times and more.
PILE, PILE_LEVELS, PILE_PIXELS = 2, 6, 20
# Pictures drawn without noise have piles at any level. Share of equal neighbours below the largest level, of a camera:
# 0.42 at most, as JPEG of quality 75 0.63; drawn without noise: 0.78 and more.
NO_NOISE = 0.7
# Share of pixels with a clipped colour. Right: 0. Presses and reference made brighter by 1.5, 1.65, 1.8, 1.9: 0.7, 2,
# 11, 18 % clipped, heights 1.5, 5, 11, 16 % too low on average, 6, 15, 29, 37 % at worst.
CLIPPED_DOUBTFUL, CLIPPED_REFUSED = 0.005, 0.1
# The same of all colours at once, as in a reflection. Right: 0; a white disc of 5 of 320 pixels 0.001, of 8 0.0026,
# with which peaks are off by up to 11 %, and heights beside it by half.
WHITE = 0.0007

LIGHT = "light"  # kind of the doubt that light gains may end
VIEW = "view"  # kind of the doubt of a reference that shows more or less of the gel than it should
TOUCHED = "contact in the zero offset"
BY_VIEW = ("uneven light", "no surface", "pressed out")  # kinds that come of slopes and contacts of a wrong size
SETTLING = 8  # pictures in a row after which the light gains of a stream have followed a change of the light


class UnusablePicture(InputError):
    """A picture that gives no right depth; a stream leaves it out and counts it as failed."""


@dataclass(frozen=True)
class Doubt:
    """Reason why heights are uncertain; a stream warns of each `kind` once."""

    kind: str
    warning: InputWarning

    def __str__(self) -> str:
        return str(self.warning)


def doubt(kind: str, *parts: Part, remedy: str | Iterable[Part]) -> Doubt:
    """Return a doubt with a message of these parts."""
    return Doubt(kind, InputWarning(*parts, remedy=remedy))


def of_verdict(verdict: Verdict | None) -> tuple[Doubt, ...]:
    """Doubt all heights of a calibration whose verdict is bad."""
    if verdict is None or verdict.grade != BAD:
        return ()
    problem = "the verdict of the calibration is bad: heights may be wrong"
    return (doubt("verdict", problem, remedy="calibrate again"),)


@dataclass
class Warned:
    """Doubts that a stream has warned of: each kind once, and the light when its gains had time to follow.

    Attributes
    ----------
    kinds : set of str
    unsettled : int
        Pictures in a row whose light the gains did not undo.
    """

    kinds: set[str] = field(default_factory=set)
    unsettled: int = 0

    def new(self, doubts: Iterable[Doubt]) -> list[Doubt]:
        """Return those doubts of the next picture that are to be warned of."""
        by_kind = {doubt.kind: doubt for doubt in doubts}
        self.unsettled = self.unsettled + 1 if LIGHT in by_kind else 0
        if self.unsettled < SETTLING:
            by_kind.pop(LIGHT, None)
        new = [doubt for kind, doubt in by_kind.items() if kind not in self.kinds]
        self.kinds |= by_kind.keys()
        return new


def unexplained(doubts: Iterable[Doubt], of_reference: Iterable[Doubt]) -> tuple[Doubt, ...]:
    """Return the doubts of a picture that do not come of the view of its reference or of a wrong zero offset."""
    is_told = any(each.kind in (VIEW, TOUCHED) for each in of_reference)
    return tuple(each for each in doubts if not (is_told and each.kind in BY_VIEW))


def tell(doubts: Iterable[Doubt]) -> None:
    """Warn of each doubt."""
    for each in doubts:
        warn(each.warning)


def clipped(pictures: np.ndarray, name: Part, levels: Sequence[int] = (CLIPPED,) * 3) -> list[Doubt]:
    """Refuse pictures (frames, rows, columns, 3) with many clipped pixels; doubt those with some.

    Parameters
    ----------
    levels : of each colour, from which a pixel counts as clipped
    """
    if pictures.max() < min(levels):
        return []
    red, green, blue = (of >= level for of, level in zip(_colours(pictures), levels, strict=True))
    share, white = float((red | green | blue).mean()), float((red & green & blue).mean())
    text = f": {100 * share:.1f} % of its pixels are clipped"
    remedy = "take it with a shorter exposure, and the reference too"
    if share > CLIPPED_REFUSED:
        raise UnusablePicture(name, text, accepted=f"up to {100 * CLIPPED_REFUSED:.0f} %", remedy=remedy)
    if share > CLIPPED_DOUBTFUL:
        return [doubt("clipped", name, f"{text}, heights there are too small", remedy=remedy)]
    if white <= WHITE:
        return []
    text = f": {100 * white:.1f} % of its pixels are white, as in a reflection, heights there and beside are wrong"
    return [doubt("clipped", name, text, remedy="keep light off the gel, and drops off the lens")]


def clip_levels(pictures: np.ndarray) -> list[int]:
    """Return the level of each colour of pictures (.., columns, 3) from which a pixel counts as clipped."""
    result = []
    for colour, levels in enumerate(_colours(pictures)):
        largest = int(levels.max())
        at_largest = np.count_nonzero(levels == largest)
        below = np.count_nonzero(levels >= max(largest - PILE_LEVELS, 0)) - at_largest
        is_pile = at_largest >= PILE_PIXELS and at_largest * PILE_LEVELS > PILE * below > 0
        is_clipped = is_pile and _equal_neighbours(pictures[..., colour], largest) < NO_NOISE
        result.append(min(largest, CLIPPED) if is_clipped else CLIPPED)
    return result


def _equal_neighbours(levels: np.ndarray, largest: int) -> float:
    """Return the share of equal neighbours in rows of levels (.., columns) among those below the largest level."""
    below = levels < largest
    both = below[..., 1:] & below[..., :-1]
    return float((levels[..., 1:] == levels[..., :-1])[both].mean()) if both.any() else 1.0


def _colours(pictures: np.ndarray) -> np.ndarray:
    """Return the levels of each colour of pictures (.., 3), (3, pixels): one after the other, as numpy is fast on."""
    return np.ascontiguousarray(pictures.reshape(-1, 3).T)


def percents(changes: np.ndarray, sign: str = "+") -> str:
    """Return changes of the three colours as text, in percent."""
    return ", ".join(f"{100 * change:{sign}.0f} % in {colour}" for change, colour in zip(changes, COLOURS, strict=True))
