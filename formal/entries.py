# SPDX-License-Identifier: Apache-2.0
"""Entries of the table of proofs, and what several of them say."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar


@dataclass(frozen=True)
class Proof:
    """Run of the bench formal/<unit>/fv_<core>.sv, whose header states the claim, with its parameters.

    Attributes
    ----------
    sufficient : str
        Why these sizes are enough.
    parameters : mapping
        Of the bench.
    steps : int
        Clocks of the induction, and of its base case; 0: no induction, but the engine abc pdr.
    roms : callable
        Writes the files that $readmemh reads into the folder given.
    free : tuple of str
        Wires of the core that take any values instead of their own.
    core : str
        `make formal` sets it, from the testbench that states the proof.
    """

    sufficient: str
    parameters: Mapping[str, int] = field(default_factory=dict)
    steps: int = 0
    roms: Callable[[Path], None] | None = None
    free: tuple[str, ...] = ()
    core: str = ""

    @property
    def name(self) -> str:
        return "-".join([self.core, *(f"{key}{value}" for key, value in self.parameters.items())])

    @property
    def engine(self) -> str:
        return "smtbmc bitwuzla -- --noincr" if self.steps else "abc pdr"


@dataclass(frozen=True)
class Cone:
    """Proof on the netlist of the whole that no pixel and no memory lies in the cone of a handshake or side-band.

    The cone is that of single bits; a memory passes everything from its inputs to its outputs. What holds of the cone
    holds of every frame, whatever it shows: the clocks at which words move are a function of the other inputs alone.
    """

    sufficient: str
    choices: Mapping[str, Any]
    core: str = ""
    engine: ClassVar[str] = "yosys select"

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
