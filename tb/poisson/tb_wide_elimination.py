# SPDX-License-Identifier: Apache-2.0
"""wide_elimination against its model: the tests that it shares with the other eliminations."""

from tb.poisson.elimination_bench import (
    a_frame_begins_afresh,
    frames,
    many_frames,
    reset_as_the_mean_is_clipped,
    reset_in_mid_frame,
)

__all__ = ["a_frame_begins_afresh", "frames", "many_frames", "reset_as_the_mean_is_clipped", "reset_in_mid_frame"]
