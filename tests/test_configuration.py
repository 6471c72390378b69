# SPDX-License-Identifier: Apache-2.0
"""Configuration: formats hold the bounds without a spare bit, bad choices are refused, and recorded numbers are
unchanged."""

import re
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tactile_depth as td
from commands.common.repository import ROOT
from tactile_depth.base.errors import InputError
from tactile_depth.chip.bounds import bounds
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import NUMBERS, WORDS, Configuration, Format
from tactile_depth.chip.limits import DEPTH_HEADROOM
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.spectral_solver import spectral_solver
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.row_order import row_order
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.transpose import transpose

# Inputs that attain the bounds. Everything is linear, so a node's value is the sum of its responses to single
# words, and the input of the largest value has the signs of those responses.


@pytest.mark.parametrize(
    ("made", "old", "new"),
    [
        (Configuration, "auto_zero", "zero_offset"),
        (partial(CameraConfiguration, (480, 640), (96, 128)), "byte_serial", "'yuyv_bytes'"),
        (partial(CameraConfiguration, (480, 640), (96, 128)), "msb_aligned", "'raw10_lsb'"),
    ],
)
def test_an_argument_with_its_former_name_is_refused_with_the_new_one(made: Any, old: str, new: str) -> None:
    with pytest.raises(InputError, match=rf"{old}=True: it has another name now: give .*{new}"):
        made(**{old: True})


class Nodes(Monitor):
    """Recorder of the values at the nodes of a model that computes with floats."""

    def __init__(self) -> None:
        super().__init__()
        self.values: dict[Any, Any] = {}

    def linear(self, node: Any, response: Any) -> None:
        self.values[node] = response


def responses(size: Any) -> Any:
    """Return responses of a row's transforms to each sample: forward (N, nodes), inverse (N, nodes), modes (N, N)."""
    wide = Transform(0, 62, 50, 0, 62)
    forward, inverse = Nodes(), Nodes()
    modes = dst_forward(np.eye(size)[:, makhoul(size)], wide, forward)
    dst_inverse(modes, wide, inverse)
    return *(np.hstack(list(nodes.values.values())) for nodes in (forward, inverse)), modes


def step(response: Any) -> Any:
    """Return the response to a slope, which enters the divergence here with + and in the next word with -."""
    return -np.diff(response, axis=0, append=0)


def slope_patterns(size: int) -> Any:
    """Return signs of slopes (2, N, N, 2) that attain the bounds of the row and of the column transform."""
    forward, _, modes = responses(size)
    worst = np.argmax(np.abs(step(forward)).sum(axis=0) + 2 * np.abs(forward).sum(axis=0))
    along, down = np.sign(step(forward)[:, worst]), np.sign(forward[:, worst])
    alternate = np.resize([1, -1], size)[:, None]  # each row subtracts gy of the row above
    row = np.stack((alternate * along, alternate * down), axis=-1)

    length, steps = np.abs(forward).sum(axis=0), np.abs(step(forward)).sum(axis=0)
    mode_length, mode_steps = np.abs(modes).sum(axis=0), np.abs(step(modes)).sum(axis=0)
    reached = np.outer(mode_steps, length) + np.outer(mode_length, steps)
    mode, node = np.unravel_index(np.argmax(reached), reached.shape)
    m, c = modes[:, mode], forward[:, node]
    column = np.stack((np.outer(c, step(m)), np.outer(step(c), m)), axis=-1)
    return np.stack((row, np.sign(column)))


def depth_patterns(size: int) -> Any:
    """Return signs of depth fields (3, N, N) that attain the bounds of the inverse column and row transforms."""
    _, inverse, modes = responses(size)
    m = modes[:, np.argmax(np.abs(modes).sum(axis=0))]
    c = inverse[:, np.argmax(np.abs(inverse).sum(axis=0))]
    return np.sign(np.stack((np.outer(c, m), np.outer(m, m), np.resize(c, (size, size)))))


def ideal(frames: Any) -> Any:
    """Return the values at the nodes when the transforms work on floats, in both directions."""
    wide = Transform(0, 62, 50, 0, 62)
    nodes = Nodes()
    rows = dst_forward(row_order(frames), wide, nodes, "row_forward")
    modes = dst_forward(transpose(rows, False, True), wide, nodes, "column_forward")
    columns = dst_inverse(modes, wide, nodes, "column_inverse")
    dst_inverse(transpose(columns, True, False), wide, nodes, "row_inverse")
    nodes.values["column_inverse.modes"] = modes
    return nodes


def largest(nodes: Any, core: str) -> Any:
    return max(np.abs(values).max() for node, values in nodes.values.items() if node.startswith(core))


def laplacian(z: np.ndarray) -> Any:
    """Return the five-point Laplacian, zero half a pixel outside: a neighbour outside is the mirrored negative."""
    f = np.zeros_like(z)
    for axis in (-1, -2):
        first, last = np.take(z, [0], axis), np.take(z, [-1], axis)
        f += np.diff(np.concatenate((-first, z, -last), axis), n=2, axis=axis)
    return f


def saturations(z: np.ndarray, config: Configuration) -> Any:
    """Count saturations by node for depth fields in pixels, in the bit-accurate solver."""
    monitor = Monitor()
    f = np.rint(laplacian(z) / config.divergence.lsb).astype(np.int64)
    limit = 2 ** (config.divergence.width - 1)
    assert np.all((-limit <= f) & (f < limit)), "the field itself is steeper than the slope limit allows"
    spectral_solver(f, config, monitor)
    return monitor.saturations


SIZES = (16, 32, 64, 128, 256)
CHOICES = [
    {"columns": 16},
    {"columns": 32, "gradient_limit": 4.0},
    {"columns": 64, "data_width": 16, "coefficient_width": 10},
    {"columns": 64, "data_width": 32, "coefficient_width": 24, "gradient_limit": 0.5},
    {"columns": 128},
    {"columns": 128, "data_width": 20, "depth_range_px": 8.0},
    {"columns": 256, "data_width": 27},
]
each_choice = pytest.mark.parametrize("choices", CHOICES, ids=lambda c: "-".join(map(str, c.values())))


@pytest.mark.parametrize("size", SIZES)
def test_slopes_attain_their_bounds(size: Any) -> None:
    nodes = ideal(divergence(slope_patterns(size)))
    assert largest(nodes, "row_forward") == pytest.approx(bounds(size).row_forward, rel=1e-9)
    assert largest(nodes, "column_forward") == pytest.approx(bounds(size).column_forward, rel=1e-9)


@pytest.mark.parametrize("size", SIZES)
def test_depths_attain_their_bounds(size: int) -> None:
    nodes = ideal(depth_patterns(size))
    assert largest(nodes, "column_inverse") == pytest.approx(bounds(size).column_inverse, rel=1e-9)
    assert largest(nodes, "row_inverse") == pytest.approx(bounds(size).row_inverse, rel=1e-9)


@each_choice
def test_slopes_at_their_bounds_saturate_no_forward_node(choices: Any) -> None:
    """Attain the bounds over slopes: no forward node saturates. Depth may exceed its range, so later nodes do not
    count."""
    config = Configuration(**choices)
    slopes = slope_patterns(config.columns).astype(np.int64) * (2 ** (config.gradient.width - 1) - 1)
    monitor = Monitor()
    spectral_solver(divergence(slopes), config, monitor)
    forward = ("row_forward", "column_forward")
    assert not {node: n for node, n in monitor.saturations.items() if node.startswith(forward)}


@pytest.mark.parametrize(
    "choices",
    [
        {"columns": 16, "data_width": 20},
        {"columns": 32},
        {"columns": 64, "data_width": 32, "coefficient_width": 24},
        {"columns": 128, "data_width": 27, "depth_range_px": 12.0},
    ],
    ids=lambda c: "-".join(map(str, c.values())),
)
def test_depths_at_their_bounds_saturate_no_node(choices: Any) -> None:
    """Attain the bounds over depth: no node saturates. Only the widest slope limit allows such fields."""
    config = Configuration(gradient_limit=64.0, **choices)
    assert not saturations(config.depth_range_px * depth_patterns(config.columns), config)


def bump(config: Any, share: Any) -> Any:
    """Return the lowest mode, with a peak of this fraction of the depth range."""
    wave = np.sin(np.pi * (2 * np.arange(config.columns) + 1) / (2 * config.columns))
    return share * config.depth_range_px * np.outer(wave, wave) / wave.max() ** 2


@each_choice
def test_a_field_as_deep_as_the_range_saturates_nothing(choices: Any) -> None:
    config = Configuration(**choices)
    assert not saturations(bump(config, 1.0), config)
    assert not saturations(-bump(config, 0.99 * DEPTH_HEADROOM), config)


@each_choice
def test_a_field_deeper_than_the_code_saturates_the_output_alone(choices: Any) -> None:
    config = Configuration(**choices)
    assert set(saturations(bump(config, 1.05 * DEPTH_HEADROOM), config)) == {"row_inverse.output"}


@each_choice
@pytest.mark.parametrize("sign", [1, -1])
def test_a_field_of_over_twice_the_range_saturates(choices: Any, sign: Any) -> None:
    config = Configuration(**choices)
    assert saturations(sign * bump(config, 2.2), config)["row_inverse.output"] > 0


@given(st.floats(1e-3, 1e6), st.integers(10, 36))
def test_a_format_is_the_finest_that_holds_its_bound(bound: float, width: int) -> None:
    form = Format.holding(bound, width)
    assert bound <= form.limit - form.lsb
    assert form.limit / 2 < bound * (1 + 2.0 ** (2 - width)) * (1 + 1e-12)


LANES = {"solver": "tridiagonal"}


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"columns": 8}, "columns=8 .* 16 to 512"),
        ({"columns": 1024}, "columns=1024 .* 16 to 512"),
        ({"columns": 0}, "columns=0 "),
        ({"columns": 100}, "columns=100 is not a power of two: try columns=64 or columns=128"),
        ({"data_width": 11}, "data_width=11 .* 12 to 32"),
        ({"data_width": 33}, "data_width=33 .* 12 to 32"),
        ({"coefficient_width": 9}, "coefficient_width=9 .* 10 to 24"),
        ({"coefficient_width": 25}, "coefficient_width=25 .* 10 to 24"),
        ({"depth_range_px": 0.0}, "depth range of 0 pixels"),
        ({"depth_range_px": -1.0}, "depth range of -1 pixels"),
        ({"depth_range_px": float("nan")}, "depth range of nan pixels"),
        ({"depth_range_px": float("inf")}, "depth range of inf pixels"),
        ({"gradient_limit": 2.0**-7}, "largest slope"),
        ({"gradient_limit": 2.0**7}, "largest slope"),
        ({"gradient_limit": 0.0}, "largest slope"),
        ({"gradient_limit": float("nan")}, "largest slope"),
        (
            {"columns": 32, "data_width": 12, "depth_range_px": 200.0},
            "data_width=12 cannot hold .* try data_width=[0-9]+ or",
        ),
        ({"depth_range_px": 1e9}, "data_width=24 cannot hold .* a smaller depth range"),
        ({"lanes": 8}, "lanes=8 with solver=spectral.* set lanes=1, or solver=tridiagonal"),
        ({"lanes": 0}, "lanes=0 with solver=spectral"),
        (LANES | {"lanes": 0}, "lanes=0 with columns=128: accepted are 1 to 64"),
        (LANES | {"lanes": -2}, "lanes=-2 with columns=128: accepted are 1 to 64"),
        (LANES | {"lanes": 128}, "lanes=128 with columns=128: accepted are 1 to 64"),
        (
            LANES | {"lanes": 64, "zero_offset": True},
            "lanes=64 with columns=128 and zero_offset=True: accepted are 1 to 32",
        ),
        (LANES | {"lanes": 128, "columns": 512}, "lanes=128 with columns=512: accepted are 1 to 64"),
        (LANES | {"lanes": 6}, "lanes=6 is not a power of two: try lanes=4 or lanes=8"),
    ],
    ids=str,
)
def test_what_cannot_be_built_is_refused_in_one_line(choices: Any, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        Configuration(**choices)
    assert "\n" not in str(caught.value)


def test_the_width_that_an_error_asks_for_is_accepted() -> None:
    with pytest.raises(InputError) as caught:
        Configuration(columns=32, data_width=12, depth_range_px=200.0)
    wanted = int(re.search(r"try data_width=(\d+)", str(caught.value))[1])  # type: ignore[index]
    assert Configuration(columns=32, data_width=wanted, depth_range_px=200.0).data_width == wanted


# Declarations.


@pytest.mark.parametrize("argument", WORDS)
def test_few_files_name_a_word_length(argument: str) -> None:
    """A word length is declared once. What is about all of them loops over the declaration."""
    # Without its unit and with = it is an argument of another library.
    names = {name.replace("_mm", "") + "(?!=)" * ("_mm" in argument) for name in (argument, WORDS[argument].lower())}
    spelled = re.compile("|".join(name.replace("_", "_?") for name in names), re.IGNORECASE)
    paths = [path for folder in ("models", "commands") for path in (ROOT / folder).rglob("*.py")]
    assert 1 < sum(bool(spelled.search(path.read_text())) for path in paths) <= 12


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_has_a_row_and_an_argument(name: str) -> None:
    number = NUMBERS[name]
    names = f"`{number.variable}`, `{number.option.split()[0]}`, `{number.argument}`"
    assert f"| {names} |" in (ROOT / "docs/make-sim.md").read_text(), "run make figures"
    for value in number.accepted:
        given: dict[str, Any] = {"solver": "spectral", "boundary": "dirichlet", number.argument: value}
        assert getattr(td.Pipeline(td.load("synthetic"), grid=(32, 32), **given).config, name) == value
