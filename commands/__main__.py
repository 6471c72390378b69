# SPDX-License-Identifier: Apache-2.0
"""`python -m commands <command> NAME=value ..`: runs a command as make does, with its own exit status.

docs/exit-status.md lists the statuses; make itself returns only 0 and 2.
"""

import contextlib
import importlib
import io
import re
import sys
from pathlib import Path

from commands.common import signals, variables
from tactile_depth.base import files
from tactile_depth.base.errors import InputError

COMMANDS = {
    begins[1]: path.parent.name
    for path in sorted(Path(__file__).parent.glob("*/*.py"))
    if (begins := re.match(r'# SPDX.*\n"""`make ([a-z-]+)', path.read_text()))
}
"""Commands and their folders: modules whose docstring begins with `make <command>`."""


def _mark_build() -> None:
    """Mark build/ as a cache, in which commands replace what an earlier version has left."""
    tag = Path(__file__).parents[1] / "build" / files.CACHE_TAG
    if not tag.exists():
        with contextlib.suppress(OSError):  # a clone may be read-only
            tag.parent.mkdir(exist_ok=True)
            tag.write_text(f"{files.CACHE_SIGNATURE}\n")


def main() -> None:
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a path may hold bytes that are not UTF-8
    command = sys.argv[1] if len(sys.argv) > 1 else ""
    if command not in COMMANDS:
        unknown = InputError(f"{command or 'no command'}: unknown command: accepted are {', '.join(sorted(COMMANDS))}")
        print(f"python -m commands: {unknown}", file=sys.stderr)
        sys.exit(variables.BAD_INPUT)
    _mark_build()
    with signals.guarded(), variables.reported(command):  # imports take seconds
        sys.argv = sys.argv[1:]
        module = importlib.import_module(f"commands.{COMMANDS[command]}.{command.replace('-', '_')}")
        with variables.reported(command, getattr(module, "INTERRUPTED", "")):
            sys.exit(variables.read(module.main, sys.argv[1:]))


if __name__ == "__main__":
    main()
