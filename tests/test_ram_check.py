# SPDX-License-Identifier: Apache-2.0
"""A run in which a memory is used against its rules fails, on each simulator."""

from pathlib import Path

import pytest

from commands.common import simulator as simulation
from commands.common.repository import sources

AGAINST = {
    "read_in_the_clock_that_writes": "word 4 is read in the clock that writes it",
    "written_beyond_the_depth": "word 6 of 6 is written",
}


def test_a_use_against_the_rules_fails(simulator: str, tmp_path: Path) -> None:
    log = tmp_path / "run.log"
    simulation.build(simulator, "td_ram", sources("td_ram"), {"Depth": 6}, tmp_path, log=tmp_path / "build.log")

    def play(name: str) -> tuple[int, int]:
        return simulation.run(
            "td_ram",
            "tb.tb_ram_check",
            tmp_path,
            tmp_path,
            simulator=simulator,
            seed=1,
            environment={"COCOTB_TEST_FILTER": f"{name}$"},
            log=log,
        )

    assert play("allowed") == (1, 0)
    for name, message in AGAINST.items():
        with pytest.raises(RuntimeError, match="return code"):
            play(name)
        assert message in log.read_text()
