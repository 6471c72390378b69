# SPDX-License-Identifier: Apache-2.0
"""packet_mux against its model in every cycle: packets on all streams, stalls, resets."""

import random
from collections.abc import Callable, Iterator
from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.link.packet_mux import DEPTH, RECORD, SOURCES, PacketMux
from tb.cases import on_bench
from tb.link.byte_packets import STREAMS, Bench, random_packet, words
from tb.link.byte_packets import packets as packets_of
from tb.stream import MANY, at_every_edge, drive, parametrize
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
MUTANTS = Mutants(repeats=2)
PROOFS = (
    Proof(
        FULL_WIDTH,
    ),
)


PINS = [f"{name}_{pin}" for pin in ("valid", "data", "last") for name in SOURCES]
OUTPUTS = ["out_valid", "out_data", "out_last", *(f"{name}_ready" for name in SOURCES)]


def step(model: PacketMux, pin: Callable[[str], Any]) -> None:
    """Compare the outputs of a clock with the model, and advance it; `pin` returns the value of a pin."""
    valid, last = ([bool(pin(f"{name}_{of}")) for name in SOURCES] for of in ("valid", "last"))
    chosen, out_ready = model.chosen, bool(pin("out_ready"))
    offered = chosen is not None and valid[chosen]
    assert bool(pin("out_valid")) == offered, f"out_valid with {valid}, chosen {chosen}"
    ready = [bool(pin(f"{name}_ready")) for name in SOURCES]
    assert ready == [source == chosen and out_ready for source in range(len(SOURCES))], f"ready, chosen {chosen}"
    if offered and chosen is not None:
        assert int(pin("out_data")) == int(pin(f"{SOURCES[chosen]}_data")), f"data of {SOURCES[chosen]}"
        assert bool(pin("out_last")) == last[chosen], f"last of {SOURCES[chosen]}"
    if pin("rst"):
        model.reset()
    else:
        model.clock(valid, last, out_ready)


def follow(dut: Any) -> Iterator[None]:
    """Compare every output with the model, which is fed from the pins."""
    model, pins = PacketMux(), {name: getattr(dut, name) for name in ("rst", "out_ready", *PINS, *OUTPUTS)}
    while True:
        yield
        step(model, lambda name: pins[name].value)


class MuxBench(Bench):
    """Bench of four streams, compared with the model in every cycle."""

    def __init__(self, dut: Any, offers: str = "none", accepts: str = "none") -> None:
        super().__init__(dut, offers, accepts, SOURCES)

    async def start(self) -> None:
        await super().start()
        at_every_edge(self.dut.clk, follow(self.dut))

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
@parametrize((("offers", "accepts"), STREAMS), ("apart", [False, True]))
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


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def any_pins(dut: Any) -> None:
    """Drive all pins at random, last without valid too: every output is as in the model."""
    rng = random.Random(cocotb.RANDOM_SEED)

    def pins(reset: int) -> dict[str, int]:
        often = {name: int(rng.random() < 0.7) for name in ("out_ready", *PINS[: len(SOURCES)])}
        data = {f"{name}_data": rng.getrandbits(8) for name in SOURCES}
        return {"rst": reset, **often, **data, **{f"{name}_last": int(rng.random() < 0.4) for name in SOURCES}}

    inputs = [pins(1), *(pins(int(rng.random() < 0.01)) for _ in range(400))]
    seen, model = await drive(dut, inputs, OUTPUTS), PacketMux()
    for clock in range(1, len(inputs)):
        step(model, lambda name, at=clock: seen[name][at])  # type: ignore[misc]
