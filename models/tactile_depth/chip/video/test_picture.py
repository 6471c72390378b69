# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/video/test_picture.sv, and its picture."""

from __future__ import annotations

import numpy as np

SEED = 0x4F5CCF
"""First pixel. Of 6,000 the one whose picture of 96 x 128 hides least of the coefficients of the last row."""
TAPS, LEAP, WORD = (0, 1, 2, 7), 12, 0xFF_FFFF


def next_state(state: int) -> int:
    """Return the pixel {R, B, G} behind one of the picture: a feedback register of 24 bits, `LEAP` steps on."""
    new = 0
    for tap in TAPS:
        new ^= state >> LEAP - tap
    return (state << LEAP | new & (1 << LEAP) - 1) & WORD


def picture(rows: int, columns: int) -> np.ndarray:
    """Return the picture, uint8 (rows, columns, 3), RGB."""
    states = np.empty(rows * columns, np.int64)
    state = SEED
    for pixel in range(len(states)):
        states[pixel], state = state, next_state(state)
    return np.stack([states >> 16, states, states >> 8], axis=-1).astype(np.uint8).reshape(rows, columns, 3)


class Picture:
    """State of the core: a picture is waited for, it has begun, and its pixel."""

    def __init__(self) -> None:
        self._clear()

    def _clear(self) -> None:
        self.waiting = self.begun = False
        self.state = SEED

    def clock(
        self, *, rst: int, request: int, between: int, row_ends: int, frame_ends: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        test = self.waiting and (self.begun or bool(between))
        out: dict[str, int | None] = {
            "m_test": test,
            "s_ready": pins["m_ready"] and not test,
            "m_valid": test or pins["s_valid"],
        }
        if test:
            out |= {"m_data": self.state, "m_last": row_ends, "m_user": not self.begun}
        elif pins["s_valid"]:
            out |= {f"m_{name}": pins[f"s_{name}"] for name in ("data", "last", "user")}
        if test and pins["m_ready"]:
            self.begun, self.waiting = not frame_ends, not frame_ends
            self.state = SEED if frame_ends else next_state(self.state)
        self.waiting |= bool(request)
        if rst:
            self._clear()
        return out
