# SPDX-License-Identifier: Apache-2.0
"""The only error that a user's input raises, and the only warning; both hold the arguments that they name as data."""

import functools
import os
import sys
import warnings
from collections.abc import Callable, Iterable
from numbers import Integral, Real
from typing import Any, NamedTuple

LONGEST = 1000  # characters
REPOSITORY = "https://github.com/tactile-depth/tactile-depth"  # where what messages name is


def is_number(value: object) -> bool:
    """Return True for a real number; True and False are none."""
    return isinstance(value, Real) and not isinstance(value, bool)


def is_whole(value: object) -> bool:
    """Return True for a whole number; True and False are none."""
    return isinstance(value, Integral) and not isinstance(value, bool)


class Argument(NamedTuple):
    """An argument that a message names; with the value `...` the message names it alone."""

    name: str
    value: Any = ...

    def __str__(self) -> str:
        value = f"({', '.join(map(str, self.value))})" if isinstance(self.value, tuple) else self.value
        return self.name if value is ... else f"{self.name}={value}"

    @property
    def typed(self) -> Any:
        """Value as a command line takes it: (rows, columns) as columns x rows, other tuples with commas."""
        if not isinstance(self.value, tuple):
            return self.value
        words = [str(number) for number in self.value]
        return "x".join(reversed(words)) if len(words) == 2 else ",".join(words)


Part = str | Argument


class _Message(Exception):
    """Message of one line, of at most LONGEST characters: what was given, what is accepted, how to correct it.

    The first Argument gives `argument` and `value`; both are None without one. `accepted` is one thing, a range of
    whole numbers, or names.
    """

    def __init__(
        self, *parts: Part, accepted: str | Iterable[Any] | None = None, remedy: str | Iterable[Part] = ()
    ) -> None:
        named = next((part for part in parts if isinstance(part, Argument)), Argument(""))
        self.argument: str | None = named.name or None
        self.value: Any = None if named.value is ... else named.value
        self.accepted = accepted if isinstance(accepted, str | range | None) else tuple(accepted)
        mend: tuple[Part, ...] = (remedy,) * bool(remedy) if isinstance(remedy, str) else tuple(remedy)
        self.remedy = "".join(map(str, mend))
        if isinstance(self.accepted, range):
            parts += (f": accepted are {self.accepted[0]} to {self.accepted[-1]}",)
        elif self.accepted is not None:
            words = (self.accepted,) if isinstance(self.accepted, str) else self.accepted
            parts += (f": accepted {'are' if len(words) > 1 else 'is'} {', '.join(words) or 'none'}",)
        self.parts = (*parts, ": ", *mend) if mend else parts
        super().__init__(self.text())

    def text(self, naming: Callable[[Argument], str] = str) -> str:
        """Return the message with each argument as `naming` writes it; by default as Python does."""
        whole = "".join(naming(part) if isinstance(part, Argument) else part for part in self.parts)
        line = "".join(character if character.isprintable() else "?" for character in whole)
        return line if len(line) <= LONGEST else f"{line[: LONGEST // 2]} .. {line[-LONGEST // 4 :]}"


class InputError(_Message, ValueError):
    """Input cannot be used."""


class InputWarning(_Message, UserWarning):
    """Input is used but may be wrong; the message says how to make it certain."""


def counted(number: int, noun: str) -> str:
    """Return a number of things in words: 1 pixel, 2,000 presses."""
    plural = f"{noun}es" if noun.endswith("s") else f"{noun}s"
    return f"{number:,} {noun if number == 1 else plural}"


def install(extra: str) -> str:
    """Return how to install the libraries of an extra, with a package index and in a clone."""
    return f'run pip install "tactile-depth[{extra}]", in a clone ".[{extra}]"'


def warn(warning: InputWarning) -> None:
    """Warn at the line outside of this package that called it."""
    inside = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "")
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(inside):
        frame, level = frame.f_back, level + 1
    warnings.warn(warning, stacklevel=level)


def require_flag(argument: Argument) -> None:
    """Raise InputError unless the value is True or False: a word such as "no" would count as True."""
    from numpy import bool_  # not for a command that has yet to guard itself against signals

    if not isinstance(argument.value, bool | bool_):
        raise InputError(argument, accepted=("True", "False"))


def one_of(argument: Argument, accepted: Iterable[str]) -> None:
    """Raise InputError, which lists the names, unless the value is one of them."""
    if argument.value not in accepted:
        raise InputError(argument, " is unknown", accepted=filter(None, accepted))


def within(argument: Argument, low: int, high: int) -> None:
    """Raise InputError unless the value is from `low` to `high`."""
    if not low <= argument.value <= high:
        raise InputError(argument, " is out of range", accepted=range(low, high + 1))


def power_of_two(argument: Argument) -> None:
    """Raise InputError, which names the nearest ones, unless the value is a power of two."""
    if argument.value & (argument.value - 1):
        lower = 1 << (argument.value.bit_length() - 1)
        remedy = ("try ", Argument(argument.name, lower), " or ", Argument(argument.name, 2 * lower))
        raise InputError(argument, " is not a power of two", remedy=remedy)


def former_names(**names: str) -> Callable[[type], type]:
    """Return a decorator that makes a class refuse arguments of these former names, and name the present ones."""

    def decorate(cls: Any) -> Any:
        made = cls.__init__

        @functools.wraps(made)
        def init(self: Any, *arguments: Any, **named: Any) -> None:
            for old in named.keys() & names.keys():
                raise InputError(Argument(old, named[old]), ": it has another name now", remedy=f"give {names[old]}")
            made(self, *arguments, **named)

        cls.__init__ = init
        return cls

    return decorate
