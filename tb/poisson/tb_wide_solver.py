# SPDX-License-Identifier: Apache-2.0
"""wide_solver against its model: the tests that it shares with tridiagonal_solver."""

from tb.poisson.solver_bench import (
    a_frame_begins_afresh,
    a_frame_does_not_know_the_one_before,
    frames,
    full_scale_saturates,
    many_frames,
    reset_in_mid_frame,
)

__all__ = [
    "a_frame_begins_afresh",
    "a_frame_does_not_know_the_one_before",
    "frames",
    "full_scale_saturates",
    "many_frames",
    "reset_in_mid_frame",
]
