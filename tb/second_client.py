# SPDX-License-Identifier: Apache-2.0
"""Client of the AXI ports by cocotbext-axi, which shares no code with tb/axis.py and cocotb-bus.

Its classes have the methods that tb/tactile_depth/bench.py calls.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

from tactile_depth.chip.registers.axil_port import BYTES, Response
from tactile_depth.chip.video.frame_guard import Word


class SecondSource:
    """Source that sends rows as packets; in a row None is a cycle of pause."""

    def __init__(self, dut: Any, offers: Iterable[bool]) -> None:
        self.dut, self.offers, self.held = dut, iter(offers), False
        self.taking: Any = None
        self.source = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis"), dut.clk, dut.rst, byte_lanes=1)
        self.source.log.setLevel("WARNING")
        self.source.set_pause_generator(self.pauses())

    def pauses(self) -> Iterator[Any]:
        while True:
            yield self.held or not next(self.offers)

    def abort(self) -> None:
        self.source.clear()
        if self.taking:
            self.taking.cancel()
        self.held = False
        self.taking = None

    async def send(self, words: Sequence[Word | None]) -> None:
        silences: dict[Any, Any] = {}
        packet = []
        sent = 0
        for word in words:
            if word is None:
                silences[sent] = silences.get(sent, 0) + 1
                continue
            packet.append(word)
            sent += 1
            if word.last:
                frame = AxiStreamFrame(tdata=[w.data for w in packet], tuser=[w.user for w in packet])
                self.source.send_nowait(frame)
                packet = []
        assert not packet, "this client sends whole rows only: the words end without tlast"
        self.taking = cocotb.start_soon(self.take(silences, sent))
        await self.taking

    async def take(self, silences: dict[int, int], sent: int) -> None:
        """Wait until all words are taken; pause at each None."""
        dut, edge, taken = self.dut, RisingEdge(self.dut.clk), 0
        while taken < sent:
            self.held = taken + 1 in silences  # the word on the pins is the last one before the pause
            await edge
            if dut.s_axis_tvalid.value and dut.s_axis_tready.value:
                taken += 1
                if taken in silences:
                    for _ in range(silences[taken] - 1):  # the decision takes effect one cycle later
                        await edge
                    self.held = False


class SecondSink:
    """Sink that takes packets and pauses by a profile."""

    def __init__(self, dut: Any, accepts: Iterable[bool]) -> None:
        self.sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1)
        self.sink.log.setLevel("WARNING")
        self.stall(accepts)

    def stall(self, accepts: Iterable[bool]) -> None:
        self.sink.set_pause_generator(not accept for accept in accepts)

    def words(self) -> list[Word]:
        """Return the words taken since the last call."""
        out: list[Any] = []
        while not self.sink.empty():
            frame = self.sink.recv_nowait(compact=False)
            last = [0] * (len(frame.tdata) - 1) + [1]
            out += map(Word, frame.tdata, last, frame.tuser)
        return out


class SecondMaster:
    """Master that reads and writes registers."""

    def __init__(self, dut: Any) -> None:
        self.master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
        for side in (self.master.write_if, self.master.read_if):
            side.log.setLevel("WARNING")

    async def write(self, address: int, value: int) -> Response:
        return Response(int((await self.master.write(address, value.to_bytes(BYTES, "little"))).resp))

    async def read(self, address: int) -> int:
        answer = await self.master.read(address, BYTES)
        assert int(answer.resp) == Response.OKAY
        return int.from_bytes(answer.data, "little")
