# SPDX-License-Identifier: Apache-2.0
"""Monitor of a stream with several words per cycle."""

from typing import Any

from tb.stream import StreamMonitor


class LanePin:
    """Part of a pin that is one word of a beat."""

    def __init__(self, handle: Any, lane: int, lanes: int) -> None:
        self.handle, width = handle, len(handle) // lanes
        self.bits = (lane + 1) * width - 1, lane * width

    @property
    def value(self) -> Any:
        high, low = self.bits
        return self.handle.value[high:low]


class BeatMonitor(StreamMonitor):
    """StreamMonitor of one stream whose words are tuples, one element per lane, the first in the lowest bits."""

    def __init__(self, dut: Any, name: str, length: int, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(dut, name, "start", ["data"], length)

    def pins(self) -> tuple[Any, Any, Any]:
        words = [(LanePin(self.bus.data, lane, self.lanes), False) for lane in range(self.lanes)]
        return self.bus.start, self.frame_pin, words
