# SPDX-License-Identifier: Apache-2.0
"""`make lint`: Verilator -Wall on every module and on the whole in several structures, ruff, mypy."""

from __future__ import annotations

import subprocess
import sys
from itertools import product

from commands import simulator as simulation
from models.configuration import COLUMNS, Configuration
from models.errors import InputError
from models.tactile_depth import top_parameters

GRIDS = (16, 128, 512)
TOP = "tactile_depth"


def verilator(module: str, parameters: dict[str, int]) -> list[str]:
    sources = [str(path.relative_to(simulation.ROOT)) for path in simulation.sources()]
    return [
        *("verilator", "--lint-only", "-Wall", "--quiet", "--top-module", module),
        *(f"-G{name}={value}" for name, value in parameters.items()),
        "hdl/verilator.vlt",
        *sources,
    ]


def commands() -> list[tuple[str, list[str]]]:
    """Name and command of each check."""
    modules = [path.stem for path in simulation.sources() if not path.stem.endswith("_pkg")]
    checks = [(f"verilator {module}", verilator(module, {})) for module in modules]
    for size, solver, neumann in product(GRIDS, COLUMNS, (False, True)):
        config = Configuration(columns=size, solver=solver, neumann=neumann)
        name = f"verilator {TOP} {size} {solver}{' neumann' if neumann else ''}"
        checks.append((name, verilator(TOP, top_parameters(config))))
    python = sys.executable
    checks.append(("ruff check", [python, "-m", "ruff", "check", "."]))
    checks.append(("ruff format", [python, "-m", "ruff", "format", "--check", "."]))
    checks.append(("mypy models", [python, "-m", "mypy", "models"]))
    return checks


def main() -> None:
    try:
        simulation.check("verilator")
    except InputError as error:
        sys.exit(f"make lint: {error}")
    failed = []
    checks = commands()
    for name, command in checks:
        result = subprocess.run(command, cwd=simulation.ROOT, capture_output=True, text=True, check=False)
        if result.returncode:
            failed.append(name)
            print(f"{name}:\n{result.stdout}{result.stderr}")
    print(
        f"lint: {len(checks) - len(failed)} checks clean"
        + (f", {len(failed)} not: {', '.join(failed)}" if failed else "")
    )
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
