# SPDX-License-Identifier: Apache-2.0
"""Errors are composed of arguments, what is accepted and a remedy; front ends name each argument of the package."""

import argparse
import ast
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from commands.common.run_request import ACCEPTED, CAMERA
from commands.common.variables import _parameters, variables_of_arguments
from commands.run import calibrate
from tactile_depth.base.errors import LONGEST, Argument, InputError, counted
from tactile_depth.cli.main import OPTIONS, _parser, named
from tests.drawn_light import no_contact

GRID = Argument("grid", (24, 32))
PYTHON = {  # arguments that neither a variable of make nor an option of the command gives
    *(
        "background",
        "ball_radius_px",
        "bits_per_channel",
        "black_level",
        "captured_at",
        "circle",
        "diameter_mm",
        "exposure_lines",
        "find_circles",
    ),
    *("flat_field", "frames", "gains", "gradient_limit", "name", "path", "pictures", "pipeline", "quiet", "register"),
    *("release_mm", "sensor", "stream", "zero", "zero_offset"),
}


@pytest.mark.parametrize(
    ("accepted", "text"),
    [
        (None, ""),
        ("a number", ": accepted is a number"),
        (range(1, 9), ": accepted are 1 to 8"),
        ((), ": accepted is none"),
        ({"lut": 1}, ": accepted is lut"),
        (("lut", "quadratic"), ": accepted are lut, quadratic"),
    ],
)
def test_a_message_has_arguments_what_is_accepted_and_a_remedy(accepted: Any, text: str) -> None:
    error = InputError(GRID, " is odd", accepted=accepted, remedy=("omit ", Argument("grid")))
    assert str(error) == f"grid=(24, 32) is odd{text}: omit grid"
    assert (error.argument, error.value, error.remedy) == ("grid", (24, 32), "omit grid")
    outer = pickle.loads(pickle.dumps(InputError("a.png: ", *error.parts)))
    assert outer.text(named) == f"a.png: --grid 32x24 is odd{text}: omit --grid"


@pytest.mark.parametrize(
    ("number", "noun", "text"),
    [(0, "pixel", "0 pixels"), (1, "pixel", "1 pixel"), (2000, "press", "2,000 presses"), (1, "press", "1 press")],
)
def test_a_number_of_things_is_singular_or_plural(number: int, noun: str, text: str) -> None:
    assert counted(number, noun) == text


def test_a_message_is_one_line_of_bounded_length() -> None:
    error = InputError("a\nb", "x" * 2 * LONGEST)
    assert (str(error)[:4], len(str(error)) < LONGEST, error.argument, error.value) == ("a?bx", True, None, None)


def test_a_warning_names_the_line_that_called_the_package() -> None:
    own = no_contact(td.load("gelsight-mini"))
    yellow, uneven = own // np.array((1, 1, 3), np.uint8), (own * np.linspace(0.94, 1, 320)[:, None]).astype(np.uint8)
    pipeline = td.Pipeline(td.load("gelsight-mini"), own)
    calls: tuple[Callable[[], Any], ...] = (
        lambda: td.Pipeline(td.load("gelsight-mini"), yellow),
        lambda: pipeline.capture_reference(yellow),
        lambda: pipeline(uneven),
        lambda: next(pipeline.stream([uneven])),
    )
    for call in calls:
        with pytest.warns(td.InputWarning, match="does not look like the sensor|light changes across it") as caught:
            call()
        (warning,) = caught
        assert (warning.filename, warning.lineno) == (__file__, call.__code__.co_firstlineno)


def test_the_command_names_its_options() -> None:
    names = {"columns": "--grid {}x..", "rows": "--grid ..x{}", "folder": "--out {}", "solver": "--solver {}"}
    names |= {"address": "device:{}", "zero_offset": "zero_offset={}"}
    for name, text in names.items():
        assert InputError(Argument(name, 33)).text(named) == text.format(33)


def test_front_ends_name_every_argument_of_an_error() -> None:
    used = set()
    for path in (ROOT / "models").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Argument" and path.name != "errors.py":
                used |= {name.value for name in node.args[:1] if isinstance(name, ast.Constant)}
    assert used == (used & {*variables_of_arguments(), *OPTIONS}) | PYTHON
    own = {name for each in _parameters(calibrate.main).values() for name in each.names}
    assert set(variables_of_arguments().values()) <= {*ACCEPTED, *CAMERA, *own}
    (commands,) = (action for action in _parser()._actions if isinstance(action, argparse._SubParsersAction))
    options = {word for command in commands.choices.values() for word in command._option_string_actions}
    assert {option.split()[0] for option in OPTIONS.values() if option.startswith("--")} <= options
