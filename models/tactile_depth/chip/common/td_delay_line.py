# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_delay_line.sv: a delay of the stream."""

from __future__ import annotations

from collections.abc import Sequence


def delay_line(words: Sequence[int], delay: int) -> list[int | None]:
    """Return the output in each cycle of `words`; None (unknown) before the first word leaves."""
    return [None] * min(delay, len(words)) + list(words[: max(len(words) - delay, 0)])
