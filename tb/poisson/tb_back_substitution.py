# SPDX-License-Identifier: Apache-2.0
"""back_substitution against its model: the tests that it shares with forward_elimination."""

from tb.poisson.elimination_bench import a_frame_begins_afresh, frames, many_frames, reset_in_mid_frame

__all__ = ["a_frame_begins_afresh", "frames", "many_frames", "reset_in_mid_frame"]
