# SPDX-License-Identifier: Apache-2.0
"""The page from the cable to the picture: its programs run in order, and print what it says."""

import argparse
import re
from collections.abc import Callable
from typing import Any

import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormatName
from tactile_depth.chip.link.rates import rate
from tactile_depth.cli import calibrate, live
from tests.device.cable import setup_of
from tests.device.model_device import Setup

PAGE = (ROOT / "docs" / "cable.md").read_text()
GRID = (48, 64)


def test_the_programs_print_what_the_page_says(
    simulate: Callable[[Setup], None], capsys: pytest.CaptureFixture[str]
) -> None:
    sample = td.sample("ball")
    simulate(setup_of(td.Pipeline(sample.sensor, sample.reference, grid=GRID)))
    names: dict[str, Any] = {}
    printed = []
    for program in re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL):
        exec(program, names)
        printed.append(capsys.readouterr().out)
    status, depth, averaged, captured, several = printed
    (begin,) = re.findall(r"`(DeviceStatus\(.*?)\.\.\)`", PAGE)
    assert status.startswith(begin)
    shown = re.findall(r"^    (\d (?:True|False) .* mm)$", PAGE, re.MULTILINE)
    assert depth.splitlines() == shown
    assert f"    {averaged}" in PAGE
    assert captured == "untouched: 0.000 mm\n"
    assert several == "48 48\n"


@pytest.mark.parametrize("name", FORMATS)
def test_the_page_has_the_rates_of_the_formats(name: DepthFormatName) -> None:
    assert re.search(rf'^\| `"{name}"`.*\| {rate(128, 128, FORMATS[name]).frames_a_second:.1f} \|$', PAGE, re.MULTILINE)


def test_every_option_of_a_command_exists() -> None:
    helps = {name: _help(name) for name in ("live", "calibrate")}
    for name, rest in re.findall(r"tactile-depth (live|calibrate)((?:[^\n]*\\\n)*[^\n]*)", PAGE):
        for option in re.findall(r"--[a-z-]+", rest):
            assert option in helps[name], f"{name} {option}"


def _help(name: str) -> str:
    """Return the help of a subcommand."""
    parser = argparse.ArgumentParser()
    {"live": live, "calibrate": calibrate}[name].add_arguments(parser)
    return parser.format_help()
