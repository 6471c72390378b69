# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/cobs_encode.sv."""

from __future__ import annotations

from tactile_depth.chip.link.framing import DELIMITER, RUN


class CobsEncode:
    """State of the encoder between two clock edges.

    Parameters
    ----------
    run : int
        Bytes of the longest piece.
    """

    def __init__(self, run: int = RUN) -> None:
        self._run = run
        self.reset()

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self._piece = b""  # that is collected
        self._line = b""  # bytes of a whole piece that have not left
        self._begun = False

    def clock(
        self, *, rst: int = 0, in_valid: int = 0, in_data: int = 0, in_last: int = 0, out_ready: int = 1
    ) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        out: dict[str, int] = {"in_ready": not self._line, "out_valid": bool(self._line)}
        if self._line:
            out["out_data"] = self._line[0]
            self._line = self._line[out_ready:]
        elif in_valid:
            self._piece += bytes((in_data,)) if in_data else b""
            if not in_data or in_last or len(self._piece) == self._run:
                piece, empty = bytes((len(self._piece) + 1,)) + self._piece, b"" if in_data else b"\1"
                self._line = (b"" if self._begun else DELIMITER) + piece + (empty + DELIMITER if in_last else b"")
                self._piece, self._begun = b"", not in_last
        if rst:
            self.reset()
        return out
