# SPDX-License-Identifier: Apache-2.0
"""Structures, mutants and refused parameters of a core: data in the core's testbench, for tests and commands.

The testbench of a core, `tb/<unit>/tb_<core>.py`, states STRUCTURES, a sequence of `Structure`; where needed PROTOCOL
(commands/verify/protocol.py); MUTANTS, a `Mutants`; and of a door (hdl/README.md) REFUSED, a mapping from each rule
to changes of parameters that break it, with commas between.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Simulators = tuple[str, ...]
VERILATOR: Simulators = ("verilator",)
ICARUS: Simulators = ("icarus",)
BOTH = VERILATOR + ICARUS


@dataclass(frozen=True)
class Structure:
    """Build of a core, and where its testbench runs.

    Attributes
    ----------
    parameters : mapping
        Of the core.
    on : tuple of str
        Simulators in `make test CORE=`; `make regress` plays every structure on both. The whole suite plays the first
        that has no `device`, and all that have one, and a core inside another on Icarus only.
        Icarus builds in 0.1 s what takes Verilator 5 s.
    mutants : tuple of str
        Simulators on which `make mutate` plays this structure, each the survivors of the one before; `make netlists`
        takes it too. Those of a core are small builds that together contain every relevant generate branch.
        Icarus needs no build, and sees X; Verilator is fast where a test is long.
    device : mapping
        Facts that the testbench must know; see RunSettings. `level`: the last level that is played (tb/selection.py).
    roms : callable
        Writes the files that $readmemh reads into the folder given.
    name : str
        Name in tests and folders; by default the values of the parameters or of the configuration.
    """

    parameters: Mapping[str, Any] = field(default_factory=dict)
    on: Simulators = ()
    mutants: Simulators = ()
    device: Mapping[str, Any] = field(default_factory=dict)
    roms: Callable[[Path], object] | None = None
    name: str = ""

    @property
    def level(self) -> str:
        return str(self.device.get("level", ""))

    @property
    def label(self) -> str:
        choices = next(iter(self.device.values()), None)
        if isinstance(choices, Mapping):
            words = [f"{name}={value}" for name, value in choices.items()]
        else:
            words = [str(value) for value in self.parameters.values()]
        return self.name or re.sub(r"[^\w=.-]+", "_", "-".join(words)) or "default"


def of_parameters(names: str) -> Callable[..., Structure]:
    """Return a function from values of the parameters with these names, and fields of `Structure`, to a structure."""

    def built(*values: Any, **fields: Any) -> Structure:
        return Structure(dict(zip(names.split(), values, strict=True)), **fields)

    return built


@dataclass(frozen=True)
class Mutants:
    """Settings for mutating a core.

    Attributes
    ----------
    outside : sequence of str
        Registers of the core that its testbench writes.
    repeats : int
        Repetitions of rare cases; fewer if each repetition reaches every case.
    flat : bool
        False: mutants of its own cells and of the pins of the cores inside, which have their own runs.
    """

    outside: Sequence[str] = ()
    repeats: int = 60
    flat: bool = True
