# SPDX-License-Identifier: Apache-2.0
"""Monitor of a stream with several words per cycle."""

from typing import Any

from tb.pins import Read, signed
from tb.stream import StreamMonitor


class BeatMonitor(StreamMonitor):
    """StreamMonitor of one stream whose words are tuples, one element per lane, the first in the lowest bits."""

    def __init__(self, dut: Any, name: str, length: int, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(dut, name, "start", ["data"], length)

    def reads(self) -> tuple[Read, Read | None, list[Read]]:
        start, begins_frame, _ = super().reads()
        return start, begins_frame, [signed(self.bus.data, lane, self.lanes) for lane in range(self.lanes)]
