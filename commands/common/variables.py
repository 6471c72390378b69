# SPDX-License-Identifier: Apache-2.0
"""Variables of a command, words NAME=value, and the exit status that it ends with: docs/exit-status.md."""

import math
import os
import re
import subprocess
import sys
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from commands.common import signals
from tactile_depth.base import interruption
from tactile_depth.base.errors import Argument, InputError, InputWarning, one_of
from tactile_depth.base.files import cause

EQUAL, MISMATCH, BAD_INPUT, FAILURE = 0, 1, 2, 3  # exit status; 128 + the number of a signal

# Arguments of the package, and the variables that a user of make gave.
SAME = (
    *("rows", "solver", "data_width", "gain_width", "lanes", "reference", "calibration", "bits", "camera_size"),
    *("exposure_us", "window", "boundary", "presses", "light_gains"),
)
VARIABLES = {name: name.upper() for name in SAME} | {
    "columns": "N",
    "coefficient_width": "COEFF_WIDTH",
    "depth_range_mm": "DEPTH_RANGE",
    "folder": "OUT",
    "gradient_model": "GRADIENT",
    "models": "GRADIENT",
    "phase": "BAYER",
    "pitch_mm": "PITCH",
    "pixel_format": "CAMERA",
}

PLAIN = {int: r"[+-]?[0-9]+", float: r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"}
PRINTABLE = re.compile("[!-^`-~]*")  # ASCII without space and _
RENAMED = {"FLOOR": "ZERO"}  # old name: new name


class Mismatch(Exception):
    """A result that differs from what it is checked against."""


def given(arguments: Sequence[str], accepted: Iterable[str]) -> dict[str, str]:
    """Return name to value of the variables.

    Raises InputError: a name is not accepted, or an argument is not NAME=value, or its value is empty."""
    names = tuple(accepted)
    values: dict[str, str] = {}
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if RENAMED.get(name) in names:
            raise InputError(f"{name} is called {RENAMED[name]} now: give {RENAMED[name]}={value}")
        if not equals or name not in names:
            raise InputError(f"{argument}: unknown variable", accepted=names)
        if not value:
            raise InputError(f"{name}= has no value: omit {name} for the default")
        values[name] = value
    return values


def plain(text: str, kind: type) -> Any:
    """Return the number of kind int or float in a text; ValueError if it is not written in digits 0 to 9 alone."""
    if not re.fullmatch(PLAIN[kind], text):
        raise ValueError
    return kind(text)


def number(values: Mapping[str, str], name: str, default: Any, low: float, high: float, kind: type = int) -> Any:
    """Return the number in the variable `name`, of kind int or float; `default` without that variable.

    Raises InputError: it is no number, or is not from `low` to `high`.
    """
    if not values.get(name):
        return default
    try:
        value = plain(values[name], kind)
    except ValueError:
        value = math.nan
    if not low <= value <= high or value in (math.inf, -math.inf):
        what = "a whole number" if kind is int else "a number"
        to = f" from {low:,g} to {high:,g}" if math.isfinite(high) else ""
        how = "" if PRINTABLE.fullmatch(values[name]) else ", in digits 0 to 9 without spaces and _"
        raise InputError(Argument(name, values[name]), accepted=f"{what}{to}{how}")
    return value


def whole_numbers(values: Mapping[str, str], name: str, default: Sequence[int]) -> tuple[int, ...]:
    """Return the numbers in the variable `name`, with commas between; none where one is no whole number."""
    try:
        return tuple(plain(part, int) for part in values[name].split(",")) if values.get(name) else tuple(default)
    except ValueError:
        return ()


def choice(values: Mapping[str, str], name: str, accepted: Sequence[str]) -> str:
    """Return the word in the variable `name`; the first that is accepted without that variable. Raises InputError."""
    value = values.get(name) or accepted[0]
    one_of(Argument(name, value), accepted)
    return value


def usable(text: str) -> bool:
    """Return whether a path or a name can hold this text: no NUL, no half of a character."""
    try:
        return b"\0" not in os.fsencode(text)
    except UnicodeEncodeError:
        return False


def named(argument: Argument) -> str:
    """Return an argument of the package as the variable that a user of make typed."""
    name = VARIABLES.get(argument.name)
    return str(argument if name is None else Argument(name, argument.typed))


def show_warning(target: str) -> Callable[..., None]:
    """Return what shows a warning about input as one line; other warnings show as Python shows them."""
    python = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
        if isinstance(message, InputWarning):
            print(f"make {target}: warning: {message.text(named)}", file=sys.stderr)
        else:
            python(message, category, *place, **more)

    return show


@contextmanager
def reported(target: str, interrupted: str = "") -> Iterator[None]:
    """End `make <target>` with one line on stderr and an exit status when an exception or a signal ends it.

    Bad input gives 2, a mismatch 1, a failure on the way 3, a signal 128 + its number. An exception that nobody
    expected shows its traceback, since it is a fault of the command, and gives 3. `interrupted` says what a signal
    leaves.
    """
    try:
        with interruption.stoppable(signals.end_children), warnings.catch_warnings():
            warnings.showwarning = show_warning(target)
            yield
    except InputError as error:
        message, status = error.text(named), BAD_INPUT
    except Mismatch as error:
        message, status = str(error), MISMATCH
    except KeyboardInterrupt as stop:
        number = interruption.number_of(stop)
        message, status = "; ".join(filter(None, (interruption.SIGNALS[number], interrupted))), 128 + number
    except BrokenPipeError:
        message, status = "whatever reads the output has ended", FAILURE
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python writes the rest at its end
    except OSError as error:
        message, status = cause(error), FAILURE
    except (RuntimeError, subprocess.SubprocessError, MemoryError) as error:
        message, status = str(error) or type(error).__name__, FAILURE
    except Exception:
        traceback.print_exc()
        message, status = "an unexpected error, shown above: please report it", FAILURE
    else:
        return
    print(f"make {target}: {InputError(message)}", file=sys.stderr)
    sys.exit(status)
