# SPDX-License-Identifier: Apache-2.0
"""Declaration of a choice of a configuration: how users name it, and what it accepts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

Own = TypeVar("Own", bound="Choice")  # typing.Self, which Python 3.10 lacks


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Names of a choice, which stand with its field of `Configuration` and nowhere else.

    Attributes
    ----------
    argument : str
        Argument of `td.Pipeline`; by default the field.
    variable : str
        Variable of make; by default the argument in capitals.
    option : str
        Option of the command line, with {} for the value; by default the argument with dashes.
    """

    argument: str = ""
    variable: str = ""
    option: str = ""

    def of(self: Own, field: str) -> Own:
        """Return the choice of a field with all its names."""
        argument = self.argument or field
        option = self.option or f"--{argument.replace('_', '-')} {{}}"
        return replace(self, argument=argument, variable=self.variable or argument.upper(), option=option)


@dataclass(frozen=True, kw_only=True)
class Number(Choice):
    """A whole number, from the least to the most that are accepted.

    Attributes
    ----------
    meaning : str
        Its unit and what it counts, as help texts and pages state it.
    letter : str
        Letter by which names of folders always state it; they state others by their field, unless they are the default.
    colours : bool
        It has an effect with a flat field alone.
    """

    meaning: str
    accepted: tuple[int, int]
    letter: str = ""
    colours: bool = False


class Width(Number):
    """Bits of a word, which searches of word lengths vary."""
