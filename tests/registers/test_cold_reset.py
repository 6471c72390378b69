# SPDX-License-Identifier: Apache-2.0
"""Netlist without initial values, like gates at power-up: state after `cold_rst`."""

from pathlib import Path
from typing import Any

import pytest

from commands.common import simulator
from commands.verify import mutants
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb.structures import Structure

TRIDIAGONAL: dict[str, Any] = {
    "columns": 16,
    "rows": 8,
    "solver": "tridiagonal",
    "flat_field": True,
    "zero_offset": True,
}
# Between them both builds have every table.
BUILDS: dict[str, dict[str, Any]] = {"lut": {"bits_per_channel": 2}, "quadratic": {"gradient_model": "quadratic"}}


@pytest.mark.parametrize("model", ["lut", pytest.param("quadratic", marks=pytest.mark.regress)])
def test_a_start_from_unknown_registers(model: str, tmp_path: Path) -> None:
    simulator.check("icarus")
    config = Configuration(**TRIDIAGONAL, **BUILDS[model])
    write_roms(tmp_path, synthetic(config.bits_per_channel), config)
    built = Structure(hdl_parameters(config))
    read = mutants.read_commands("tactile_depth", built)
    unknown = "setattr -unset init w:*\nopt_clean\nwrite_verilog -noattr netlist.v\n"
    mutants.yosys(f"{read}\nprep -flatten -top tactile_depth\n{unknown}", tmp_path, "netlist")
    simulator.build("icarus", "tactile_depth", [tmp_path / "netlist.v"], {}, tmp_path, log=tmp_path / "build.log")
    tests, failed = simulator.run(
        "tactile_depth",
        "tb.registers.tb_cold_reset",
        tmp_path,
        tmp_path,
        simulator="icarus",
        seed=1,
        log=tmp_path / "run.log",
    )
    assert (tests, failed) == (1, 0), (tmp_path / "run.log").read_text()[-2000:]
