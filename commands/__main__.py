# SPDX-License-Identifier: Apache-2.0
"""`python -m commands <command> NAME=value ..`: runs a command as make does, with its own exit status.

docs/exit-status.md lists the statuses; make itself returns only 0 and 2.
"""

import importlib
import io
import sys

from commands.common import signals, variables
from tactile_depth.base.errors import InputError

ROOMS = {
    "run": ("calibrate", "reflex", "sim"),
    "study": ("baselines", "budget", "certify", "extremes", "figures", "presses", "report", "sweep", "trade", "tune"),
    "verify": ("coverage", "formal", "lint", "mutate", "netlists", "quick", "regress", "sign-off", "test", "upsets"),
    "hardware": ("asic", "fpga", "registers", "synth", "wrap"),
}
INTERRUPTED = {  # says what a signal leaves
    **dict.fromkeys(("baselines", "budget", "reflex"), "nothing was written"),
    **dict.fromkeys(("sweep", "trade"), "every row measured is kept, run it again to go on"),
    "report": "the rows of the sweep are kept, run it again to go on",
}
COMMANDS = {command: room for room, commands in ROOMS.items() for command in commands}


def main() -> None:
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a path may hold bytes that are not UTF-8
    command = sys.argv[1] if len(sys.argv) > 1 else ""
    if command not in COMMANDS:
        unknown = InputError(f"{command or 'no command'}: unknown command: accepted are {', '.join(sorted(COMMANDS))}")
        print(f"python -m commands: {unknown}", file=sys.stderr)
        sys.exit(variables.BAD_INPUT)
    with signals.guarded(), variables.reported(command, INTERRUPTED.get(command, "")):  # imports take seconds
        sys.argv = sys.argv[1:]
        module = importlib.import_module(f"commands.{COMMANDS[command]}.{command.replace('-', '_')}")
        sys.exit(variables.read(module.main, sys.argv[1:]))


if __name__ == "__main__":
    main()
