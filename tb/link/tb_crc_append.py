# SPDX-License-Identifier: Apache-2.0
"""crc_append against zlib's CRC-32: packets of every kind of length, stalls, resets."""

import zlib
from collections.abc import Sequence

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.link.framing import CRC_BYTES
from tb.cases import on_bench
from tb.link.byte_packets import STREAMS, Bench, random_packet, words
from tb.stream import MANY, parametrize
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"stays": "in_", "counts": "live & ~reset", "out_data out_last": "counts & out_valid"}
MUTANTS = Mutants(repeats=2)
PROOFS = (
    Proof(
        FULL_WIDTH,
        steps=2,
    ),
)


def with_crc(packet: bytes) -> bytes:
    return packet + zlib.crc32(packet).to_bytes(CRC_BYTES, "little")


async def check(bench: Bench, sent: Sequence[bytes]) -> None:
    """Send packets; each leaves with its CRC, and last with the last byte alone."""
    expected = [word for packet in sent for word in words(with_crc(packet))]
    cocotb.start_soon(bench.sources["in"].send([word for packet in sent for word in words(packet)]))
    await bench.until_left(len(expected))
    assert bench.left.words == expected


@on_bench(Bench, milliseconds=2)
@parametrize((("offers", "accepts"), STREAMS))
async def packets(bench: Bench) -> None:
    """Send the text that defines the CRC, short packets, and random ones."""
    sent = [b"123456789", b"\0", b"\0\0\0\0", b"\xff" * 4]
    await check(bench, sent + [random_packet(bench.random, 20) for _ in range(4 * MANY)])
    assert with_crc(sent[0])[-4:] == bytes.fromhex("26 39 f4 cb")


@on_bench(Bench)
async def time(bench: Bench) -> None:
    """Send without a stall: a byte leaves in the cycle in which it comes, the CRC in the four behind the last."""
    sent = [random_packet(bench.random, 12) for _ in range(4)]
    await check(bench, sent)
    first = bench.taken["in"].taken[0]
    assert bench.left.taken == list(range(first, first + len(bench.left.words)))


@on_bench(Bench)
@parametrize(accepts=["none", "alternate"])
async def resets(bench: Bench) -> None:
    """Reset in every phase of a packet: nothing of it is left, and the next one has its own CRC."""
    packet = b"\1\2\0\3"
    for phase in range(1, 20):
        cocotb.start_soon(bench.sources["in"].send(words(packet)))
        await bench.clocks(phase)
        await bench.reset()
        await check(bench, [packet, b"\7"])
