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
from dataclasses import dataclass, is_dataclass
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

from tactile_depth.base import interruption
from tactile_depth.base.errors import Argument, InputError, InputWarning, one_of
from tactile_depth.base.files import cause

EQUAL, MISMATCH, BAD_INPUT, FAILURE = 0, 1, 2, 3  # exit status; 128 + the number of a signal

# Arguments of the package that are called as the variables of make.
SAME = ("reference", "calibration", "bits", "camera_size", "exposure_us", "window", "presses", "crop", "rotate")
OTHERS = {"folder": "OUT", "models": "GRADIENT", "phase": "BAYER", "pitch_mm": "PITCH", "pixel_format": "CAMERA"}

PLAIN = {int: r"[+-]?[0-9]+", float: r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"}
PRINTABLE = re.compile("[!-^`-~]*")  # ASCII without space and _
RENAMED = {"FLOOR": "ZERO"}  # old name: new name
Made = TypeVar("Made")
Reader = Callable[[Argument], Any]  # of a variable that was given; raises InputError


class Mismatch(Exception):
    """A result that differs from what it is checked against."""


@dataclass(frozen=True)
class Several:
    """Variables that make one value together, by default whether they are given or not."""

    names: tuple[str, ...]
    value: Callable[[dict[str, str]], Any]
    always: bool = True


def read(form: Callable[..., Made], arguments: Sequence[str]) -> Made:
    """Return what a function or a dataclass makes of variables, which its parameters name.

    A parameter of type Annotated[.., reader] is the variable of its name in capitals, or of the name that follows the
    reader; without that variable it keeps its default. A parameter may be a dataclass of such parameters.

    Raises InputError.
    """
    found = _parameters(form)
    return _filled(form, found, given(arguments, [name for each in found.values() for name in each.names]))


def _parameters(form: Callable[..., Any]) -> dict[str, Several]:
    """Return the parameters of a function or of a dataclass that variables give."""
    found = {}
    for parameter, hint in get_type_hints(form, include_extras=True).items():
        hint = next((each for each in get_args(hint) if get_origin(each) is Annotated), hint)  # of `Seed | None`
        if get_origin(hint) is Annotated:
            reader, *names = hint.__metadata__
            name = (*names, parameter.upper())[0]
            one_alone = Several((name,), partial(_value, reader, name), always=False)
            found[parameter] = reader if isinstance(reader, Several) else one_alone
        elif isinstance(hint, type) and is_dataclass(hint) and parameter != "return" and (inside := _parameters(hint)):
            names = tuple(name for each in inside.values() for name in each.names)
            found[parameter] = Several(names, partial(_filled, hint, inside))
    return found


def _value(reader: Reader, name: str, values: Mapping[str, str]) -> Any:
    return reader(Argument(name, values[name]))


def _filled(form: Callable[..., Made], found: Mapping[str, Several], values: Mapping[str, str]) -> Made:
    filled = {}
    for parameter, each in found.items():
        own = {name: values[name] for name in each.names if name in values}
        if own or each.always:
            filled[parameter] = each.value(own)
    return form(**filled)


def given(arguments: Sequence[str], accepted: Iterable[str]) -> dict[str, str]:
    """Return name to value of the variables.

    Raises InputError: a name is not accepted, or an argument is not NAME=value, or its value is empty."""
    names = tuple(dict.fromkeys(accepted))
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


def _checked(argument: Argument, kind: type, low: float, high: float) -> Any:
    """Return the number of a kind, int or float, in an argument.

    Raises InputError: it is no number, or is not from `low` to `high`.
    """
    try:
        value = plain(argument.value, kind)
    except ValueError:
        value = math.nan
    if not low <= value <= high or value in (math.inf, -math.inf):
        what = "a whole number" if kind is int else "a number"
        to = f" from {low:,g} to {high:,g}" if math.isfinite(high) else ""
        how = "" if PRINTABLE.fullmatch(argument.value) else ", in digits 0 to 9 without spaces and _"
        raise InputError(argument, accepted=f"{what}{to}{how}")
    return value


def whole(low: float, high: float) -> Reader:
    """Return the reader of a whole number."""
    return partial(_checked, kind=int, low=low, high=high)


def real(low: float, high: float) -> Reader:
    """Return the reader of a number."""
    return partial(_checked, kind=float, low=low, high=high)


def flag(argument: Argument) -> bool:
    return bool(_checked(argument, int, 0, 1))


def place(argument: Argument) -> Path:
    return Path(argument.value)


def numbers(argument: Argument) -> tuple[int, ...]:
    """Return the whole numbers in an argument, with commas between; none where one is no whole number."""
    try:
        return tuple(plain(part, int) for part in argument.value.split(","))
    except ValueError:
        return ()


def one(accepted: Sequence[str] | Mapping[str, Any]) -> Reader:
    """Return the reader of a word that is accepted; of a mapping it gives what has that name."""

    def read_word(argument: Argument) -> Any:
        one_of(argument, accepted)
        return accepted[argument.value] if isinstance(accepted, Mapping) else argument.value

    return read_word


def number(
    values: Mapping[str, str],
    name: str,
    default: Any,
    low: float = -math.inf,
    high: float = math.inf,
    kind: type = int,
) -> Any:
    """Return the number in the variable `name`, of kind int or float; `default` without it. Raises InputError."""
    return _checked(Argument(name, values[name]), kind, low, high) if values.get(name) else default


def choice(values: Mapping[str, str], name: str, accepted: Sequence[str]) -> str:
    """Return the word in the variable `name`; the first that is accepted without that variable. Raises InputError."""
    value = values.get(name) or accepted[0]
    one_of(Argument(name, value), accepted)
    return value


ClockMhz = Annotated[float, real(0.001, 10_000)]
Count = Annotated[int, whole(1, 100_000)]
Flag = Annotated[bool, flag]
Jobs = Annotated[int, whole(1, 1000)]
Name = Annotated[str, lambda argument: argument.value]
Place = Annotated[Path, place]
Seed = Annotated[int, whole(0, 10**9)]


def usable(text: str) -> bool:
    """Return whether a path or a name can hold this text: no NUL, no half of a character."""
    try:
        return b"\0" not in os.fsencode(text)
    except UnicodeEncodeError:
        return False


@cache
def variables_of_arguments() -> dict[str, str]:
    """Return the variables that a user of make gave, by the names of arguments of the package."""
    from tactile_depth.chip.configuration import CHOICES  # imports numpy, which a signal may interrupt from `main` on

    chosen = {choice.argument: choice.variable for choice in CHOICES.values()}
    return chosen | {name: name.upper() for name in SAME} | OTHERS


def named(argument: Argument) -> str:
    """Return an argument of the package as the variable that a user of make typed."""
    name = variables_of_arguments().get(argument.name)
    return str(argument if name is None else Argument(name, argument.typed))


def show_warning(command: str) -> Callable[..., None]:
    """Return what shows a warning about input of a command as one line; other warnings show as Python shows them."""
    python = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
        if isinstance(message, InputWarning):
            print(f"{command}: warning: {message.text(named)}", file=sys.stderr)
        else:
            python(message, category, *place, **more)

    return show


@contextmanager
def warned() -> Iterator[list[str]]:
    """Give a list of the warnings about input that are shown meanwhile, each as its line."""
    lines: list[str] = []
    with warnings.catch_warnings():
        shown = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
            if isinstance(message, InputWarning):
                lines.append(message.text(named))
            shown(message, category, *place, **more)

        warnings.showwarning = show
        yield lines


@contextmanager
def reported(target: str, interrupted: str = "") -> Iterator[None]:
    """End `make <target>` with one line on stderr and an exit status when an exception or a signal ends it.

    Bad input gives 2, a mismatch 1, a failure on the way 3, a signal 128 + its number. An exception that nobody
    expected shows its traceback, since it is a fault of the command, and gives 3. `interrupted` says what a signal
    leaves.
    """
    from commands.common import signals  # needs psutil, which the generator of FuseSoC does without

    try:
        with interruption.stoppable(signals.end_children), warnings.catch_warnings():
            warnings.showwarning = show_warning(f"make {target}")
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
