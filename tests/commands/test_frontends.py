# SPDX-License-Identifier: Apache-2.0
"""make frontends: a text that Yosys' two front ends read differently is found."""

from pathlib import Path

import pytest

from commands.common import repository
from commands.hardware import yosys
from commands.verify import frontends

CORE = """\
module negate #(
  parameter int Width = 8
) (
  input  logic                    clk,
  input  logic signed [Width-1:0] x,
  output logic signed [Width:0]   y
);
  always_ff @(posedge clk) y <= {};
endmodule
"""


def difference(folder: Path, text: str) -> str:
    source = folder / "negate.sv"
    source.write_text(text)
    return yosys.run(frontends.prepare("negate", [source], {"Width": 3}, folder), timeout_s=100)


def test_one_meaning_is_proven(tmp_path: Path) -> None:
    assert not difference(tmp_path, CORE.format("-$signed({x[Width-1], x})"))


@pytest.mark.parametrize("width", ["4", "Width"])
def test_a_cast_that_yosys_misreads_is_found(tmp_path: Path, width: int) -> None:
    assert difference(tmp_path, CORE.format(f"-{width}'(x)"))


def test_a_value_that_only_one_leaves_unknown_is_found(tmp_path: Path) -> None:
    source = tmp_path / "negate.sv"
    source.write_text(CORE.format("x"))
    script = frontends.prepare("negate", [source], {}, tmp_path)
    (tmp_path / "negate_own.sv").write_text(CORE.format("{1'bx, x}"))
    (tmp_path / "negate_slang.sv").write_text(CORE.format("{1'b0, x}"))
    assert "unproven" in yosys.run(script, timeout_s=100)


def test_every_core_has_a_case() -> None:
    cores = set(repository.cores())
    assert cores - frontends.WITHIN_THE_WHOLE == {case.core for case in frontends.cases()}


@pytest.mark.parametrize("core", ["axis_skid", "round_saturate", "transpose"])
def test_cores_are_read_alike(tmp_path: Path, core: str) -> None:
    case = next(case for case in frontends.cases() if case.core == core)
    assert not frontends.prove(case, tmp_path)[0]
