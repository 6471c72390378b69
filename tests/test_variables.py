# SPDX-License-Identifier: Apache-2.0
"""What is given to `make` reaches the command, and one that is not accepted is refused in one line."""

import os
import subprocess
from pathlib import Path

import pytest

from commands import variables
from models.errors import InputError

ROOT = Path(variables.__file__).parents[1]
WITHOUT = {"test", "lint", "coverage", "frontends", "registers", "setup", "clean"}  # targets without variables


def targets():
    line = next(line for line in (ROOT / "Makefile").read_text().splitlines() if line.startswith(".PHONY:"))
    return sorted(set(line.split()[1:]) - WITHOUT)


@pytest.mark.parametrize("target", targets())
def test_make_hands_on_all_that_it_is_given(target):
    words = ["FLOOR=flat", "ANY=a b", "OUT="]
    outside = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    result = subprocess.run(
        ["make", "--dry-run", target, *words, "PYTHON=python3"],
        cwd=ROOT,
        env=outside | {"N": "128"},
        capture_output=True,
        text=True,
        check=True,
    )
    last = result.stdout.splitlines()[-1]
    assert f"-m commands.{target} " in last
    assert sorted(last.split(f"commands.{target}")[1].split("'")[1::2]) == sorted(words)


def test_given():
    assert variables.given(["N=64", "OUT=", "AT=a=b"], ("N", "OUT", "AT")) == {"N": "64", "AT": "a=b"}
    for word in ("M=64", "N"):
        with pytest.raises(InputError, match=f"^{word}: unknown variable: accepted is N$"):
            variables.given([word], ("N",))


def test_number():
    assert variables.number({}, "N", 7, 1, 9) == 7
    assert variables.number({"N": "2.5"}, "N", 7, 1, 9, float) == 2.5
    for word in ("2.5", "x", "0", "10"):
        with pytest.raises(InputError, match=f"^N={word}: accepted is a whole number from 1 to 9$"):
            variables.number({"N": word}, "N", 7, 1, 9)


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (InputError("N=3: too small"), 2, "make sim: N=3: too small\n"),
        (RuntimeError("no simulator"), 1, "make sim: no simulator\n"),
        (KeyboardInterrupt(), 130, "make sim: nothing was written\n"),
    ],
)
def test_what_goes_wrong_is_said_in_a_line(error, status, line, capsys):
    with pytest.raises(SystemExit) as ended, variables.reported("sim", "nothing was written"):
        raise error
    assert ended.value.code == status
    assert capsys.readouterr().err == line


def test_an_interruption_with_nothing_to_say_goes_on():
    with pytest.raises(KeyboardInterrupt), variables.reported("sim"):
        raise KeyboardInterrupt
