# SPDX-License-Identifier: Apache-2.0
"""Properties of the models that hold for any input, for models whose own tests check none."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.fft import dctn, dstn
from scipy.linalg import solve_banded

from tactile_depth.chip import latency
from tactile_depth.chip.common.td_rom import rom
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.threshold_comparator import ThresholdComparator
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes, gradient_lookup
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.poisson.elimination import elimination
from tactile_depth.chip.poisson.frame_stack import frame_stack
from tactile_depth.chip.poisson.substitution import substitution
from tactile_depth.chip.poisson.thomas_table import thomas_table
from tactile_depth.chip.poisson.transform.orders import bit_reversed, eigenvalues, makhoul, mirror
from tactile_depth.chip.poisson.transform.row_pairs import mode_pairs
from tactile_depth.chip.poisson.transform.transpose import transpose
from tactile_depth.chip.poisson.transform.twiddle import phase_factors, twiddle_factors
from tactile_depth.chip.poisson.tridiagonal_solver import tridiagonal_solver
from tactile_depth.chip.registers.axil_port import Response, strobed_bits
from tactile_depth.chip.registers.axil_registers import AxilRegisters, Build, Events, Live
from tactile_depth.chip.registers.event_registers import COUNTERS
from tactile_depth.chip.registers.register_map import ADDRESS_WIDTH, MAP, REGISTERS, WORD
from tactile_depth.chip.rom_files import pack, write_words
from tactile_depth.chip.tactile_depth import solve, tactile_depth, top_parameters
from tactile_depth.chip.video.frame_guard import Word, frame_guard
from tactile_depth.depth import reference
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.synthetic import synthetic

SEED = st.integers(0, 2**32 - 1)
SIZE = st.sampled_from([8, 16, 32, 64])
WORDS = st.integers(0, 255)
SOLVED = {
    neumann: Configuration(columns=16, rows=12, solver="tridiagonal", neumann=neumann) for neumann in (False, True)
}
RELATIVE = 1e-4  # of the largest depth: 24-bit words and 18-bit coefficients on 16 columns


def noise(seed: int, *shape: Any, limit: int = 1 << 12) -> Any:
    return np.random.default_rng(seed).integers(-limit, limit + 1, shape)


# Orders.


@given(SIZE)
def test_orders_are_permutations(size: int) -> None:
    for order in (bit_reversed(size), makhoul(size), mirror(size)):
        assert sorted(order) == list(range(size))


def test_a_shared_table_cannot_be_changed() -> None:
    tables = (bit_reversed(16), makhoul(16), mirror(16), twiddle_factors(16, False, 18), phase_factors(16, True, 18))
    for table in tables:
        with pytest.raises(ValueError, match="read-only"):
            table[0] = 1


@given(SIZE, st.booleans())
def test_eigenvalues_are_those_of_the_second_difference(size: int, neumann: bool) -> None:
    middle = -2 * np.eye(size) + np.eye(size, k=1) + np.eye(size, k=-1)
    middle[0, 0] = middle[-1, -1] = -1 if neumann else -3
    np.testing.assert_allclose(np.sort(eigenvalues(size, neumann)), np.linalg.eigvalsh(middle), atol=1e-12)


@given(SEED, SIZE)
def test_modes_are_mirrored_both_ways(seed: int, size: int) -> None:
    modes = noise(seed, size)
    once, mirrored = mode_pairs(modes)
    np.testing.assert_array_equal(once, modes)
    np.testing.assert_array_equal(mode_pairs(mirrored)[1][1:], modes[1:])
    np.testing.assert_array_equal(mode_pairs(modes + mirrored)[1][1:], (modes + mirrored)[1:])  # a symmetric row


@given(SEED, SIZE, st.booleans(), st.booleans())
def test_transposing_back_gives_the_frame(seed: int, size: int, makhoul_in: Any, makhoul_out: Any) -> None:
    frames = noise(seed, 2, size, size)
    there = transpose(frames, makhoul_in, makhoul_out)
    np.testing.assert_array_equal(transpose(there, makhoul_out, makhoul_in), frames)


@given(SEED, st.integers(1, 9))
def test_a_stack_turned_twice_is_the_frame(seed: int, rows: int) -> None:
    frame = noise(seed, rows, 8)
    np.testing.assert_array_equal(frame_stack(frame)[0], frame[-1])
    np.testing.assert_array_equal(frame_stack(frame_stack(frame)), frame)


# Thomas's algorithm.


@settings(max_examples=30)
@given(st.sampled_from([16, 32]), st.integers(8, 60), st.booleans(), st.integers(10, 24))
def test_a_stored_coefficient_is_that_of_the_recurrence(columns: int, rows: int, neumann: bool, width: int) -> None:
    config = Configuration(
        columns=columns, rows=rows, solver="tridiagonal", neumann=neumann, coefficient_width=width, depth_range_px=4
    )
    table, diagonal = thomas_table(config), eigenvalues(columns, neumann) - 2
    c = 1 / (diagonal + (1 if neumann else -1))
    for row in table.rows(rows - 1):
        assert np.abs(row / 2.0 ** (width - 1) - c).max() <= 2.0 ** (1 - width)  # half a step; 1 clips to a step less
        c = 1 / (diagonal - c)


def down_and_up(f: np.ndarray, config: Configuration) -> Any:
    d = elimination(f, config)
    return frame_stack(substitution(frame_stack(d), config))


@settings(max_examples=30)
@given(SEED, st.booleans())
def test_elimination_and_substitution_solve_the_tridiagonal_systems(seed: int, neumann: bool) -> None:
    config = SOLVED[neumann]
    rows, columns = config.rows, config.columns
    # |z| is at most the sum of |f| over a column over the smallest pivot; stay well inside the word.
    f = noise(seed, rows, columns, limit=1 << (config.arithmetic_width - 14))
    f[:, 0] = 0  # the singular mode under Neumann has a test of its own
    z = down_and_up(f, config)
    for position, eigenvalue in enumerate(eigenvalues(columns, neumann)):
        bands = np.ones((3, rows))
        bands[1] = eigenvalue - 2
        bands[1, [0, -1]] += 1 if neumann else -1
        if position:
            want = solve_banded((1, 1), bands, f[:, position].astype(float))
            scale = max(np.abs(want).max(), 1)
            # Steps: a stored word drops 3 bits, and a pivot near the smallest eigenvalue enlarges what is dropped.
            assert np.abs(z[:, position] - want).max() <= RELATIVE * scale + 8 * rows


@settings(max_examples=30)
@given(SEED)
def test_the_singular_mode_has_no_mean(seed: int) -> None:
    config = SOLVED[True]
    f = np.zeros((config.rows, config.columns), np.int64)
    f[:, 0] = noise(seed, config.rows, limit=1 << 12)
    f[-1, 0] -= f[:, 0].sum()  # the sum of a divergence is zero
    z = down_and_up(f, config)[:, 0]
    # The mean is taken before the rows are stored: each then errs by up to half a word, and counts (i + 1) / rows.
    stored = 1 << (config.elimination.fraction - config.elimination_store.fraction)
    assert abs(z.mean()) <= RELATIVE * np.abs(z).max() + stored / 2 * (config.rows + 1) / 2 + stored


@settings(max_examples=30)
@given(SEED, st.booleans())
def test_negation_goes_through_elimination_and_substitution(seed: int, neumann: bool) -> None:
    config = SOLVED[neumann]
    f = noise(seed, config.rows, config.columns)
    np.testing.assert_array_equal(elimination(-f, config), -elimination(f, config))
    np.testing.assert_array_equal(substitution(-f, config), -substitution(f, config))


# The solvers.


def divergence_like(seed: int, config: Configuration) -> tuple[Any, ...]:
    """Return the divergence of a depth within a quarter of the range, which sums to zero under Neumann."""
    limit = config.depth_limit_px / 4
    depth = np.random.default_rng(seed).uniform(-limit, limit, (config.rows, config.columns))
    shift = np.pad(depth, 1, mode="edge")
    if not config.neumann:  # zero half a pixel outside: the pixel beyond the edge is minus the one inside
        shift[0], shift[-1], shift[:, 0], shift[:, -1] = -shift[0], -shift[-1], -shift[:, 0], -shift[:, -1]
    f = shift[2:, 1:-1] + shift[:-2, 1:-1] + shift[1:-1, 2:] + shift[1:-1, :-2] - 4 * depth
    return f, depth - depth.mean() if config.neumann else depth


CONFIGURATIONS = [
    Configuration(columns=16, solver=solver, neumann=neumann, gradient_limit=8.0)
    for solver in sorted(COLUMNS)
    for neumann in (False, True)
]


@settings(max_examples=20)
@given(SEED, st.sampled_from(CONFIGURATIONS))
def test_the_laplacian_of_a_depth_gives_it_back(seed: int, config: Configuration) -> None:
    f, depth = divergence_like(seed, config)
    np.testing.assert_allclose(reference.solve(f, config.neumann), depth, atol=1e-9)
    codes = np.rint(f / config.gradient_lsb).astype(np.int64)
    result = solve(codes, config) * config.depth_lsb_px
    result = result[::-1] if config.solver == "tridiagonal" else result
    assert np.abs(result - depth).max() <= 2e-4 * np.abs(depth).max()


@settings(max_examples=20)
@given(SEED, st.sampled_from(CONFIGURATIONS))
def test_solvers_agree_with_scipy_mode_by_mode(seed: int, config: Configuration) -> None:
    f, _ = divergence_like(seed, config)
    codes = np.rint(f / config.gradient_lsb).astype(np.int64)
    result = solve(codes, config) * config.depth_lsb_px
    result = result[::-1] if config.solver == "tridiagonal" else result
    transform = dctn if config.neumann else dstn
    want = transform(reference.solve(codes * config.gradient_lsb, config.neumann), type=2, norm="ortho")
    assert np.abs(transform(result, type=2, norm="ortho") - want).max() <= 1e-3 * np.abs(want).max()


@settings(max_examples=20)
@given(SEED, st.booleans())
def test_the_tridiagonal_solver_negates_and_mirrors(seed: int, neumann: bool) -> None:
    config = SOLVED[neumann]
    f = np.rint(divergence_like(seed, config)[0] / 8 / config.gradient_lsb).astype(np.int64)
    z = tridiagonal_solver(f, config)
    np.testing.assert_array_equal(tridiagonal_solver(-f, config), -z)
    assert np.abs(tridiagonal_solver(f[:, ::-1], config) - z[:, ::-1]).max() <= RELATIVE * (1 << config.data_width)


@settings(max_examples=20)
@given(SEED, SEED, st.booleans())
def test_sums_go_through_the_tridiagonal_solver(seed: int, other: Any, neumann: bool) -> None:
    config = SOLVED[neumann]
    f, g = (np.rint(divergence_like(s, config)[0] / 8 / config.gradient_lsb).astype(np.int64) for s in (seed, other))
    error = tridiagonal_solver(f + g, config) - tridiagonal_solver(f, config) - tridiagonal_solver(g, config)
    assert np.abs(error).max() <= RELATIVE * (1 << config.data_width)


@settings(max_examples=10)
@given(SEED, st.sampled_from(sorted(COLUMNS)), st.booleans())
def test_frames_of_a_sequence_do_not_mix(seed: int, solver: str, neumann: bool) -> None:
    config = Configuration(columns=16, solver=solver, neumann=neumann)
    frames = np.random.default_rng(seed).integers(100, 156, (3, 16, 16, 3)).astype(np.uint8)
    together = tactile_depth(frames, synthetic(), config)
    np.testing.assert_array_equal(together, [tactile_depth(frame, synthetic(), config) for frame in frames])


@given(st.sampled_from([16, 32, 64]), st.integers(8, 100), st.booleans())
def test_latency_counts_pixels_and_nothing_else(columns: int, rows: int, neumann: bool) -> None:
    tall = Configuration(columns=columns, rows=rows, solver="tridiagonal", neumann=neumann)
    square = Configuration(columns=columns, solver="tridiagonal", neumann=not neumann)
    after = latency.last_pixel_to_first_depth(tall)
    assert after == latency.last_pixel_to_first_depth(square)  # neither rows nor boundary count
    assert latency.first_depth_latency(tall) - after == rows * columns - 1
    assert after < 8 * columns + 64


# Tables and files.


@settings(max_examples=25)
@given(SEED, st.integers(1, 4), st.sampled_from([0.25, 1.0, 8.0]))
def test_a_looked_up_slope_is_that_of_the_table_within_half_a_step(seed: int, bits: int, largest: int) -> None:
    chance = np.random.default_rng(seed)
    table = chance.uniform(-0.9 * largest, 0.9 * largest, (1 << bits, 1 << bits, 1 << bits, 2))
    calibration = Sensor("any", table, 0.1)
    config = Configuration(columns=16, gradient_limit=calibration.gradient_limit, bits_per_channel=bits)
    frames = chance.integers(0, 256, (2, 5, 7, 3)).astype(np.uint8)
    result = gradient_lookup(frames, gradient_codes(calibration, config), bits) * config.gradient_lsb
    assert np.abs(result - reference.slopes(frames, calibration)).max() <= config.gradient_lsb / 2 * (1 + 1e-9)


@settings(max_examples=25)
@given(SEED, st.integers(1, 6), st.floats(0.01, 0.3), st.sampled_from(["<f8", ">f8", "<f4", "<f2"]), st.booleans())
def test_a_saved_calibration_is_loaded_as_it_was(
    tmp_path_factory: pytest.TempPathFactory, seed: int, bits: int, pitch: Any, dtype: Any, packed: Any
) -> None:
    table = np.random.default_rng(seed).uniform(-2, 2, (1 << bits, 1 << bits, 1 << bits, 2)).astype(dtype)
    path = tmp_path_factory.mktemp("calibration") / "mine.npz"
    camera = {"format_version": 2, "camera_size": (240, 320), "pixel_format": "rgb888", "black_level": 0.0}
    camera |= {"exposure_us": np.nan, "flat_field": False}
    (np.savez_compressed if packed else np.savez)(path, gradient=table, pixel_pitch_mm=pitch, maker="ours", **camera)  # type: ignore[arg-type]
    result = load(str(path))
    np.testing.assert_array_equal(result.gradient, table.astype(np.float64))
    assert result.pixel_pitch_mm == pitch
    assert result.bits_per_channel == bits
    assert result.gradient_limit / 2 < np.abs(table.astype(float)).max() * (1 + 2.0**-7)
    assert np.abs(table.astype(float)).max() < result.gradient_limit


@given(st.lists(st.tuples(*[st.integers(-(1 << 26), (1 << 26) - 1)] * 3), min_size=1))
def test_packed_fields_are_found_in_the_file(tmp_path_factory: pytest.TempPathFactory, rows: Any) -> None:
    path = tmp_path_factory.mktemp("td_rom") / "words.hex"
    words = pack(np.array(rows).T, 27)
    write_words(path, words, 81)
    read = [int(line, 16) for line in path.read_text().split()]
    assert rom(read, range(len(rows))) == words
    for row, word in zip(rows, read, strict=True):
        for place, value in enumerate(reversed(row)):
            assert (word >> 27 * place) % (1 << 27) == value % (1 << 27)


# Registers.


@given(st.sampled_from(MAP), st.integers(0, WORD))
def test_fields_of_any_word_pack_to_its_listed_bits(register: Any, word: Any) -> None:
    listed = sum(field.mask for field in register.fields)
    assert register.pack(**register.unpack(word)) == word & listed


REGISTER_BUILD = Build(top_parameters(Configuration(columns=16)))
ADDRESSES = st.one_of(st.sampled_from([r.offset for r in MAP]), st.integers(0, (1 << ADDRESS_WIDTH) - 1))
WORDS = st.one_of(st.integers(0, 7), st.integers(0, WORD))
WRITES = st.lists(st.tuples(ADDRESSES, WORDS, st.integers(0, 15), st.booleans()), max_size=20)


@given(WRITES)
def test_a_refused_write_changes_nothing_and_bytes_without_strobe_stay(writes: Any) -> None:
    registers = AxilRegisters(REGISTER_BUILD)
    for address, data, strobe, frame_start in writes:
        before, written = dict(registers.values), len(registers.table_writes)
        pending, bank = registers.banks.pending(registers.banks.bank), registers.banks.bank
        response = registers.write(address, data, strobe, Live(in_use=bank))
        changed = {name for name in before if registers.values[name] != before[name]}
        if response is Response.SLVERR:
            assert not changed
            assert len(registers.table_writes) == written
        for name in changed & {"THRESHOLD", "OFF_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE", "DARK_LEVEL", "TIMEOUT"}:
            assert (registers.values[name] ^ before[name]) & ~strobed_bits(strobe) == 0
            assert registers.read(REGISTERS[name].offset) == (registers.values[name], Response.OKAY)
        assert not changed & {register.name for register in MAP if not register.writable}
        if len(registers.table_writes) > written:
            table, index, _, _ = registers.table_writes[-1]
            assert not pending >> table & 1
            assert index < REGISTER_BUILD.table_sizes[table]
        registers.clock(Events(frame_start=frame_start))
        assert (
            registers.banks.bank == bank ^ pending * frame_start
        )  # what was pending before this clock, all of it at once


@given(st.lists(st.integers(0, 255), max_size=20), st.integers(0, WORD))
def test_counters_only_grow_and_stay_at_the_top(saturations: Any, start: Any) -> None:
    registers = AxilRegisters(REGISTER_BUILD)
    registers.values["SATURATIONS"] = start
    for count in saturations:
        registers.clock(Events(frozenset({"frame_in", "dark"}), count))
    registers.clock(Events())  # counters see events one cycle later
    assert registers.values["SATURATIONS"] == min(start + sum(saturations), WORD)
    assert registers.values["FRAMES_IN"] == registers.values["DARK_PIXELS"] == len(saturations)
    registers.write(REGISTERS["CONTROL"].offset, 2)
    assert not any(registers.values[name] for name in COUNTERS)


# Streams.


HEIGHT, WIDTH = 2, 3
GOOD = [Word(100 + i, int(i % WIDTH == WIDTH - 1), int(i == 0)) for i in range(HEIGHT * WIDTH)]
ANY_WORD = st.builds(Word, WORDS, st.integers(0, 1), st.integers(0, 1))


@given(st.lists(st.none() | ANY_WORD, max_size=40), st.sampled_from([0, 1, 3]))
def test_whatever_arrives_whole_frames_leave_and_the_next_good_one_is_right(stream: Any, timeout: int) -> None:
    result = frame_guard([*stream, *GOOD], HEIGHT, WIDTH, timeout)
    words = [*stream, *GOOD]
    assert not result.open
    for frame in result.frames:
        assert len(frame.pixels) == HEIGHT * WIDTH
        if not frame.bad:
            assert frame.pixels == tuple(word.data for word in words[frame.first : frame.last + 1] if word is not None)
    assert result.frames[-1].pixels == tuple(word.data for word in GOOD)
    assert not result.frames[-1].bad
    # A broken frame has one fault; the others are of words between frames.
    assert sum(frame.bad for frame in result.frames) == sum(name != "start_missing" for name in result.faults)


@given(st.lists(st.lists(st.integers(-50, 50), min_size=1, max_size=6), min_size=1, max_size=6), st.integers(-60, 60))
def test_contact_is_that_some_depth_of_the_frame_so_far_is_above(frames: Any, threshold: Any) -> None:
    comparator, held, ever = ThresholdComparator(), ThresholdComparator(), False
    for frame in frames:
        for index, data in enumerate(frame):
            # The register changes inside the frame: only its first beat counts.
            for one, hold in ((comparator, False), (held, True)):
                one.beat(data, index == 0, threshold if index == 0 else -threshold, hold)
            ever |= data > threshold
            assert comparator.contact == any(depth > threshold for depth in frame[: index + 1])
            assert held.contact == ever
