# SPDX-License-Identifier: Apache-2.0
"""cobs_encode against the bytes that the host's framing puts on the line; runs of every length, stalls, resets."""

import random
from collections.abc import Iterable

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.framing import DELIMITER, RUN, cobs_encode
from tb.cases import on_bench
from tb.link.byte_packets import BYTE, STREAMS, Bench, random_packet, words
from tb.stream import MANY, REGRESS, parameters, parametrize
from tb.structures import BOTH, ICARUS, Mutants, of_parameters

built = of_parameters("Run")
STRUCTURES = (
    built(254, on=BOTH),
    built(3, on=ICARUS, mutants=ICARUS),
    built(2),
)
PROTOCOL = {"counts": "live & ~reset", "out_data": "counts & out_valid"}
MUTANTS = Mutants(repeats=2)
PROOFS = tuple(
    Proof(
        "the length of a run is only counted; an arbitrary byte is followed",
        {"Run": run},
    )
    for run in (2, 3)
)


def on_line(packet: bytes, run: int) -> bytes:
    """Return the bytes on the line of a packet; with shorter runs than those of COBS, by the rules of the page."""
    if run == RUN:
        return DELIMITER + cobs_encode(packet) + DELIMITER
    out, rest = b"", packet + DELIMITER
    while rest:
        length = min(rest.index(0), run)
        out += bytes([length + 1]) + rest[:length]
        rest = rest[length:] if length == run else rest[length + 1 :]
        if rest == DELIMITER and length == run:
            break
    return DELIMITER + out + DELIMITER


def cases(run: int) -> list[bytes]:
    """Return packets whose runs end at each place that matters, with zeros before and behind them."""
    lengths = sorted({0, 1, 2, run - 2, run - 1, run, run + 1, 2 * run - 1, 2 * run, 2 * run + 1})
    runs = [bytes(place % 255 + 1 for place in range(length)) for length in lengths if length >= 0]
    edges = [(b"", b""), (b"\0", b""), (b"", b"\0"), (b"\0\0", b"\0\0"), (b"", b"\0\x80")]
    return [packet for one in runs for before, behind in edges if (packet := before + one + behind)]


async def check(bench: Bench, sent: Iterable[bytes]) -> None:
    """Send packets; the line has theirs, one behind the other."""
    (run,) = parameters(bench.dut, "Run")
    expected = b"".join(on_line(packet, run) for packet in sent)
    cocotb.start_soon(bench.sources["in"].send([word for packet in sent for word in words(packet)]))
    await bench.until_left(len(expected))
    assert bytes(byte for (byte,) in bench.left.words) == expected


@on_bench(Bench, milliseconds=20, out_fields=BYTE)
@parametrize((("offers", "accepts"), STREAMS))
async def packets(bench: Bench, offers: str, accepts: str) -> None:
    """Send packets at the limits of a run, and random ones; long runs are shared out over the streams."""
    (run,) = parameters(bench.dut, "Run")
    sent = cases(run) + [random_packet(bench.random, 3 * run) for _ in range(3 * MANY)]
    random.Random(f"{offers} {accepts}").shuffle(sent)
    await check(bench, sent[:16] if run == RUN and not REGRESS else sent)


@on_bench(Bench, milliseconds=20, out_fields=BYTE)
async def time_of_a_piece(bench: Bench) -> None:
    """Send a piece of every length without a stall: it takes one cycle a byte in, then one a byte out."""
    (run,) = parameters(bench.dut, "Run")
    for length in sorted({1, 2, run - 1, run}):
        bench.left.forget()
        bench.taken["in"].forget()
        await check(bench, [bytes([1] * length)])
        first = bench.taken["in"].taken[-1] + 1
        assert bench.left.taken == list(range(first, first + length + 3))


@on_bench(Bench, milliseconds=20, out_fields=BYTE)
@parametrize(accepts=["none", "alternate"])
async def resets(bench: Bench) -> None:
    """Reset in every phase of a packet: nothing of it is left, and the next one is right."""
    packet = b"\1\2\0\3\0"
    for phase in range(1, 26):
        cocotb.start_soon(bench.sources["in"].send(words(packet)))
        await bench.clocks(phase)
        await bench.reset()
        await check(bench, [packet, b"\7"])
