# SPDX-License-Identifier: Apache-2.0
"""make reflex: the command comes from the pin, delays have their distributions, wrong pins and bad input are
reported."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import published
from commands.common.variables import read
from commands.run import bench, reflex, reflex_model
from commands.run.reflex_model import ReflexRun
from commands.study import report
from tactile_depth.base.files import RECORD
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_pixel_to_first_depth
from tactile_depth.chip.limits import COLUMNS

SMALL = ("N=16", "SIM=icarus", "CLOCK_MHZ=0.5", "TRIALS=2")
TRIALS = 20_000


def setup(**changes: Any) -> Any:
    return replace(reflex_model.Setup(speed=20, threshold=0.1, frame=2.5, exposure=0.5, read_out=0.9), **changes)


def test_draws_are_those_of_the_seed() -> None:
    first, again, other = (reflex_model.draw(5, seed, "near") for seed in (1, 1, 2))
    for name in ("phase", "waiting", "servo", "noise"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
        assert (getattr(first, name) != getattr(other, name)).any()
    assert (first.phase != reflex_model.draw(5, 1, "host").phase).any()


def test_delays_are_distributed_as_stated() -> None:
    """Draw the delays: mean and standard deviation are within five standard errors."""
    draws = reflex_model.draw(TRIALS, 3, "host")
    error = 5 / np.sqrt(TRIALS)
    assert draws.phase.mean() == pytest.approx(0.5, abs=error / np.sqrt(12))
    assert draws.phase.std() == pytest.approx(1 / np.sqrt(12), abs=error / np.sqrt(12))
    shares = np.bincount(draws.waiting) / TRIALS
    np.testing.assert_allclose(
        shares, np.full(reflex_model.DRIVER_BUFFERS, 1 / reflex_model.DRIVER_BUFFERS), atol=error, rtol=0
    )
    result = reflex_model.times(setup(), draws, np.zeros(TRIALS, int), np.zeros(TRIALS), np.zeros(TRIALS))
    servo = result.motion - result.command
    assert servo.mean() == pytest.approx(reflex_model.SERVO_MS, abs=error * reflex_model.SERVO_SPREAD_MS)
    assert servo.std() == pytest.approx(reflex_model.SERVO_SPREAD_MS, abs=error * reflex_model.SERVO_SPREAD_MS)


def test_a_trial_by_hand() -> None:
    draws = reflex_model.Draws(np.array([0.4]), np.array([2]), np.array([1.0]), np.array([0]))
    one = setup(transfer=3)
    assert one.exposed(0.4, 2) == pytest.approx(6.0)
    assert one.depth(0.4, 2) == pytest.approx(20e-3 * (6.0 - 0.625))
    assert one.depth(0.4, -1) == 0
    assert one.depth(0.4, 1000) == reflex_model.STOP_MM
    result = reflex_model.times(one, draws, np.array([2]), np.array([0.25]), np.array([0.5]))
    assert result.command[0] == pytest.approx(6.0 + 0.9 * 2.5 + 3 + 2 * 2.5 + 0.25 + 0.5)
    assert result.motion[0] == pytest.approx(result.command[0] + reflex_model.SERVO_MS + reflex_model.SERVO_SPREAD_MS)
    assert sum(part[0] for part in result.parts.values()) == pytest.approx(result.motion[0])


def test_rank_sum() -> None:
    near, host = np.arange(50.0), 60 + np.arange(81.0)
    assert reflex_model.rank_sum(near, host)["U"] == 0
    assert reflex_model.rank_sum(near, host)["p"] < 1e-20
    assert reflex_model.rank_sum(np.array([1.0, 4.0]), np.array([2.0, 3.0]))["U"] == 2  # 4 beats both


def test_published_spread() -> None:
    mean, spread = published.REFLEX["near"]["motion"]
    assert reflex_model.within_published({"mean": mean - 0.99 * spread, "sd": spread})
    assert not reflex_model.within_published({"mean": mean + 1.01 * spread, "sd": 1})
    assert not reflex_model.within_published({"mean": mean, "sd": 1.01 * spread})


@pytest.mark.parametrize(
    ("events", "says"),
    [
        ("d 40 b 45 c 47", "2 clocks after the deciding depth"),
        ("d 40 c 46", "without a depth above the threshold"),
        ("d 40 b 45", "did not rise after one"),
        ("d 40", "never rose"),
        ("d 41 b 45 c 46", "first depth 31 clocks after the last pixel, not 30"),
    ],
)
def test_pins_that_are_wrong(monkeypatch: pytest.MonkeyPatch, events: Any, says: str) -> None:
    monkeypatch.setattr(reflex, "last_pixel_to_first_depth", lambda config: 30)
    words = f"t 1 t 10 {events}".split()
    played = bench.Played(
        np.zeros(0), [(letter, (int(clock),)) for letter, clock in zip(words[::2], words[1::2], strict=True)], {}
    )
    sent = [reflex.Sent(0, 2, True)]
    _, faults = reflex.decisions(played, sent, Configuration(columns=16))
    assert any(says in fault for fault in faults), faults


def test_pins_that_are_right(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reflex, "last_pixel_to_first_depth", lambda config: 30)
    events: Any = [("t", (1,)), ("t", (10,)), ("d", (40,)), ("b", (45,)), ("c", (46,))]
    result, faults = reflex.decisions(
        bench.Played(np.zeros(0), events, {}),
        [reflex.Sent(0, 2, True)],
        Configuration(columns=16),
    )
    assert faults == []
    assert result == [reflex.Decision(2, 45, 36, 30, 5, 1)]


@pytest.mark.regress
def test_the_loop_on_the_rtl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the command on a small grid: command times are cycles of the pin, and latencies do not depend on the camera's
    rate."""
    out = tmp_path / "out"
    read(reflex.run, [*SMALL, "HOST_TRIALS=3", f"OUT={out}"])
    assert sorted(path.name for path in out.iterdir()) == [RECORD, "reflex.json", "reflex.png"]
    document = json.loads((out / "reflex.json").read_text())

    request = read(ReflexRun, [*SMALL[:2], "CLOCK_MHZ=0.7", SMALL[3]])
    draws = reflex_model.draw(request.trials, request.seed, "near")
    assert reflex_model.spacing(request)[0] != reflex_model.spacing(read(ReflexRun, SMALL))[0]
    once = replace(request, trials=1)  # of the same draws
    faster = reflex.loop(once, setup(threshold=document["threshold_mm"]), draws)
    assert [*faster] == [*COLUMNS]
    for solver, decided in faster.items():
        assert len(decided) == 1
        first = last_pixel_to_first_depth(Configuration(columns=16, solver=solver))
        for trial, decision, phase in zip(document["near"][solver]["trials"], decided, draws.phase, strict=False):
            assert trial["deciding_to_contact"] == reflex.DECIDING_CLOCKS
            assert trial["last_pixel_to_contact"] == decision.last_pixel_to_contact == first + decision.place + 1
            # 1 clock is 2 us there; a frame begins when its exposure ends.
            begin = (phase + trial["frame"]) * 2.5
            assert trial["command_ms"] == pytest.approx(begin + trial["first_pixel_to_contact"] / 500)
    assert document["same_frame_by_double_precision"] == 2
    assert len(document["host"]["trials"]) == 3

    monkeypatch.setattr(reflex, "DEFAULT_OUT", out)  # make report takes what is there
    section = report.reflex_section(report.document_of(reflex, "reflex")).html()
    assert "data:image/png" in section
    assert "deciding depth to contact" in section
