# SPDX-License-Identifier: Apache-2.0
"""Power-up: registers and memories are random in Verilator and unknown in Icarus, as the suite assumes."""

import json
from pathlib import Path
from typing import Any

from commands.common import repository
from commands.common import simulator as simulation

SEEDS = range(1, 9)


def test_what_is_not_reset(simulator: str, tmp_path: Path) -> None:
    files = [*repository.sources("td_ram"), repository.ROOT / "tb" / "power_up.sv"]
    simulation.build(simulator, "power_up", files, {}, tmp_path, log=tmp_path / "build.log")

    def state(power_up: Any) -> Any:
        count, failed = simulation.run(
            "power_up",
            "tb.tb_power_up",
            tmp_path,
            tmp_path,
            simulator=simulator,
            seed=1,
            power_up=power_up,
            log=tmp_path / "run.log",
        )
        assert (count, failed) == (1, 0)
        return tuple(json.loads((tmp_path / "seen.json").read_text()))

    if simulator == "icarus":
        assert all(set(value) == {"X"} for value in state(1))
        return
    values = [state(power_up) for power_up in SEEDS]
    assert state(SEEDS[0]) == values[0], "the seed does not determine the state"
    for place in range(17):  # within a memory Verilator gives all words the same value
        assert len({held[place] for held in values}) == len(SEEDS), "a register or a word came up the same"
