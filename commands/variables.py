# SPDX-License-Identifier: Apache-2.0
"""Variables of a `make` target, which the Makefile hands on as words NAME=value."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from models.errors import InputError


def given(arguments: Sequence[str], accepted: Iterable[str]) -> dict[str, str]:
    """Name to value of those that have one.

    Raises
    ------
    InputError
        A name that is not accepted, or a word without one.
    """
    names = tuple(accepted)
    values: dict[str, str] = {}
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if not equals or name not in names:
            raise InputError(
                f"{argument}: unknown variable: accepted {'are' if len(names) > 1 else 'is'} {', '.join(names)}"
            )
        if value:
            values[name] = value
    return values


def number(values: Mapping[str, str], name: str, default: Any, low: float, high: float, kind: type = int) -> Any:
    """The number that was given as `name`, of a kind, int or float; `default` where it was not.

    Raises
    ------
    InputError
        No number, or not from `low` to `high`.
    """
    if not values.get(name):
        return default
    try:
        value = kind(values[name])
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        what = "a whole number" if kind is int else "a number"
        to = f" from {low:,g} to {high:,g}" if math.isfinite(high) else ""
        raise InputError(f"{name}={values[name]}: accepted is {what}{to}")
    return value


@contextmanager
def reported(target: str, interrupted: str = "") -> Iterator[None]:
    """Bad input ends `make <target>` with one line and exit status 2, what fails on the way with 1.

    `interrupted`: what to say then, where there is something to say; exit status 130.
    """
    try:
        yield
    except InputError as error:
        print(f"make {target}: {error}", file=sys.stderr)
        sys.exit(2)
    except (RuntimeError, subprocess.TimeoutExpired) as error:
        print(f"make {target}: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        if not interrupted:
            raise
        print(f"make {target}: {interrupted}", file=sys.stderr)
        sys.exit(130)
