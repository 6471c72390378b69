# SPDX-License-Identifier: Apache-2.0
"""The command `tactile-depth`: its subcommands, its exit status, and one line for each error and warning.

Exit status: 0 success, 2 input that cannot be used, 3 a failure on the way, 128 + the number of a signal.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from typing import NoReturn

from tactile_depth.base import interruption
from tactile_depth.base.errors import REPOSITORY, Argument, InputError, InputWarning
from tactile_depth.base.files import cause
from tactile_depth.chip.choices import Choice
from tactile_depth.chip.configuration import CHOICES
from tactile_depth.cli import calibrate, depth, live
from tactile_depth.cli.failure import Failure
from tactile_depth.device.errors import DeviceError

PROGRAM = "tactile-depth"
BAD_INPUT, FAILED = 2, 3
DESCRIPTION = "Depth in millimetres from visuotactile fingertips, bit for bit as the hardware computes it."
PAGES = f"Pages and issues: {REPOSITORY}"

# Arguments of the package, and the options that a user of the command gave; {} is the value.
SAME = (
    *("arithmetic", "background", "bits", "calibration", "camera_size", "diameter_mm", "exposure_us", "grid"),
    *("pitch_mm", "reference", "threshold_mm", "area_threshold_mm", "depth_format", "crop", "rotate"),
)
OPTIONS = (
    {choice.argument: choice.option for choice in CHOICES.values()}
    | {name: Choice().of(name).option for name in SAME}
    | {"address": "device:{}", "folder": "--out {}", "phase": "--bayer {}", "pixel_format": "--camera {}"}
)


def named(argument: Argument) -> str:
    """Return an argument of the package as the option that a user of the command typed."""
    if (option := OPTIONS.get(argument.name)) is None:
        return str(argument)
    return option.split()[0] if argument.value is ... else option.format(argument.typed)


class _Version(argparse.Action):
    """Print the version, which is looked up for this option alone."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object, **__: object) -> None:
        print(PROGRAM, version("tactile-depth"))
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, as all others of this command are."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}: see `{self.prog} --help`")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog=PROGRAM, description=DESCRIPTION, epilog=PAGES, allow_abbrev=False)
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in (depth, live, calibrate):
        command.add_arguments(
            commands.add_parser(command.NAME, help=command.HELP, description=command.HELP, allow_abbrev=False)
        )
    return parser


@contextmanager
def _warnings_in_lines() -> Iterator[list[str]]:
    """Print each InputWarning as one line; the list that it gives holds them."""
    lines: list[str] = []
    with warnings.catch_warnings():
        show = warnings.showwarning

        def line(message: Warning | str, category: type[Warning], *place: object, **more: object) -> None:
            if not isinstance(message, InputWarning):
                show(message, category, *place, **more)  # type: ignore[arg-type]
                return
            lines.append(message.text(named))
            print(f"{PROGRAM}: warning: {lines[-1]}", file=sys.stderr)

        warnings.showwarning = line
        warnings.simplefilter("always", InputWarning)
        yield lines


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a name that the terminal's encoding lacks ends nothing
    try:
        parsed = _parser().parse_args(arguments)
        with interruption.stoppable(), _warnings_in_lines() as lines:
            parsed.run(parsed, lines)
    except InputError as error:
        print(f"{PROGRAM}: {error.text(named)}", file=sys.stderr)
        return BAD_INPUT
    except DeviceError as error:
        print(f"{PROGRAM}: {error.text(named)}", file=sys.stderr)
        return FAILED
    except Failure as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return FAILED
    except BrokenPipeError:
        print(f"{PROGRAM}: whatever reads the output has ended", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python writes the rest at its end
        return FAILED
    except OSError as error:
        print(f"{PROGRAM}: {cause(error)}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt as stop:
        number = interruption.number_of(stop)
        print(f"{PROGRAM}: {interruption.SIGNALS[number]}", file=sys.stderr)
        return 128 + number
    except Exception:
        traceback.print_exc()
        report = f"please report the lines above: {REPOSITORY}/issues"
        print(f"{PROGRAM}: an error of this program, not of the input: {report}", file=sys.stderr)
        return FAILED
    return 0
