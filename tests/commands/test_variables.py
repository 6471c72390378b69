# SPDX-License-Identifier: Apache-2.0
"""Variables of a command, and the exit status and the one line that an exception gives."""

import errno
import math
import re
import warnings
from dataclasses import dataclass
from typing import Annotated, Any

import pytest

from commands.common import variables
from tactile_depth.base.errors import Argument, InputError, InputWarning


def test_given() -> None:
    assert variables.given(["N=64", "AT=a=b"], ("N", "OUT", "AT")) == {"N": "64", "AT": "a=b"}
    for word in ("M=64", "N"):
        with pytest.raises(InputError, match=f"^{word}: unknown variable: accepted is N$"):
            variables.given([word], ("N",))


def test_an_empty_value_is_refused() -> None:
    with pytest.raises(InputError, match=r"^N= has no value: omit N for the default$"):
        variables.given(["N="], ("N",))


@pytest.mark.parametrize("word", [" 2", "2 ", "٢", "1_0", "2\n"])
@pytest.mark.parametrize("kind", [int, float])
def test_a_number_is_written_in_plain_digits(word: str, kind: type) -> None:
    with pytest.raises(InputError, match=r"from 1 to 20, in digits 0 to 9 without spaces and _$"):
        variables.number({"N": word}, "N", 7, 1, 20, kind)
    assert variables.numbers(Argument("N", f"1,{word}")) == ()


@pytest.mark.parametrize(("word", "value"), [("2", 2), ("+2.5", 2.5), (".5", 0.5), ("5.", 5), ("-1e-1", -0.1)])
def test_a_number_with_a_fraction(word: str, value: float) -> None:
    assert variables.number({"N": word}, "N", 7, -9, 9, float) == value


def test_number() -> None:
    assert variables.number({}, "N", 7, 1, 9) == 7
    assert variables.number({"N": "2.5"}, "N", 7, 1, 9, float) == 2.5
    for word in ("2.5", "x", "0", "10"):
        with pytest.raises(InputError, match=f"^N={word}: accepted is a whole number from 1 to 9$"):
            variables.number({"N": word}, "N", 7, 1, 9)


@pytest.mark.parametrize("word", ["nan", "inf", "-inf", "1e999"])
def test_a_number_is_finite_even_where_the_range_is_not(word: Any) -> None:
    with pytest.raises(InputError, match=f"^N={word}: accepted is a number"):
        variables.number({"N": word}, "N", 7, -math.inf, math.inf, float)


def test_a_command_without_variables_refuses_all() -> None:
    with pytest.raises(InputError, match=r"^CORE=td_ram: unknown variable: accepted is none$"):
        variables.given(["CORE=td_ram"], ())


@dataclass(frozen=True)
class Size:
    rows: Annotated[int, variables.whole(1, 9)] = 3
    columns: Annotated[int, variables.whole(1, 9), "N"] = 4
    drawn: float = 0.5  # no variable


def form(
    size: Size,
    shape: Annotated[tuple[str, ...], variables.Several(("A", "B"), tuple)],
    seed: variables.Seed | None = None,
    wide: Annotated[float, variables.one({"no": 0.5, "yes": 2.5})] = 1,
) -> tuple[Any, ...]:
    return size, shape, seed, wide


def test_parameters_are_variables_of_their_names() -> None:
    assert variables.read(form, []) == (Size(), (), None, 1)
    assert variables.read(form, ["WIDE=yes", "N=5", "B=x", "SEED=7"]) == (Size(columns=5), ("B",), 7, 2.5)


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("COLUMNS=2", "COLUMNS=2: unknown variable: accepted are ROWS, N, A, B, SEED, WIDE"),
        ("DRAWN=2", "DRAWN=2: unknown variable: accepted are ROWS, N, A, B, SEED, WIDE"),
        ("ROWS=10", "ROWS=10: accepted is a whole number from 1 to 9"),
        ("WIDE=2.5", "WIDE=2.5 is unknown: accepted are no, yes"),
    ],
)
def test_a_parameter_takes_what_its_reader_accepts(word: str, line: str) -> None:
    with pytest.raises(InputError, match=f"^{re.escape(line)}$"):
        variables.read(form, [word])


FULL = "free disk space, or give a folder on another disk"


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (InputError("N=3: too small"), 2, "make sim: N=3: too small\n"),
        (variables.Mismatch("row 3 differs"), 1, "make sim: row 3 differs\n"),
        (RuntimeError("no simulator"), 3, "make sim: no simulator\n"),
        (
            OSError(errno.ENOSPC, "No space left on device", "a.npy"),
            3,
            f"make sim: a.npy: No space left on device: {FULL}\n",
        ),
        (OSError("4096 requested and 0 written"), 3, f"make sim: a file could not be written to its end: {FULL}\n"),
        (PermissionError(errno.EACCES, "Permission denied", "a.npy"), 3, "make sim: a.npy: Permission denied\n"),
        (MemoryError(), 3, "make sim: MemoryError\n"),
        (KeyboardInterrupt(), 130, "make sim: interrupted; nothing was written\n"),
    ],
)
def test_an_exception_gives_a_line_and_a_status(
    error: Any, status: Any, line: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended, variables.reported("sim", "nothing was written"):
        raise error
    assert ended.value.code == status
    assert capsys.readouterr().err == line


def test_errors_and_warnings_of_the_package_name_variables(capsys: pytest.CaptureFixture[str]) -> None:
    def command() -> None:
        warnings.warn(InputWarning(Argument("columns", 64), ": an old file at columns=64"), stacklevel=1)
        remedy = ("give ", Argument("camera_size", ("<rows>", "<columns>")), ", or another ", Argument("solver"))
        raise InputError(Argument("window", (8, 0, 4, 4)), " with ", Argument("data_width", 24), remedy=remedy)

    with pytest.raises(SystemExit), variables.reported("sim"):
        command()
    assert capsys.readouterr().err.splitlines() == [
        "make sim: warning: N=64: an old file at columns=64",
        "make sim: WINDOW=8,0,4,4 with DATA_WIDTH=24: give CAMERA_SIZE=<columns>x<rows>, or another SOLVER",
    ]


def test_an_unexpected_exception_shows_its_traceback_and_is_no_mismatch(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended, variables.reported("sim"):
        raise KeyError("fault")
    assert ended.value.code == variables.FAILURE
    assert "KeyError: 'fault'" in capsys.readouterr().err
