# SPDX-License-Identifier: Apache-2.0
"""packet_mux against its model in every cycle: packets on all streams, stalls, resets."""

import random
from collections.abc import Iterator
from typing import Any

import cocotb

from tactile_depth.link.packet_mux import DEPTH, RECORD, SOURCES, PacketMux
from tb.cases import on_bench
from tb.link.byte_packets import STREAMS, Bench, random_packet, words
from tb.link.byte_packets import packets as packets_of
from tb.stream import MANY, at_every_edge


def follow(bench: Bench) -> Iterator[None]:
    """Compare every output with the model, which is fed from the pins; keep the sources in the order of packets."""
    dut, model = bench.dut, PacketMux()
    pins = [[getattr(dut, f"{name}_{pin}") for name in SOURCES] for pin in ("valid", "ready", "data", "last")]
    while True:
        yield
        valid, ready, data, last = ([int(pin.value) for pin in row] for row in pins)
        chosen, out_ready = model.chosen, int(dut.out_ready.value)
        offered = chosen is not None and bool(valid[chosen])
        assert bool(dut.out_valid.value) == offered, f"out_valid with {valid}, chosen {chosen}"
        assert ready == [int(source == chosen and out_ready) for source in range(4)], f"ready, chosen {chosen}"
        if offered and chosen is not None:
            assert int(dut.out_data.value) == data[chosen], f"data of {SOURCES[chosen]}"
            assert int(dut.out_last.value) == last[chosen], f"last of {SOURCES[chosen]}"
        if dut.rst.value:
            model.reset()
        else:
            model.clock([bool(one) for one in valid], [bool(one) for one in last], bool(out_ready))


class MuxBench(Bench):
    """Bench of four streams, compared with the model in every cycle."""

    def __init__(self, dut: Any, offers: str = "none", accepts: str = "none") -> None:
        super().__init__(dut, offers, accepts, SOURCES)

    async def start(self) -> None:
        await super().start()
        at_every_edge(self.dut.clk, follow(self))

    async def deliver(self, sent: dict[str, list[bytes]], apart: bool) -> list[bytes]:
        """Send packets on all streams, with idle cycles between them if `apart`; return them as they left."""
        rng = random.Random(cocotb.RANDOM_SEED)
        total = sum(len(packet) for ones in sent.values() for packet in ones)
        for name, ones in sent.items():
            gaps = [rng.choice([0, 0, 1, 10, 60]) if apart else 0 for _ in ones]
            stream = [word for gap, one in zip(gaps, ones, strict=True) for word in (*[None] * gap, *words(one))]
            cocotb.start_soon(self.sources[name].send(stream))
        await self.until_left(total)
        return packets_of(self.left.words)


def numbered(bench: Bench, count: int) -> dict[str, list[bytes]]:
    """Return packets for all streams; the first byte tells the stream."""
    return {
        name: [bytes([source]) + random_packet(bench.random, 6) for _ in range(count)]
        for source, name in enumerate(SOURCES)
    }


@on_bench(MuxBench)
@cocotb.parametrize((("offers", "accepts"), STREAMS), apart=[False, True])
async def packets(bench: MuxBench, apart: bool) -> None:
    """Send packets on all streams: each stream's leave whole and in order."""
    sent = numbered(bench, 4 * MANY)
    left = await bench.deliver(sent, apart)
    for source, name in enumerate(SOURCES):
        assert [packet for packet in left if packet[0] == source] == sent[name], name


@on_bench(MuxBench)
async def order(bench: MuxBench) -> None:
    """Offer everything at once: status and replies go first, then records and depth in turn."""
    left = await bench.deliver(numbered(bench, 5), apart=False)
    assert [packet[0] for packet in left] == [0] * 5 + [1] * 5 + [RECORD, DEPTH] * 5


@on_bench(MuxBench)
async def resets(bench: MuxBench) -> None:
    """Reset in every phase: a new packet begins behind it, and a record goes before depth again."""
    sent = {"record": [b"\2\1"] * 4, "depth": [b"\3\2\1"] * 4}
    for phase in range(1, 16):
        for name, ones in sent.items():
            cocotb.start_soon(bench.sources[name].send([word for one in ones for word in words(one)]))
        await bench.clocks(phase)
        await bench.reset()
        left = await bench.deliver({"record": [b"\2\7"], "depth": [b"\3\7\1"]}, apart=False)
        assert left == [b"\2\7", b"\3\7\1"]
        await bench.reset()
