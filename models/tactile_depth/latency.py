# SPDX-License-Identifier: Apache-2.0
"""Latencies in cycles: of each core, from the first word of a burst in to the first word out, and of the pipeline."""

from __future__ import annotations

from tactile_depth.camera_configuration import CameraConfiguration
from tactile_depth.common import td_node_map
from tactile_depth.configuration import Configuration
from tactile_depth.poisson.transform.sdf_fft import twiddle_stages

MEMORY_READ = 1
MULTIPLY = 1
DOT_PRODUCT = 4
BUTTERFLY = 2  # without its delay line
TWIDDLE_MULTIPLY = 7
SIGN = 2  # sign and rounding
SPECTRAL_DIVIDE = 6
ROW_REORDER = 2  # from the last word of a row
CORNER_TURN = 3  # from the last word of a row
TRANSPOSE = 2  # from the first word of the last row
DIVERGENCE = 2
GRADIENT_LOOKUP = 4
FLAT_FIELD = td_node_map.latency(1, 1) + 3
QUADRATIC_GRADIENT = 11
FRAME_GUARD = 1
AXIS_SKID = 1
THOMAS_TABLE = 5
FORWARD_ELIMINATION = 9
FRAME_STACK = 3  # from the first word of the last row
BACK_SUBSTITUTION = 8
ROW_SUMS = 3
BLOCK_TOTALS = 3
ROUND_DIVIDE = 10
GAINS = 2
AREA_AVERAGE = ROW_SUMS + BLOCK_TOTALS + GAINS + ROUND_DIVIDE
BLACK_LEVEL = 1
CAMERA_WINDOW = 1
CONTACT = 1  # from the depth value that raises contact


def sdf_fft_latency(size: int) -> int:
    """Return the latency of sdf_fft; the delay lines of all butterflies add up to size - 1."""
    return size - 1 + (size.bit_length() - 1) * BUTTERFLY + twiddle_stages(size) * TWIDDLE_MULTIPLY


def dst_forward_latency(size: int) -> int:
    """Return the latency of dst_forward: read of the memory at its input, sign, FFT, phase."""
    return MEMORY_READ + SIGN + sdf_fft_latency(size) + TWIDDLE_MULTIPLY


def mode_pairs_latency(size: int) -> int:
    """Return the latency of mode_pairs: half a burst, the position of the mirrored mode, and the memory read."""
    return size // 2 + 2


def dst_inverse_latency(size: int) -> int:
    """Return the latency of dst_inverse: pairs, phase, FFT, sign."""
    return mode_pairs_latency(size) + TWIDDLE_MULTIPLY + sdf_fft_latency(size) + SIGN


def spectral_solver_latency(size: int) -> int:
    """Return the cycles from the last divergence word of a frame to its first depth, for any gaps in the frame."""
    first_transform = ROW_REORDER + dst_forward_latency(size)
    # The last column comes size - 1 bursts after the first and is the last row of the second transpose.
    columns = TRANSPOSE + dst_forward_latency(size) + SPECTRAL_DIVIDE + dst_inverse_latency(size)
    columns += size * (size - 1)
    rows = TRANSPOSE + dst_inverse_latency(size) + size - 1 + ROW_REORDER
    return first_transform + columns + rows


def tridiagonal_solver_latency(size: int, lanes: int = 1) -> int:
    """Return the cycles from the last divergence word of a frame to its first depth, for any gaps; rows of `size`."""
    down = ROW_REORDER + dst_forward_latency(size) + FORWARD_ELIMINATION
    up = FRAME_STACK + BACK_SUBSTITUTION + dst_inverse_latency(size) + size - 1
    return down + up + (ROW_REORDER if lanes == 1 else CORNER_TURN)


def zero_offset_latency(lanes: int, block_log2: int) -> int:
    """Return the latency of zero_offset: td_node_map and the subtraction."""
    return td_node_map.latency(lanes, block_log2) + 1


def pixel_format_latency(camera: CameraConfiguration) -> int:
    """Return the latency of pixel_format; YUYV: of the second pixel of a pair, one more than of its first."""
    return 4 if camera.format.is_yuyv else 1


def camera_front_end_latency(camera: CameraConfiguration) -> int:
    """Return the cycles from the camera's `last_word` to the last pixel of the grid, for any gaps."""
    x, _, width, _ = camera.crop
    first_of_pair = camera.format.is_yuyv and (x + width) % 2 == 1
    cores = CAMERA_WINDOW + pixel_format_latency(camera) - first_of_pair + BLACK_LEVEL + AREA_AVERAGE
    return AXIS_SKID + cores + AXIS_SKID


def last_word_to_first_depth(camera: CameraConfiguration, config: Configuration) -> int:
    """Return the cycles from the camera's `last_word` to the first depth, for any gaps and blanking."""
    return camera_front_end_latency(camera) + last_pixel_to_first_depth(config)


def frame_latency(config: Configuration) -> int:
    """Return the cycles from the last pixel of a frame out of the guard to its first depth out of the solver."""
    if config.solver == "tridiagonal":
        solver = tridiagonal_solver_latency(config.columns, config.lanes)
    else:
        solver = spectral_solver_latency(config.columns)
    colour = FLAT_FIELD if config.flat_field else 0
    slope = QUADRATIC_GRADIENT if config.gradient_model == "quadratic" else GRADIENT_LOOKUP
    return colour + slope + DIVERGENCE + solver


def last_pixel_to_first_depth(config: Configuration) -> int:
    """Return the cycles of the pipeline from the last pixel of a frame to its first depth, for any gaps."""
    return AXIS_SKID + FRAME_GUARD + frame_latency(config) + zero_latency(config) + AXIS_SKID


def zero_latency(config: Configuration) -> int:
    """Return the cycles that the zero offset takes."""
    return zero_offset_latency(config.lanes, config.reference_block_log2) if config.zero_offset else 0


def last_pixel_to_last_depth(config: Configuration) -> int:
    """Return the cycles of the pipeline from the last pixel of a frame to its last depth, for any gaps."""
    return last_pixel_to_first_depth(config) + beats(config) - 1


def beats(config: Configuration) -> int:
    """Return the clocks in which a frame of depth leaves."""
    return config.rows * config.columns // config.lanes


def first_depth_latency(config: Configuration) -> int:
    """Return the cycles of the pipeline from the first pixel of a frame without gaps to its first depth."""
    return config.rows * config.columns - 1 + last_pixel_to_first_depth(config)
