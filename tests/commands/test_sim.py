# SPDX-License-Identifier: Apache-2.0
"""`make sim` as a user runs it: results, bars, files, and errors for bad input."""

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from skimage import io  # type: ignore[attr-defined]

from commands.common import published, run_request, simulator
from commands.run import sim
from tactile_depth.base.files import RECORD
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.depth.zero_offset import zero_offset
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.cli.drawing import DARK, OUTSIDE, painted
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.samples import sample
from tests.drawn_light import no_contact


def run(tmp_path: Any, *arguments: Any) -> Any:
    """Run `make sim` into tmp_path/out; return the report. The run must be bit-exact."""
    out = tmp_path / "out"
    assert sim.run(run_request.parse([*arguments, f"OUT={out}"])) == 0
    assert sorted(p.name for p in out.iterdir()) == [RECORD, "depth.npy", "depth.png", "report.json"]
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith(".")] == []
    return json.loads((out / "report.json").read_text())


# The tridiagonal solver runs in `make test`, the slower one in `make regress`.
SPECTRAL_IN_REGRESS = ["tridiagonal", pytest.param("spectral", marks=pytest.mark.regress)]


def only(values: Any) -> Any:
    """Return the only value of a list; fail if there are several."""
    assert len(set(values)) == 1, f"not constant: {sorted(set(values))}"
    return values[0]


# Icarus plays the smallest rectangles and lanes in `make test`, below.
@pytest.mark.parametrize("simulator", ["verilator", pytest.param("icarus", marks=pytest.mark.regress)])
@pytest.mark.parametrize("solver", SPECTRAL_IN_REGRESS)
@pytest.mark.parametrize("size", [64, *(pytest.param(size, marks=pytest.mark.regress) for size in (128, 256))])
def test_every_grid_on_every_simulator(tmp_path: Path, simulator: str, size: int, solver: str) -> None:
    report = run(tmp_path, f"N={size}", f"SIM={simulator}", f"SOLVER={solver}")
    assert report["bit_exact"]
    assert report["registers_agree"]
    latency = first_depth_latency(Configuration(columns=size, solver=solver))
    assert only(report["first_depth_latency_cycles"]) == latency
    bar = 2 * size**2 + 16 * size if solver == "spectral" else size**2 + 8 * size + 64
    assert latency <= bar < published.FIRST_DEPTH_CYCLES[size]
    if solver == "tridiagonal":
        assert only(report["last_pixel_to_first_depth_cycles"]) <= 8 * size + 64


@pytest.mark.parametrize("boundary", run_request.BOUNDARIES)
@pytest.mark.parametrize(
    ("rows", "columns", "chosen"), [(8, 16, "icarus"), pytest.param(240, 256, "verilator", marks=pytest.mark.regress)]
)
def test_rectangles(tmp_path: Path, rows: int, columns: int, boundary: str, chosen: Any) -> None:
    words = ["FRAMES=contacts", f"ROWS={rows}", f"COLS={columns}", f"SIM={chosen}"]
    words.append("DATA_WIDTH=22")  # of a length that no preset and no study has
    report = run(tmp_path, *words, f"BOUNDARY={boundary}", "SOLVER=tridiagonal")
    assert report["grid"] == [rows, columns]
    assert only(report["frame_interval_cycles"][1:]) == rows * columns
    assert np.load(tmp_path / "out" / "depth.npy").shape == (8, rows, columns)
    assert max(error for error in report["rms_percent_of_peak"] if error is not None) <= 0.075  # of 22 bits


def test_rows_are_in_the_order_of_the_input(tmp_path: Path) -> None:
    depth = {}
    for solver in COLUMNS:
        report = run(tmp_path, "N=64", "FRAMES=contacts", f"SOLVER={solver}")
        depth[solver] = np.load(tmp_path / "out" / "depth.npy") * report["depth_lsb_mm"]
    np.testing.assert_allclose(depth["spectral"], depth["tridiagonal"], atol=1e-3 * depth["spectral"].max())


@pytest.mark.parametrize(
    ("rows", "columns", "lanes", "words"),
    [
        (9, 16, 2, ["SIM=icarus", "FRAMES=ball", "REPEAT=2", "GAPS=0.3"]),
        *(
            pytest.param(*case, marks=pytest.mark.regress)
            for case in (
                (64, 64, 8, ["FRAMES=contacts", "GAPS=0.3", "BOUNDARY=neumann"]),
                (100, 128, 16, ["FRAMES=contacts", "GAPS=0.3", "REFERENCE=flat", "ZERO=flat", "GRADIENT=quadratic"]),
                (256, 256, 32, ["FRAMES=ball", "REPEAT=2"]),
                (127, 128, 64, ["FRAMES=ball", "REPEAT=2"]),
                (21, 64, 8, ["SIM=icarus", "FRAMES=ball", "REPEAT=2", "BOUNDARY=neumann"]),
            )
        ),
    ],
)
def test_lanes_bring_the_depth_earlier(tmp_path: Path, rows: int, columns: int, lanes: int, words: list[str]) -> None:
    grid = [f"ROWS={rows}", f"COLS={columns}", "SOLVER=tridiagonal", *words]
    one = run(tmp_path, *grid)
    depth_of_one = np.load(tmp_path / "out" / "depth.npy")
    several = run(tmp_path, *grid, f"LANES={lanes}")
    assert (one["lanes"], several["lanes"]) == (1, lanes)
    assert several["registers_agree"]
    depth = np.load(tmp_path / "out" / "depth.npy")
    np.testing.assert_allclose(depth, depth_of_one, atol=1e-3 * np.abs(depth_of_one).max())
    first = only(several["last_pixel_to_first_depth_cycles"])
    assert first <= only(one["last_pixel_to_first_depth_cycles"])
    assert only(several["last_pixel_to_last_depth_cycles"]) == first + rows * columns // lanes - 1

    run(tmp_path, *grid, f"LANES={lanes}", "GAPS=0.2", "STALLS=0.3")
    np.testing.assert_array_equal(np.load(tmp_path / "out" / "depth.npy"), depth)


@pytest.mark.regress
def test_the_largest_grid(tmp_path: Path) -> None:
    report = run(tmp_path, "N=1024", "SOLVER=tridiagonal")
    assert only(report["last_pixel_to_first_depth_cycles"]) <= 8 * 1024 + 64


# The bars in % of peak; Neumann twice that.
@pytest.mark.parametrize(
    ("solver", "boundary", "size", "data_width", "percent"),
    [
        ("spectral", "dirichlet", 64, 24, 0.005),
        ("tridiagonal", "neumann", 128, 24, 0.01),  # the options of a real sensor
        *(
            pytest.param(*case, marks=pytest.mark.regress)
            for case in (
                ("spectral", "dirichlet", 128, 24, 0.005),
                ("spectral", "dirichlet", 256, 24, 0.02),
                ("spectral", "neumann", 128, 24, 0.01),
                ("tridiagonal", "dirichlet", 64, 24, 0.005),
                ("tridiagonal", "dirichlet", 128, 24, 0.005),
                ("tridiagonal", "dirichlet", 128, 27, 0.001),
                ("tridiagonal", "neumann", 128, 27, 0.002),
                ("tridiagonal", "dirichlet", 512, 27, 0.01),
            )
        ),
    ],
)
def test_accuracy_and_rate(
    tmp_path: Path, solver: str, boundary: str, size: int, data_width: int, percent: Any
) -> None:
    chosen = [f"SOLVER={solver}", f"BOUNDARY={boundary}", f"DATA_WIDTH={data_width}"]
    report = run(tmp_path, f"N={size}", "FRAMES=contacts", *chosen)
    latency = first_depth_latency(Configuration(columns=size, solver=solver))
    assert len(report["rms_percent_of_peak"]) >= 6
    assert np.mean(report["rms_percent_of_peak"]) <= percent
    assert max(report["rms_percent_of_peak"]) <= 3 * percent
    assert only(report["first_depth_latency_cycles"]) == latency
    assert only(report["frame_interval_cycles"][1:]) == size**2
    assert report["frame_interval_cycles"][0] is None
    assert report["saturations"] == {}
    assert all(contact > latency for contact in report["contact_latency_cycles"])
    codes = np.load(tmp_path / "out" / "depth.npy")
    assert codes.dtype == np.int32
    assert codes.shape == (8, size, size)


@pytest.mark.parametrize("solver", SPECTRAL_IN_REGRESS)
@pytest.mark.parametrize(
    "disturbance",
    [
        ["GAPS=0.3", "STALLS=0.3"],
        *(pytest.param([alone], marks=pytest.mark.regress) for alone in ("GAPS=0.3", "STALLS=0.3")),
    ],
)
def test_gaps_and_stalls(tmp_path: Path, disturbance: Any, solver: str) -> None:
    quiet = run(tmp_path, "N=64", "FRAMES=contacts", f"SOLVER={solver}")
    codes = np.load(tmp_path / "out" / "depth.npy")
    report = run(tmp_path, "N=64", "FRAMES=contacts", f"SOLVER={solver}", *disturbance)
    np.testing.assert_array_equal(np.load(tmp_path / "out" / "depth.npy"), codes)
    if disturbance == ["GAPS=0.3"]:
        expected = last_pixel_to_first_depth(Configuration(columns=64, solver=solver))
        assert only(report["last_pixel_to_first_depth_cycles"]) == expected
        assert only(quiet["last_pixel_to_first_depth_cycles"]) == expected


def test_repeat_keeps_every_latency(tmp_path: Path) -> None:
    report = run(tmp_path, "N=64", "REPEAT=20", "FRAMES=seal")
    assert report["frames"] == 20
    for latency in ("first_depth", "last_depth", "last_pixel_to_first_depth", "contact"):
        key = f"{latency}_cycles" if latency.startswith("last_pixel") else f"{latency}_latency_cycles"
        only(report[key])
    assert np.load(tmp_path / "out" / "depth.npy").shape == (20, 64, 64)


@pytest.mark.parametrize("solver", COLUMNS)
def test_a_contact_as_deep_as_the_range_does_not_saturate(tmp_path: Path, solver: str) -> None:
    assert run(tmp_path, "N=64", "FRAMES=deep", f"SOLVER={solver}")["saturations"] == {}


@pytest.mark.parametrize("solver", SPECTRAL_IN_REGRESS)
def test_a_contact_over_twice_as_deep_saturates_and_says_so(tmp_path: Path, solver: str) -> None:
    deepest = 16 * 15.232 / 64  # mm: the peak of `deep` at N = 64, a quarter of the grid
    report = run(tmp_path, "N=64", "FRAMES=deep", f"SOLVER={solver}", f"DEPTH_RANGE={deepest / 2.05}")
    assert sum(report["saturations"].values()) > 0
    assert report["registers_agree"]  # the hardware counted the same number
    codes = np.load(tmp_path / "out" / "depth.npy")
    assert codes.max() == 2**23 - 1, "the peak must stay at full scale"
    assert codes[0, 28:36, 28:36].min() > 2**22, "a wrapped code shows as a hole in the peak"


def test_flat_gel_reads_nothing(tmp_path: Path) -> None:
    report = run(tmp_path, "N=16", "FRAMES=flat", "SIM=icarus")
    assert report["rms_percent_of_peak"] == [None]
    assert report["contact_latency_cycles"] == [None]


# Verilator compiles its whole runtime for it.
@pytest.mark.parametrize("simulator", ["icarus", pytest.param("verilator", marks=pytest.mark.regress)])
def test_waves(tmp_path: Path, simulator: str) -> None:
    out = tmp_path / "out"
    assert sim.run(run_request.parse(["N=16", f"SIM={simulator}", "WAVES=1", f"OUT={out}"])) == 0
    assert [p for p in out.iterdir() if p.suffix in (".vcd", ".fst") and p.stat().st_size]


def test_pictures_with_a_reference(tmp_path: Path) -> None:
    folder = tmp_path / "frames"
    folder.mkdir()
    background = no_contact(load("gelsight-mini"))[::5, ::5]
    io.imsave(tmp_path / "background.png", background, check_contrast=False)
    for name in ("2.png", "12.png"):
        frame = background.copy()
        frame[16:32, 24:40, 0] += 30
        io.imsave(folder / name, frame, check_contrast=False)
    report = run(
        tmp_path,
        *("N=16", "SIM=icarus"),
        f"FRAMES={folder}",
        f"REFERENCE={tmp_path / 'background.png'}",
        "CALIBRATION=gelsight-mini",
    )
    assert report["frames"] == 2
    assert report["pixel_pitch_mm"] == pytest.approx(240 / 16 * load("gelsight-mini").pixel_pitch_mm)


def _press(tmp_path: Path) -> list[Any]:
    """Return the variables of a drawn press, its reference and its calibration."""
    drawn = sample("ball")
    drawn.sensor.save(tmp_path / "sensor.npz")
    for file, image in (("press.png", drawn.image), ("background.png", drawn.reference)):
        io.imsave(tmp_path / file, image, check_contrast=False)
    words: dict[str, Any] = {"FRAMES": "press.png", "REFERENCE": "background.png", "CALIBRATION": "sensor.npz"}
    small = ["ROWS=24", "COLS=32", "SOLVER=tridiagonal", "BOUNDARY=neumann", "SIM=icarus"]
    return [*small, *(f"{key}={tmp_path / file}" for key, file in words.items())]


@pytest.fixture(scope="module")
def pressed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, np.ndarray]:
    """Report and codes of the drawn press."""
    folder = tmp_path_factory.mktemp("press")
    return run(folder, *_press(folder)), np.load(folder / "out" / "depth.npy")


def test_the_rtl_computes_what_the_python_interface_returns(tmp_path: Path) -> None:
    """Compare with Python: depth in mm is code times unit, and the codes equal those of the RTL."""
    report = run(tmp_path, *_press(tmp_path), f"ZERO={tmp_path / 'background.png'}", "LIGHT_GAINS=1")
    drawn = sample("ball")
    result = Pipeline(drawn.sensor, drawn.reference, grid=(24, 32))(drawn.image)
    codes = np.load(tmp_path / "out" / "depth.npy")[0]
    np.testing.assert_array_equal(result.codes, codes)
    np.testing.assert_array_equal(result.depth_mm, codes * report["depth_lsb_mm"])


def test_a_larger_picture_of_the_same_camera_has_the_same_depth(
    tmp_path: Path, pressed: tuple[Any, np.ndarray]
) -> None:
    words, (report, codes) = _press(tmp_path), pressed
    for name in ("press.png", "background.png"):
        io.imsave(tmp_path / name, io.imread(tmp_path / name).repeat(2, 0).repeat(2, 1), check_contrast=False)
    twice = run(tmp_path, *words)
    np.testing.assert_array_equal(np.load(tmp_path / "out" / "depth.npy"), codes)
    assert twice["depth_lsb_mm"] == report["depth_lsb_mm"]


def test_dark_pixels_are_reported_and_warned_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], pressed: tuple[Any, np.ndarray]
) -> None:
    words = _press(tmp_path)
    assert pressed[0]["dark_pixels"] == [0]
    background = io.imread(tmp_path / "background.png")
    background[:80, :80] = 0
    io.imsave(tmp_path / "background.png", background, check_contrast=False)
    report = run(tmp_path, *words)
    assert 64 <= report["dark_pixels"][0] <= 81  # the gains of neighbouring blocks are interpolated
    assert any("pixels are dark in REFERENCE" in line for line in report["warnings"])
    assert "pixels are dark in REFERENCE" in capsys.readouterr().err


def test_slopes_outside_the_calibrated_range_are_reported_and_warned_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], pressed: tuple[Any, np.ndarray]
) -> None:
    words = _press(tmp_path)
    assert pressed[0]["slopes_outside_calibration"] == [0]
    replace(sample("ball").sensor, fitted_slope={"cubic": 0.4}).save(tmp_path / "sensor.npz")
    report = run(tmp_path, *words)
    assert report["slopes_outside_calibration"][0] > 10
    assert any("steeper than any in the fit" in line for line in report["warnings"])
    assert "steeper than any in the fit" in capsys.readouterr().err


def test_flagged_pixels_are_painted() -> None:
    frame = np.full((2, 3, 3), 50, np.uint8)
    dark, outside = np.zeros((2, 3), bool), np.zeros((2, 3), bool)
    dark[0, 0] = outside[1, 2] = True
    picture = painted(frame, [(outside, OUTSIDE), (dark, DARK)])
    assert picture[0, 0].tolist() == [255, 0, 255]
    assert picture[1, 2].tolist() == [255, 165, 0]
    assert (np.delete(picture.reshape(6, 3), (0, 5), axis=0) == 50).all()
    assert (frame == 50).all()


@pytest.mark.parametrize("solver", SPECTRAL_IN_REGRESS)
def test_a_zero_is_subtracted(tmp_path: Path, solver: str) -> None:
    """Subtract the mean depth of two frames without contact, in the RTL and in double precision."""
    no_contact = np.random.default_rng(1).integers(96, 160, (2, 16, 16, 3)).astype(np.uint8)
    every = _npy(tmp_path / "every.npy", np.concatenate((no_contact, no_contact[:1, ::-1])))
    chosen = ["N=16", "BOUNDARY=neumann", f"SOLVER={solver}", f"FRAMES={every}", "SIM=icarus"]
    chosen.append("CALIBRATION=synthetic")
    report = run(tmp_path, *chosen, f"ZERO={_npy(tmp_path / 'rest.npy', no_contact)}")
    assert report["zero_offset"]
    down = -1 if solver == "tridiagonal" else 1  # blocks are counted as depth leaves
    zeroed = np.load(tmp_path / "out" / "depth.npy")[:, ::down]
    run(tmp_path, *chosen)
    solved = np.load(tmp_path / "out" / "depth.npy")[:, ::down].astype(np.int64)
    config = Configuration(columns=16, solver=solver, neumann=True, zero_offset=True)
    assert np.array_equal(zeroed, zero_offset(solved, captured_zero(solved[:2], config), config))


def test_a_configuration_file_gives_variables_and_explicit_ones_win(tmp_path: Path) -> None:
    words = _config(
        tmp_path / "c.json", '{"SOLVER": "tridiagonal", "ROWS": 24, "COLS": 32, "DATA_WIDTH": 20, "AT": "1,0"}'
    )
    request = run_request.parse([words, "DATA_WIDTH=22"])
    assert (request.rows, request.columns, request.solver, request.numbers["data_width"]) == (24, 32, "tridiagonal", 22)
    assert request.press.at_mm == (1, 0)
    square = run_request.parse([words, "N=64"])
    assert (square.rows, square.columns, square.numbers["data_width"]) == (64, 64, 20)


# Bad input: one line that names what was given, exit status 2, nothing left behind.


def _npy(path: Path, array: Any) -> Any:
    np.save(path, array)
    return path


def _calibration(path: Path, **change: Any) -> Any:
    camera = {"format_version": 2, "camera_size": (48, 64), "pixel_format": "rgb888", "black_level": 0.0}
    table = {"gradient": np.zeros((4, 4, 4, 2)), "pixel_pitch_mm": 0.1, "exposure_us": np.nan, "flat_field": True}
    np.savez(path, **{key: value for key, value in {**camera, **table, **change}.items() if value is not None})
    return path


def _picture(path: Path, rows: int, columns: int, level: int = 100) -> Any:
    io.imsave(path, np.full((rows, columns, 3), level, np.uint8), check_contrast=False)
    return path


def _config(path: Path, text: str) -> str:
    path.write_text(text)
    return f"CONFIG={path}"


def _cut(path: Path) -> Any:
    path.write_bytes(path.read_bytes()[:300])
    return path


def _mixed(folder: Path) -> Any:
    folder.mkdir()
    for name, rows in (("1.png", 16), ("2.png", 20)):
        io.imsave(folder / name, np.zeros((rows, 16, 3), np.uint8), check_contrast=False)
    return folder


BAD_INPUT: dict[str, Any] = {
    "shape": lambda t: f"FRAMES={_npy(t / 'a.npy', np.zeros((2, 16, 16), np.uint8))} CALIBRATION=synthetic",
    "type": lambda t: f"FRAMES={_npy(t / 'a.npy', np.zeros((2, 16, 16, 3), np.float32))} CALIBRATION=synthetic",
    "truncated frames": lambda t: (
        f"FRAMES={_cut(_npy(t / 'a.npy', np.zeros((2, 16, 16, 3), np.uint8)))} CALIBRATION=synthetic"
    ),
    "small frames": lambda t: f"FRAMES={_npy(t / 'a.npy', np.zeros((2, 8, 16, 3), np.uint8))} CALIBRATION=synthetic",
    "mixed frames": lambda t: f"FRAMES={_mixed(t / 'mixed')} CALIBRATION=synthetic",
    "unknown scene": lambda t: "FRAMES=cube",
    "a picture without a calibration": lambda t: f"FRAMES={_picture(t / 'a.png', 48, 64)}",
    "a reference without a calibration": lambda t: f"REFERENCE={_picture(t / 'a.png', 48, 64)}",
    "a zero offset without a calibration": lambda t: f"ZERO={_picture(t / 'a.png', 48, 64)}",
    "a real sensor without a reference": lambda t: f"CALIBRATION=gelsight-mini FRAMES={_picture(t / 'a.png', 48, 64)}",
    "a real sensor and a scene": lambda t: "CALIBRATION=gelsight-mini REFERENCE=flat",
    "a picture of another aspect ratio": lambda t: (
        f"FRAMES={_picture(t / 'a.png', 48, 60)} CALIBRATION=gelsight-mini REFERENCE={t / 'a.png'}"
    ),
    "an old calibration without a camera size": lambda t: (
        f"CALIBRATION={_calibration(t / 'c.npz', format_version=None)}"
    ),
    "a reference too dark to read": lambda t: (
        f"REFERENCE={_picture(t / 'a.png', 48, 64, 4)} FRAMES={t / 'a.png'} CALIBRATION=gelsight-mini"
    ),
    "a camera size with other signs": lambda t: "CAMERA_SIZE=-320x240",
    "a camera size out of range": lambda t: (
        f"CAMERA_SIZE=4x4 CALIBRATION={_calibration(t / 'c.npz', format_version=None)}"
    ),
    "a camera size with the synthetic sensor": lambda t: "CAMERA_SIZE=320x240",
    "a camera size that is none": lambda t: "CAMERA_SIZE=320",
    "a camera size that contradicts the file": lambda t: "CALIBRATION=gelsight-mini CAMERA_SIZE=640x480",
    "not a power of two": lambda t: "N=100",
    "N too small": lambda t: "N=8",
    "N too large": lambda t: "N=1024",
    "a rectangle for the spectral solver": lambda t: "ROWS=24 COLS=32",
    "too few rows": lambda t: "ROWS=4 COLS=16 SOLVER=tridiagonal",
    "columns no power of two": lambda t: "COLS=24 ROWS=16 SOLVER=tridiagonal",
    "boundary": lambda t: "BOUNDARY=periodic",
    "N no number": lambda t: "N=big",
    "solver": lambda t: "SOLVER=multigrid",
    "simulator": lambda t: "SIM=other",
    "calibration": lambda t: "CALIBRATION=other",
    "truncated calibration": lambda t: f"CALIBRATION={_cut(_calibration(t / 'c.npz'))}",
    "NaN": lambda t: f"CALIBRATION={_calibration(t / 'c.npz', gradient=np.full((4, 4, 4, 2), np.nan))}",
    "unit of slopes": lambda t: f"CALIBRATION={_calibration(t / 'c.npz', gradient=np.full((4, 4, 4, 2), 1e6))}",
    "data width": lambda t: "DATA_WIDTH=33",
    "coefficient width": lambda t: "COEFF_WIDTH=9",
    "gain width": lambda t: "GAIN_WIDTH=25",
    "gain width and block": lambda t: "GAIN_WIDTH=17 N=512 REFERENCE=flat",
    "width and format": lambda t: "DATA_WIDTH=12 N=512",
    "depth range": lambda t: "DEPTH_RANGE=0",
    "depth range of a thousandth of a pixel": lambda t: "DEPTH_RANGE=0.001",
    "gaps": lambda t: "GAPS=1",
    "stalls": lambda t: "STALLS=often",
    "repeat": lambda t: "REPEAT=0",
    "a position that is no number": lambda t: "AT=0,nan",
    "a position without an end": lambda t: "AT=inf,0",
    "unknown variable": lambda t: "SIZE=16",
    "no configuration file": lambda t: f"CONFIG={t / 'c.json'}",
    "configuration that is no JSON": lambda t: _config(t / "c.json", "SOLVER=spectral"),
    "configuration nested deep": lambda t: _config(t / "c.json", "[" * 60_000),
    "configuration of a megabyte": lambda t: _config(t / "c.json", "{" + " " * 1_000_000 + "}"),
    "configuration that is a list": lambda t: _config(t / "c.json", "[24]"),
    "unknown variable in a configuration": lambda t: _config(t / "c.json", '{"WIDTH": 24}'),
    "configuration in a configuration": lambda t: _config(t / "c.json", '{"CONFIG": "c.json"}'),
    "a list in a configuration": lambda t: _config(t / "c.json", '{"DATA_WIDTH": [24]}'),
    "reference with a scene": lambda t: "REFERENCE=background.png CALIBRATION=synthetic",
    "no zero": lambda t: f"ZERO={t / 'rest.png'} CALIBRATION=synthetic",
    "zero of another camera": lambda t: (
        f"ZERO={_npy(t / 'rest.npy', np.zeros((1, 32, 32, 3), np.uint8))} CALIBRATION=synthetic"
    ),
}


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input(tmp_path: Any, refused: Any, case: Any) -> None:
    words = BAD_INPUT[case](tmp_path).split()
    out = tmp_path / "results" / "out"
    out.mkdir(parents=True)
    arguments = [*([] if any(a.startswith("N=") for a in words) else ["N=16"]), *words, f"OUT={out}"]
    line = refused("sim", *arguments)
    value = words[0].partition("=")[2]
    assert os.path.basename(value) in line, "the line must name what was given"
    assert list(out.parent.rglob("*")) == [out], "something was left behind"


def test_missing_libpython(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: Any) -> None:
    monkeypatch.setattr("find_libpython.find_libpython", lambda: None)
    monkeypatch.delenv(simulator.LIBRARY, raising=False)
    message = "make sim: cocotb needs Python's shared library: run `apt-get install libpython3-dev`"
    assert refused("sim", "N=16", f"OUT={tmp_path / 'out'}") == message


def test_missing_simulator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: Any) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    message = "make sim: SIM=icarus, but Icarus Verilog is not installed: run `apt-get install iverilog`"
    assert refused("sim", "N=16", "SIM=icarus", f"OUT={tmp_path / 'out'}") == message
