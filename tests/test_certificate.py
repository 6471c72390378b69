# SPDX-License-Identifier: Apache-2.0
"""Certificate: its norms equal those of the whole linear map, and its frames attain them in model and RTL."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import run_request
from commands.common.slopes import deepest, slope_response
from commands.run import sim
from commands.study import certify
from commands.study.node_bounds import node_bounds, node_format
from tactile_depth.base.errors import InputError
from tactile_depth.chip.bounds import difference_bounds
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.limits import DEPTH_HEADROOM
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.tactile_depth import solve
from tactile_depth.depth import reference
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.sensor import Camera, Sensor

WHOLE: list[dict[str, Any]] = [
    {"columns": 16},
    {"columns": 16, "neumann": True, "coefficient_width": 10, "data_width": 12},
    {"columns": 16, "rows": 9, "solver": "tridiagonal"},
    {"columns": 16, "rows": 12, "solver": "tridiagonal", "neumann": True, "coefficient_width": 12},
    {"columns": 16, "rows": 8, "solver": "tridiagonal", "depth_range_px": 0.5},
    {"columns": 16, "rows": 9, "solver": "tridiagonal", "neumann": True, "coefficient_width": 12},
]
each_whole = pytest.mark.parametrize("choices", WHOLE, ids=lambda c: "-".join(map(str, c.values())))


class Words(Monitor):
    """Words of every node: (single samples, words)."""

    def __init__(self) -> None:
        super().__init__()
        self.words: dict[Any, Any] = {}

    def linear(self, node: Any, response: Any) -> None:
        self.words.setdefault(node, []).append(response.reshape(len(response), -1))


def whole_map(config: Configuration) -> tuple[Any, ...]:
    """Return the response of every word to each pixel of divergence and of depth, by running the solver on floats."""
    shape = (config.rows, config.columns)
    count = config.rows * config.columns
    monitor = Words()
    depth = solve(np.eye(count).reshape(count, *shape), config, monitor).reshape(count, count)
    return {node: np.concatenate(words, axis=1) for node, words in monitor.words.items()}, depth


def over_slopes(words: Any, config: Configuration) -> Any:
    """Return the norm of each word over slopes up to the limit, in its codes."""
    maps = np.moveaxis(words.reshape(config.rows, config.columns, -1), -1, 0)
    norms = [np.abs(slope_response(word, config.neumann)).sum() for word in maps]
    return np.array(norms) * config.gradient_limit / config.gradient_lsb


@each_whole
def test_slopes_are_the_norms_of_the_whole_map(choices: Any) -> None:
    config = Configuration(**choices)
    words, _ = whole_map(config)
    nodes = node_bounds(config)
    assert [node.name for node in nodes] == list(words)
    for node in nodes:
        norm = over_slopes(words[node.name], config).max() * node.form.lsb
        assert node.slopes == pytest.approx(norm, rel=1e-9, abs=1e-9), node.name
        assert node.reached == node.slopes
        own = np.abs(slope_response(node.response, config.neumann)).sum() * config.gradient_limit / config.gradient_lsb
        assert own * node.form.lsb == pytest.approx(node.reached, rel=1e-9, abs=1e-9), node.name


@pytest.mark.parametrize("choices", [choices for choices in WHOLE if not choices.get("neumann")], ids=str)
def test_depths_are_the_norms_of_the_whole_map(choices: Any) -> None:
    """Compute norms over depth by the inverse of the map to depth. The certificate may give a slightly larger bound:
    see below."""
    config = Configuration(**choices)
    words, depth = whole_map(config)
    from_depth = np.linalg.inv(depth)
    for node in node_bounds(config):
        over_depths = np.abs(from_depth @ words[node.name]).sum(axis=0) * config.depth_range_px / config.depth_lsb_px
        bound = np.minimum(over_depths, over_slopes(words[node.name], config)).max() * node.form.lsb
        assert node.depths >= bound * (1 - 1e-3), node.name
        if node.name.startswith("row_inverse"):  # not every word's norm over slopes is computed
            assert node.depths <= over_depths.max() * node.form.lsb * (1 + 1e-9), node.name
        elif not node.name.startswith(("row_forward", "column_forward")):  # before the solve: by the Laplacian
            assert node.depths == pytest.approx(bound, rel=1e-9), node.name


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize(("rows", "columns"), [(16, 16), (11, 16), (32, 16)])
def test_the_deepest_point_is_where_it_is_looked_for(rows: int, columns: int, neumann: bool) -> None:
    lone = np.eye(rows * columns).reshape(-1, rows, columns)
    depths = [np.abs(slope_response(z, neumann)).sum() for z in reference.solve(lone, neumann)]
    assert deepest(rows, columns, neumann) == pytest.approx(max(depths), rel=1e-12)


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize("rows", [8, 21, 32])
def test_the_bound_of_a_difference_holds_and_is_close(rows: int, neumann: bool) -> None:
    """Check the shorter bound of the configuration, with ideal coefficients and the variation of weights taken as 2."""
    config = Configuration(columns=32, rows=rows, solver="tridiagonal", neumann=neumann, coefficient_width=24)
    bound = {node.name: node for node in node_bounds(config)}["elimination.difference"].slopes
    by_slopes = difference_bounds(rows, 32, neumann)[0].max() / config.depth_limit_px
    assert bound * (1 - 1e-4) <= by_slopes <= 1.3 * bound


def laplacian(z: np.ndarray, neumann: bool) -> Any:
    """Return the five-point Laplacian; a neighbour outside is the mirrored negative, or (Neumann) the pixel itself."""
    f = np.zeros_like(z)
    for axis in (-1, -2):
        ends = [np.take(z, [at], axis) * (1 if neumann else -1) for at in (0, -1)]
        f += np.diff(np.concatenate((ends[0], z, ends[1]), axis), n=2, axis=axis)
    return f


@pytest.mark.parametrize("solver", ["spectral", "tridiagonal"])
@pytest.mark.parametrize("depth_range_px", [0.25, 1.0, 4.0])
def test_depths_at_their_bounds_saturate_no_node(solver: str, depth_range_px: Any) -> None:
    """Drive each node as far as depths within the range can; only the widest slope limit allows such depths."""
    config = Configuration(columns=16, solver=solver, depth_range_px=depth_range_px, gradient_limit=64.0)
    words, depth = whole_map(config)
    from_depth = np.linalg.inv(depth)
    worst = []
    for name in words:
        response = from_depth @ words[name]
        worst.append(np.sign(response[:, np.abs(response).sum(axis=0).argmax()]).reshape(16, 16))
    z = np.stack(worst)[:, ::-1] if solver == "tridiagonal" else np.stack(worst)  # its depth leaves bottom row first
    f = np.rint(laplacian(depth_range_px * z, False) / config.gradient_lsb).astype(np.int64)
    monitor = Monitor()
    codes = solve(f, config, monitor)
    assert not monitor.saturations
    assert np.abs(codes).max() * config.depth_lsb_px == pytest.approx(depth_range_px, rel=0.01)


def slopes_of_field(z: Any) -> Any:
    """Return slopes (..., 2) whose divergence is the Laplacian of z, zero half a pixel outside.

    The divergence takes the slope outside as 0, so a slope at the edge continues along the whole row.
    """
    along = [np.diff(z, axis=axis, append=-np.take(z, [-1], axis)) - 2 * np.take(z, [0], axis) for axis in (-1, -2)]
    return np.stack(along, axis=-1)


@pytest.mark.parametrize("solver", [pytest.param("spectral", marks=pytest.mark.regress), "tridiagonal"])
def test_depths_at_their_bounds_through_rtl(tmp_path: Any, solver: str) -> None:
    """Send depths at their bounds to the RTL by a calibration with one colour for every pixel of every pattern."""
    size, bits = 16, 4
    patterns_held = 2 ** (3 * bits) // size**2
    config = Configuration(columns=size, solver=solver, gradient_limit=32.0)
    words, depth = whole_map(config)
    from_depth = np.linalg.inv(depth)
    meant = []
    patterns: list[Any] = []
    for name in [name for name in words if not name.startswith(("row_forward", "column_forward"))]:
        response = from_depth @ words[name]
        pattern = np.sign(response[:, np.abs(response).sum(axis=0).argmax()]).reshape(size, size)
        pattern = pattern[::-1] if solver == "tridiagonal" else pattern
        if np.abs(response).max() and not any((pattern == other).all() for other in patterns):
            meant.append(name)
            patterns.append(pattern)
    field = np.stack(patterns[:patterns_held])
    gradient = np.zeros((patterns_held * size**2, 2))
    slopes = slopes_of_field(config.depth_range_px * field)
    gradient[: field.size] = slopes.reshape(-1, 2)
    table = Sensor("patterns", gradient.reshape((1 << bits,) * 3 + (2,)), 0.2, camera=Camera(size, size))
    table.save(tmp_path / "c.npz")
    index = np.arange(field.size).reshape(field.shape)
    colours = np.stack([index >> 2 * bits, index >> bits & 15, index & 15], axis=-1) << (8 - bits)
    np.save(tmp_path / "field.npy", colours.astype(np.uint8))
    folders = [f"FRAMES={tmp_path / 'field.npy'}", f"CALIBRATION={tmp_path / 'c.npz'}", f"OUT={tmp_path / 'out'}"]
    assert sim.run(run_request.parse([f"N={size}", f"SOLVER={solver}", "SIM=icarus", *folders])) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["saturations"] == {}
    assert report["registers"]["saturations"] == 0
    reached = np.load(tmp_path / "out" / "depth.npy") * config.depth_lsb_px
    np.testing.assert_allclose(reached, config.depth_range_px * field, rtol=1e-3)

    peaks = certify.Peaks({name: node_format(name, config).width for name in words}, len(field))
    certify.tactile_depth(colours.astype(np.uint8), load(str(tmp_path / "c.npz")), config, peaks)
    nodes = {node.name: node for node in node_bounds(config)}
    for frame, name in enumerate(meant[:patterns_held]):
        bound = np.abs(from_depth @ words[name]).sum(axis=0).max() * config.depth_range_px / config.depth_lsb_px
        assert peaks.peaks[name][frame] == pytest.approx(bound, rel=1e-3), name
        assert bound * nodes[name].form.lsb < nodes[name].form.limit


@pytest.mark.parametrize("depth_range_px", [1.0, 2.0])
def test_a_shallow_range_holds_the_steepest_slopes_that_stay_in_it(depth_range_px: Any) -> None:
    """Combine steep slopes and a shallow range: the input of the elimination is then larger than any mode of the
    depth."""
    config = Configuration(columns=32, solver="tridiagonal", depth_range_px=depth_range_px)
    node = {node.name: node for node in node_bounds(config)}["row_forward.phase.re"]
    slopes = np.sign(slope_response(node.response, False))
    depth = reference.solve(divergence(slopes), False)
    assert np.abs(depth).max() <= depth_range_px
    monitor = Monitor()
    solve(divergence(np.rint(0.99 * slopes / config.gradient_lsb).astype(np.int64)), config, monitor)
    assert not monitor.saturations


def test_a_format_too_narrow_for_the_range_is_refused_with_its_node() -> None:
    class Narrow(Configuration):
        @property
        def column_inverse(self) -> Any:
            form = super().column_inverse
            return Format(form.width, form.fraction + 1)

    with pytest.raises(InputError, match=r"spectral_divide .* a depth within the range of 4 pixels") as caught:
        Narrow(columns=16)
    assert "\n" not in str(caught.value)

    class Shallow(Configuration):
        @property
        def elimination(self) -> Any:  # as for modes of the depth alone
            return Format.holding(2 * self._bounds.depth_modes / DEPTH_HEADROOM, self.arithmetic_width)

    Shallow(columns=32, solver="tridiagonal")
    with pytest.raises(InputError, match=r"elimination\.difference"):
        Shallow(columns=32, solver="tridiagonal", depth_range_px=1.0)


@pytest.mark.parametrize("solver", ["spectral", "tridiagonal"])
@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize("depth_range_px", [None, 0.3, 3.0])
@pytest.mark.parametrize(("columns", "data_width", "coefficient_width"), [(16, 12, 10), (32, 24, 18), (32, 32, 24)])
def test_no_derived_format_saturates_within_the_range(
    solver: str, neumann: bool, depth_range_px: Any, columns: int, data_width: int, coefficient_width: int
) -> None:
    words: dict[str, Any] = {"data_width": data_width, "coefficient_width": coefficient_width}
    config = Configuration(columns, 0, solver, neumann, **words, depth_range_px=depth_range_px)
    assert {node.name for node in node_bounds(config) if node.depths_headroom_bits < 0} == set()


def test_every_node_has_its_format() -> None:
    """Compare widths with the model: a full-scale frame clips at them."""
    for choices in WHOLE:
        config = Configuration(**choices)

        class Limits(Monitor):
            def rounded(self, node: Any, values: Any, config: Configuration = config) -> None:
                assert node_format(node, config).width in (config.data_width, config.arithmetic_width)
                self.clipped_to = node_format(node, config)

        solve(np.ones((config.rows, config.columns), np.int64), config, Limits())


def run(tmp_path: Any, *arguments: Any, rtl: bool = True) -> Any:
    out = tmp_path / "out"
    assert certify.run(run_request.parse([*arguments, f"OUT={out}"]), rtl) == 0
    return json.loads((out / "certificate.json").read_text())


@pytest.mark.parametrize(
    ("words", "depth_range"),
    [
        ("N=16", ""),
        *(
            pytest.param(*case, marks=pytest.mark.regress)
            for case in (
                ("N=16", "worst"),
                ("ROWS=12 COLS=32 SOLVER=tridiagonal BOUNDARY=neumann DATA_WIDTH=16 COEFF_WIDTH=12", ""),
                ("ROWS=12 COLS=32 SOLVER=tridiagonal BOUNDARY=neumann DATA_WIDTH=16 COEFF_WIDTH=12", "worst"),
                ("N=16 BOUNDARY=neumann CALIBRATION=gelsight-mini", ""),
                ("N=16 BOUNDARY=neumann CALIBRATION=gelsight-mini", "worst"),
                ("ROWS=9 COLS=16 SOLVER=tridiagonal", ""),
                ("ROWS=9 COLS=16 SOLVER=tridiagonal", "worst"),
            )
        ),
    ],
)
def test_rtl_and_model_saturate_where_the_certificate_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: Any, depth_range: int
) -> None:
    document = run(tmp_path, *words.split(), *([f"DEPTH_RANGE={depth_range}"] if depth_range else []))
    assert document["rtl"]
    assert document["faults"] == []
    assert "no depth within the range saturates a node" in capsys.readouterr().out
    if depth_range:
        assert document["saturated"] == []
        assert min(node["slopes_headroom_bits"] or 0 for node in document["nodes"]) >= 0
    else:
        assert "row_inverse.output" in document["saturated"]


def test_a_real_sensor_is_certified_from_its_slopes_to_its_depth(tmp_path: Path) -> None:
    words = "PRESET=sensor ROWS=12 COLS=16 DATA_WIDTH=12 COEFF_WIDTH=10 GAIN_WIDTH=16 DEPTH_RANGE=2"
    document = run(tmp_path, *words.split(), rtl=False)
    assert document["boundary"] == "neumann"
    assert min(node["depths_headroom_bits"] or 0 for node in document["nodes"]) >= 0


@pytest.mark.parametrize("solver", ["spectral", "tridiagonal"])
def test_the_worst_depth_range_and_its_price(tmp_path: Path, capsys: pytest.CaptureFixture[str], solver: str) -> None:
    run(tmp_path, "N=32", f"SOLVER={solver}", "DEPTH_RANGE=worst", rtl=False)
    output = capsys.readouterr().out
    assert "no slopes at all saturate a node" in output
    assert "bits of resolution" in output


def test_a_certificate_that_is_wrong_is_found_out(tmp_path: Path) -> None:
    config = Configuration(columns=16)
    nodes = node_bounds(config)
    calibration = load("synthetic")
    frames, attempts = certify.worst_frames(nodes, calibration, config)
    peaks = certify.Peaks({node.name: node.form.width for node in nodes}, len(frames))
    certify.tactile_depth(frames, calibration, config, peaks)
    assert certify.check_model(frames, attempts, nodes, peaks, config.coefficient_width) == []
    output = next(node for node in nodes if node.name == "column_inverse.output")
    peaks.peaks["spectral_divide"] //= 2
    peaks.clips["column_forward.input"][0] = True
    faults = certify.check_model(frames, attempts, nodes, peaks, config.coefficient_width)
    assert any(fault.startswith("spectral_divide reached") for fault in faults)
    assert any(fault.startswith("column_forward.input saturated") for fault in faults)
    assert output.slopes_headroom_bits < 0
