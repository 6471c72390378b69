# SPDX-License-Identifier: Apache-2.0
"""Entries of the table of proofs, and what several of them say."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Proof:
    """A bench with its parameters.

    Attributes
    ----------
    claim : str
        The property, in words.
    sufficient : str
        Why these sizes are enough.
    parameters : mapping
        Of the bench.
    depth : int
        Clocks within which every cover is reached.
    engine : str
        Of mode prove.
    steps : int
        Clocks of the induction, and of its base case, with the engine smtbmc.
    roms : callable
        Writes the files that $readmemh reads into the folder given.
    free : tuple of str
        Wires of the core that take any values instead of their own.
    clocks : int
        Clocks of the core. With more than one, time is in steps, and each clock rises whenever it likes.
    core : str
        The bench is formal/<unit>/fv_<core>.sv; `make formal` sets it, from the bench that states the proof.
    """

    claim: str
    sufficient: str
    parameters: Mapping[str, int] = field(default_factory=dict)
    depth: int = 20
    engine: str = "abc pdr"
    steps: int = 20
    roms: Callable[[Path], None] | None = None
    free: tuple[str, ...] = ()
    clocks: int = 1
    core: str = ""

    @property
    def name(self) -> str:
        return "-".join([self.core, *(f"{key}{value}" for key, value in self.parameters.items())])


@dataclass(frozen=True)
class Cone:
    """Proof on the netlist of the whole that no pixel and no memory lies in the cone of a handshake or side-band.

    The cone is that of single bits; a memory passes everything from its inputs to its outputs. What holds of the cone
    holds of every frame, whatever it shows: the clocks at which words move are a function of the other inputs alone.
    """

    claim: str
    sufficient: str
    choices: Mapping[str, Any]
    core: str = ""
    engine: str = "yosys select"
    depth: int = 0

    @property
    def parameters(self) -> Mapping[str, int | str]:
        return self.choices

    @property
    def name(self) -> str:
        return "-".join([self.core, *(f"{key}{value}" for key, value in self.choices.items())])


FULL_WIDTH = "the widths in use"
ONE_ORDER = "the order is one formula for every power of two"
ROUNDING = "rounding is proven of td_round_saturate at full width"
WORD_FREE = "no word is looked at, so one bit stands for any width"
