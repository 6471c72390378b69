# SPDX-License-Identifier: Apache-2.0
"""row_reorder against its model: the tests that it shares with wide_rows."""

from tb.poisson.transform.row_bench import a_frame_begins_afresh, reset_in_mid_row, rows

__all__ = ["a_frame_begins_afresh", "reset_in_mid_row", "rows"]
