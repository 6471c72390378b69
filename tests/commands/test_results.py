# SPDX-License-Identifier: Apache-2.0
"""Results of `make sim`: verdict, warnings, files that replace earlier ones together, refusals of OUT."""

import errno
import json
import os
import resource
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from skimage import io  # type: ignore[attr-defined]

from commands.common import variables
from commands.common.repository import ROOT
from commands.run import bench, sim
from commands.run.compare import compare, warnings
from tactile_depth.base import files
from tactile_depth.chip.configuration import WORDS, Configuration

SMALL = ["N=16", "SIM=icarus"]
NAMES = [files.RECORD, "depth.npy", "depth.png", "report.json"]


@pytest.fixture
def run(run_command: Any) -> Any:
    """Run `make sim` on a small grid; return its exit status, its output and the lines on stderr."""
    return partial(run_command, "sim", *SMALL)


def content(folder: Path) -> dict[Any, Any]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def alter(monkeypatch: pytest.MonkeyPatch, change: Any) -> None:
    """Make the simulation return codes that `change` alters in place."""
    play = bench.play

    def altered(*arguments: Any, **options: Any) -> Any:
        played = play(*arguments, **options)
        change(played.codes)
        return played

    monkeypatch.setattr(bench, "play", altered)


# Codes that differ.


@pytest.mark.parametrize("solver", ["spectral", "tridiagonal"])
def test_differing_codes_are_counted_and_the_first_is_named(
    tmp_path: Path, run: Any, monkeypatch: pytest.MonkeyPatch, solver: str
) -> None:
    left = {"spectral": 12, "tridiagonal": 15 - 12}[solver]  # the last row leaves first

    def change(codes: np.ndarray) -> None:
        frames = codes.reshape(6, 16, 16)  # two frames, three times
        frames[3, left, 5] += 7
        frames[4, :] -= 1

    alter(monkeypatch, change)
    np.save(tmp_path / "two.npy", np.random.default_rng(1).integers(0, 256, (2, 16, 16, 3), dtype=np.uint8))
    words = [
        f"SOLVER={solver}",
        "REPEAT=3",
        "CALIBRATION=synthetic",
        f"FRAMES={tmp_path / 'two.npy'}",
        f"OUT={tmp_path / 'out'}",
    ]
    status, output, lines = run(*words)
    code = np.load(tmp_path / "out" / "depth.npy")[3, 12, 5]
    assert status == 1
    assert lines == []
    assert (
        f"RTL differs from the model in 257 of 1,536 codes; first at frame 3, row 12, column 5: {code}, expected "
        f"{code - 7}. Frames, rows and columns count from 0.\n"
    ) in output
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["differing_codes"] == 257
    assert not report["bit_exact"]


def test_equal_codes_are_counted(tmp_path: Path, run: Any) -> None:
    status, output, _ = run(f"OUT={tmp_path / 'out'}")
    assert status == 0
    assert "RTL equals the model on every code: 256 codes in 1 frame\n" in output
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["differing_codes"] == 0
    assert report["warnings"] == []


@pytest.mark.parametrize("repeats", [1, 2])  # for which codes are expected: with light gains each has its own
def test_the_first_differing_code_is_the_first_in_depth_npy(repeats: int) -> None:
    once = np.arange(24).reshape(2, 3, 4)
    codes = np.stack([once, once])
    expected = once if repeats == 1 else codes.copy()
    codes[1, 0, 2, 1] = -1
    codes[1, 1, 0, 0] = -2
    assert compare(codes, expected).sentence() == (
        "RTL differs from the model in 2 of 48 codes; first at frame 2, row 2, column 1: -1, expected 9. "
        "Frames, rows and columns count from 0."
    )


def red(picture: np.ndarray) -> Any:
    return np.count_nonzero((picture[..., 0] > 240) & (picture[..., 1:3] < 20).all(axis=-1))


def test_the_picture_marks_differing_codes_in_any_frame(
    tmp_path: Path, run: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    np.save(tmp_path / "grey.npy", np.full((8, 16, 16, 3), 128, np.uint8))
    words = [f"FRAMES={tmp_path / 'grey.npy'}", "CALIBRATION=synthetic", f"OUT={tmp_path / 'out'}"]
    run(*words)
    assert red(io.imread(tmp_path / "out" / "depth.png")) == 0

    def change(codes: np.ndarray) -> None:
        codes.reshape(8, 16, 16)[7, 3, 3] += 1  # beyond the frames that are drawn by default

    alter(monkeypatch, change)
    run(*words)
    assert red(io.imread(tmp_path / "out" / "depth.png")) > 0


# Warnings.


def test_a_large_error_gives_a_warning(tmp_path: Path, run: Any) -> None:
    words = ["DATA_WIDTH=12", "FRAMES=contacts", "DEPTH_RANGE=100", f"OUT={tmp_path / 'out'}"]
    status, _, lines = run(*words)
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    mean = np.mean([error for error in report["rms_percent_of_peak"] if error is not None])
    assert status == 0
    assert lines == [f"make sim: warning: {line}" for line in report["warnings"]]
    assert len(lines) == 1
    assert f"mean RMS error is {mean:.2f} % of peak, above 1 %" in lines[0]


@pytest.mark.parametrize(
    ("widths", "error", "clips", "line"),
    [
        ((12, 18), 7.84, {}, "words of 12 bits are too short for this grid; try DATA_WIDTH=16"),
        ((12, 18), 7.84, {"node": 3}, "values saturate; give a larger DEPTH_RANGE"),
        ((24, 18), 7.84, {}, "give a larger DATA_WIDTH or COEFF_WIDTH"),
    ],
)
def test_a_warning_names_what_reduces_the_error(widths: Any, error: Any, clips: Any, line: Any) -> None:
    config = Configuration(columns=16, data_width=widths[0], coefficient_width=widths[1])
    assert warnings(config, [error, None], clips) == [f"the mean RMS error is {error:.2f} % of peak, above 1 %: {line}"]
    assert warnings(config, [1.0, None], clips) == []
    assert warnings(config, [None], clips) == []


# OUT that cannot be used: exit status 2, one line, nothing written.


def _link(tmp_path: Path) -> Any:
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    return tmp_path / "link"


def _file(tmp_path: Path) -> Any:
    (tmp_path / "file").touch()
    return tmp_path / "file"


def _holding_a_folder(tmp_path: Path) -> Any:
    (tmp_path / "out" / "depth.png").mkdir(parents=True)
    return tmp_path / "out"


BAD_OUT: dict[str, Any] = {
    "300 characters": (lambda t: t / ("x" * 300), "File name too long"),
    "5,000 characters": (lambda t: t.joinpath(*["y" * 200] * 25), "File name too long"),
    "a dangling link": (_link, "is a link to"),
    "below a dangling link": (lambda t: _link(t) / "out", "link is a link to"),
    "a file": (_file, "is a file: give a folder"),
    "below a file": (lambda t: _file(t) / "out", "Not a directory"),
    "depth.png is a folder": (_holding_a_folder, "depth.png in it is a folder"),
    "in /proc": (lambda t: "/proc/out", "cannot be written"),
}


@pytest.mark.parametrize("case", BAD_OUT)
def test_an_out_that_cannot_be_used_is_refused(tmp_path: Any, refused: Any, case: Any) -> None:
    place, reason = BAD_OUT[case]
    out = place(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    line = refused("sim", *SMALL, f"OUT={out}")
    assert line.startswith("make sim: OUT=")
    assert reason in line
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("text", ["a\0b", "\ud800"], ids=["NUL", "half a character"])
@pytest.mark.parametrize("name", ["OUT", "FRAMES", "REFERENCE", "CALIBRATION", "ZERO", "SOLVER", "AT"])
def test_a_configuration_file_with_a_character_that_no_path_holds_is_refused(
    tmp_path: Path, refused: Any, name: str, text: str
) -> None:
    (tmp_path / "c.json").write_text(json.dumps({name: text}))
    line = refused("sim", *SMALL, f"CONFIG={tmp_path / 'c.json'}")
    assert f"{name} is {json.dumps(text)}: it holds a character that no path can hold" in line


NUMBERS = ("N", "ROWS", "COLS", "DATA_WIDTH", "COEFF_WIDTH", "GAIN_WIDTH", "DEPTH_RANGE", "PRESS", "NOISE", "REPEAT")


@pytest.mark.parametrize("name", [*NUMBERS, "SEED", "GAPS", "STALLS", "WAVES"])
@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e999"])
def test_every_number_is_finite(refused: Any, name: str, value: Any) -> None:
    assert refused("sim", *SMALL, f"{name}={value}").startswith(f"make sim: {name}={value}: accepted is a")


# Results replace earlier ones together.


@pytest.fixture
def earlier(tmp_path: Path, run: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return a folder with the results of a run and a file of the user."""
    kept = tmp_path_factory.getbasetemp() / "results-of-a-run"
    if not kept.exists():
        assert run(f"OUT={kept}")[0] == 0
    out = tmp_path / "out"
    shutil.copytree(kept, out)
    (out / "notes.txt").write_text("mine")
    (out / "mine.vcd").write_text("mine")
    return out


def test_the_page_of_make_sim_lists_every_field_of_the_report(earlier: Any) -> None:
    page = (ROOT / "docs" / "make-sim.md").read_text()
    listed = {f"`{key}`" for key in json.loads((earlier / "report.json").read_text())}
    numbers = {f"`{variable.lower()}`" for variable in WORDS.values()}
    assert [key for key in listed - numbers if key not in page] == []


NO_SPACE = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "depth.npy")
HELP = "free disk space, or give a folder on another disk"
LARGEST_FILE = 65_536  # bytes; 100 frames of 16 x 16 take more


@pytest.mark.parametrize(  # four moves aside, four moves in
    "failing", [0, 7, *(pytest.param(move, marks=pytest.mark.regress) for move in range(1, 7))]
)
def test_a_move_that_fails_brings_earlier_results_back(
    tmp_path: Path, run: Any, monkeypatch: Any, earlier: Any, failing: Any
) -> None:
    before = content(earlier)
    replace, moves = os.replace, []

    def full(source: Any, target: str) -> None:
        moves.append(target)
        if len(moves) == failing + 1:
            raise NO_SPACE
        replace(source, target)

    monkeypatch.setattr(files.os, "replace", full)
    status, _, lines = run("SOLVER=tridiagonal", f"OUT={earlier}")
    assert status == 3
    assert lines == [f"make sim: depth.npy: No space left on device: {HELP}"]
    assert content(earlier) == before


@pytest.mark.parametrize("fresh", [True, False], ids=["no results before", "results before"])
def test_a_write_that_fails_leaves_nothing_new(
    tmp_path: Path, run: Any, monkeypatch: Any, earlier: Any, fresh: Any
) -> None:
    out = tmp_path / "missing" / "new" if fresh else earlier
    before = sorted(tmp_path.rglob("*")), content(earlier)

    def full(*_: Any) -> None:
        raise OSError("4096 requested and 0 written")  # numpy's words for a full disk

    monkeypatch.setattr(sim.np, "save", full)
    status, _, lines = run(f"OUT={out}")
    assert status == 3
    assert lines == [f"make sim: a file could not be written to its end: {HELP}"]
    assert (sorted(tmp_path.rglob("*")), content(earlier)) == before


def test_a_file_that_does_not_fit_ends_with_one_line_that_helps(tmp_path: Path, earlier: Any) -> None:
    """Limit the size of files, which acts like a full disk."""
    np.save(tmp_path / "many.npy", np.zeros((100, 16, 16, 3), np.uint8))
    before = content(earlier)
    words = [*SMALL, f"FRAMES={tmp_path / 'many.npy'}", "CALIBRATION=synthetic", f"OUT={earlier}"]
    result = subprocess.run(
        [sys.executable, "-m", "commands", "sim", *words],
        cwd=ROOT,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (result.returncode, result.stderr) == (3, f"make sim: a file could not be written to its end: {HELP}\n")
    assert content(earlier) == before


def test_a_draft_lies_inside_out_so_that_it_is_on_the_same_disk(tmp_path: Path) -> None:
    with files.workspace(tmp_path / "out") as work:
        assert work.parent == tmp_path / "out"


def test_a_link_to_a_folder_is_followed(tmp_path: Path, run: Any) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    assert run(f"OUT={tmp_path / 'link'}")[0] == 0
    assert sorted(content(tmp_path / "real")) == NAMES


def test_waveforms_of_an_earlier_run_go_and_other_files_stay(run: Any, earlier: Any) -> None:
    others = ["mine.vcd", "notes.txt"]
    assert run("WAVES=1", f"OUT={earlier}")[0] == 0
    assert sorted(content(earlier)) == sorted([*NAMES, *others, "frame_bench.fst"])
    assert json.loads((earlier / "report.json").read_text())["waves"] == ["frame_bench.fst"]
    assert run(f"OUT={earlier}")[0] == 0
    assert sorted(content(earlier)) == sorted([*NAMES, *others])


@pytest.mark.parametrize("name", ["report.json", "depth.png"])
def test_a_file_of_others_is_not_replaced(tmp_path: Path, run: Any, name: str) -> None:
    (tmp_path / name).write_text('{"waves": ["notes.txt"]}')
    (tmp_path / "notes.txt").write_text("mine")
    before = content(tmp_path)
    status, _, lines = run(f"OUT={tmp_path}")
    which = f"{name} is there and was not written by an earlier run, or was changed since"
    assert (status, lines) == (2, [f"make sim: OUT={tmp_path}: {which}: move it away or give another name"])
    assert content(tmp_path) == before


def test_a_result_that_was_changed_is_not_replaced(run: Any, earlier: Any) -> None:
    (earlier / "report.json").write_text('{"waves": ["mine.vcd"]}')
    before = content(earlier)
    assert run(f"OUT={earlier}")[0] == 2
    assert content(earlier) == before


def test_all_files_below_a_cache_are_replaced(tmp_path: Path, run: Any) -> None:
    (tmp_path / files.CACHE_TAG).write_text(files.CACHE_SIGNATURE)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "report.json").write_text("of an earlier version")
    assert run(f"OUT={tmp_path / 'out'}")[0] == 0
    assert sorted(content(tmp_path / "out")) == NAMES[1:]


def test_a_simulation_that_fails_has_status_3(tmp_path: Path, run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: Any, **__: Any) -> None:
        raise RuntimeError("the simulation failed: see simulation.log")

    monkeypatch.setattr(bench, "play", crash)
    status, _, lines = run(f"OUT={tmp_path / 'out'}")
    assert status == variables.FAILURE
    assert lines == ["make sim: the simulation failed: see simulation.log"]
    assert list(tmp_path.iterdir()) == []
