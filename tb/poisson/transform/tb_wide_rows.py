# SPDX-License-Identifier: Apache-2.0
"""wide_rows against its model: the tests that it shares with row_reorder."""

from tb.poisson.transform.row_bench import a_frame_begins_afresh, reset_in_mid_row, rows

__all__ = ["a_frame_begins_afresh", "reset_in_mid_row", "rows"]
