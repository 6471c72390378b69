# SPDX-License-Identifier: Apache-2.0
"""Streams of whole and broken frames for frame_bench, and the results that are expected of them."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from commands.run import bench
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes, gradient_lookup
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import solve
from tactile_depth.chip.video.frame_guard import FAULTS, Guarded, Word, frame_guard
from tactile_depth.sensor.synthetic import synthetic
from tb.axis import BREAKS, SILENT, WITHOUT_START, broken, faults_of, positions, video
from tb.pixels import pack, unpack

FOLLOWS = ("at_once", "one_clock", "many_clocks", "broken")
"""Words after a broken frame: a whole one, after so many clocks; or another broken one and then a whole one."""
STICKY = {"timed_out": "timeout"}  # names of faults and of status bits, where they differ

# As PROFILES of tb/axis.py. `LONGEST`: most cycles of one wait (of a random profile: almost certainly).
PROFILES = {
    "none": bench.turns(0, 0),
    "one_in_4": bench.turns(3, 1),
    "alternate": bench.turns(1, 1),
    "long": bench.turns(150, 200),
    "random": bench.chance(0.4),
}
LONGEST: dict[str, Any] = {"none": 0, "one_in_4": 1, "alternate": 1, "long": 200, "random": 40}


@dataclass(frozen=True)
class Case:
    """One break, and the words that follow it."""

    kind: str
    position: int
    follow: str


@dataclass(frozen=True)
class Command:
    """Entry of the bench that is no word of the stream."""

    entry: int


Item = Word | None | Command
Stream = list[Item]


def cases(rows: int, columns: int, silent: bool) -> list[Case]:
    """Return the full product of break, position and successor, for the breaks that need the time-out register or the
    others.

    After a whole frame come 0 cycles up to the cycles of a frame.
    """
    chosen = [kind for kind in BREAKS if (kind in SILENT) == silent and kind != "whole"]
    out = [
        Case(kind, position, follow)
        for kind in chosen
        for position in positions(kind, rows, columns)
        for follow in FOLLOWS
    ]
    return out if silent else [*out, *(Case("whole", idle, "at_once") for idle in range(rows * columns))]


def batches(
    chosen: Sequence[Case], stalled: bool, timeout: int, size: int = 20
) -> Iterator[tuple[str, str, Sequence[Case]]]:
    """Yield the cases in groups, each with profiles of the source and, if it stalls, of the sink."""
    sources = [name for name in PROFILES if not timeout or timeout > 2 * LONGEST[name]]
    profiles = list(product(sources, PROFILES if stalled else ["none"]))
    for index in range(0, len(chosen), size):
        yield *profiles[index // size % len(profiles)], chosen[index : index + size]


class Attack:
    """Player of streams on one device."""

    def __init__(self, simulator: str, config: Configuration, folder: Path, seed: int) -> None:
        self.simulator, self.config, self.folder, self.seed = simulator, config, folder, seed
        self.rows, self.columns = config.rows, config.columns
        self.pixels = config.rows * config.columns
        self.random = random.Random(seed)
        self.calibration = synthetic(config.bits_per_channel)
        self.slopes = gradient_codes(self.calibration, config)

    def frame(self, mean: int, spread: int) -> list[Word]:
        """Return a frame of random colours around a grey."""
        colours = [[mean + self.random.randint(-spread, spread) for _ in range(3)] for _ in range(self.pixels)]
        return video(pack(colours), self.columns)

    def model(self, frames: Sequence[Sequence[int]]) -> tuple[np.ndarray, int]:
        """Return the depth codes of frames, (frames, rows, columns), and the number of values clipped."""
        rgb = unpack(frames).reshape(-1, self.rows, self.columns, 3)
        monitor = Monitor()
        slopes = gradient_lookup(rgb, self.slopes, self.config.bits_per_channel)
        return solve(divergence(slopes, self.config.neumann), self.config, monitor), monitor.saturations.total()

    def drain(self) -> int:
        """Return a number of cycles in which every frame has left."""
        return first_depth_latency(self.config) + 4 * self.pixels

    def play(self, stream: Stream, **arguments: Any) -> tuple[bench.Played, Guarded]:
        """Play a stream, with the cycles of the pixels of the model's frames noted."""
        words = [item for item in stream if not isinstance(item, Command)]
        guarded = frame_guard(words, self.rows, self.columns, arguments.get("registers", {}).get("TIMEOUT", 0))
        noted = {place for frame in guarded.frames if not frame.bad for place in (frame.first, frame.last)}
        entries, place = [], -1
        for item in stream:
            if isinstance(item, Command):
                entries.append(item.entry)
                continue
            place += 1
            if item is None:
                if entries and entries[-1] >> 28 == bench.KINDS["idle"]:
                    entries[-1] += 1
                else:
                    entries.append(bench.entry("idle", 1))
            else:
                note = bench.NOTE * (place in noted)
                entries.append(note | item.user * bench.USER | item.last * bench.LAST | item.data)
        return self.bench(entries, clocks=20 * (len(words) + self.drain()), **arguments), guarded

    def bench(self, entries: Sequence[int], **arguments: Any) -> bench.Played:
        return bench.play(
            self.simulator, self.config, self.calibration, entries, self.folder, seed=self.seed, **arguments
        )


@dataclass(frozen=True)
class Outcome:
    """Counts of an attack without a difference."""

    cases: int
    kinds: dict[str, int]
    faults: int
    frames: int
    codes: int


def attack(device: Attack, chosen: Sequence[Case], *, stalled: bool, timeout: int = 0) -> Outcome:
    """Play cases, with a whole frame A before and after each, and compare all outputs.

    Broken frames show a deep press and A does not. With a threshold between, `contact` shows whose depth left.
    """
    columns, pixels = device.columns, device.pixels
    a, pressed = device.frame(135, 3), device.frame(128, 127)
    codes, _ = device.model([[word.data for word in words] for words in (a, pressed)])
    assert codes[0].max() < codes[1].max(), "the test is void: contact does not distinguish the frames"
    threshold = (int(codes[0].max()) + int(codes[1].max())) // 2
    stream: Stream = [*a]
    faults: list[str] = []
    kinds: Counter[str] = Counter()

    def append(case: Case, source: str, sink: str, after_broken: bool = False) -> None:
        if case.kind == "waited":
            silent = timeout - 2 * LONGEST[source]  # both may wait before and after
        elif sink == "none" and not after_broken:
            silent = timeout + 1
        else:  # cycles in which the sink stalls, and cycles of filler, are no silence
            silent = 4 * (timeout + after_broken * pixels) + 2 * LONGEST[sink]
        stream.extend(broken(pressed, case.kind, case.position, columns, silent))
        faults.extend(faults_of(case.kind, case.position, columns))
        kinds[case.kind] += 1

    with_start = [c for c in chosen if c.kind not in (*WITHOUT_START, "whole")]
    for source, sink, batch in batches(chosen, stalled, timeout):
        stream.append(Command(bench.entry("source", PROFILES[source])))
        stream.append(Command(bench.entry("sink", PROFILES[sink])))
        for case in batch:
            append(case, source, sink)
            idle = {"one_clock": 1, "many_clocks": device.random.randrange(2, 2 * pixels)}.get(case.follow, 0)
            stream.extend([None] * (case.position if case.kind == "whole" else idle))
            if case.follow == "broken":
                append(device.random.choice(with_start), source, sink, after_broken=True)
            stream.extend(a)
    stream.append(Command(bench.entry("sink")))
    stream.extend([None] * device.drain())

    registers = {"THRESHOLD": threshold, "TIMEOUT": timeout}
    played, guarded = device.play(stream, registers=registers)
    assert guarded.faults == faults, "the stream has other faults than intended"
    outcome = compare(device, played, guarded, threshold, stalled)
    return Outcome(len(chosen), dict(kinds), len(faults), outcome, len(played.codes))


def compare(device: Attack, played: bench.Played, guarded: Guarded, threshold: int, stalled: bool) -> int:
    """Compare the recording of the bench with the models; return the number of whole frames that left."""
    flagged = [FAULTS[numbers[0]] for letter, numbers in played.events if letter == "f"]
    assert flagged == guarded.faults, "faults in their order"
    good = [frame for frame in guarded.frames if not frame.bad]
    codes, clipped = device.model([frame.pixels for frame in guarded.frames])
    want = codes[[not frame.bad for frame in guarded.frames]]
    assert len(played.codes) == want.size, f"{len(played.codes)} codes left, of {len(good)} whole frames"
    codes = played.codes.reshape(want.shape)
    wrong = np.flatnonzero((codes != want).any(axis=(1, 2)))
    assert not len(wrong), f"codes differ in {len(wrong)} frames, the first is {wrong[0]}"

    depths, taken = played.clocks("d"), played.clocks("t")
    assert len(depths) == len(good)
    if not stalled:
        drained = {depth - last for depth, last in zip(depths, taken[1::2], strict=True)}
        assert drained == {last_pixel_to_first_depth(device.config)}, f"last pixel to first depth: {drained}"
    touched, frame = set(), -1
    for letter, _ in played.events:
        frame += letter == "d"
        if letter == "c":
            touched.add(frame)
    assert touched == set(np.flatnonzero(want.max(axis=(1, 2)) > threshold)), "frames that raised contact"

    registers = dict(played.registers)
    assert not registers.pop("self_test")
    status = REGISTERS["STATUS"].unpack(registers.pop("status"))
    assert registers.pop("first_depth_latency") == depths[-1] - taken[-2]
    counters = {"frames_in": len(good), "frames_out": len(good), "frames_dropped": len(guarded.faults)}
    assert registers == counters | {"saturations": clipped}
    sticky = {STICKY.get(fault, fault) for fault in guarded.faults} | ({"saturation"} if clipped else set())
    levels = {"contact"} if want[-1].max() > threshold else set()
    assert {name for name, value in status.items() if value} == sticky | levels
    return len(good)


@dataclass(frozen=True)
class Reset:
    """Reset of `clocks` cycles, `phase` cycles after the stream began, with this profile of the sink."""

    phase: int
    clocks: int
    sink: str


def phases(config: Configuration) -> range:
    """Return the cycles after the first pixel until every stage holds a frame, plus those of one more frame."""
    return range(1, first_depth_latency(config) + 2 * config.rows * config.columns)


def resets(device: Attack, chosen: Sequence[Reset]) -> Outcome:
    """Reset a stream of whole and broken frames in these phases; after each reset all whole frames are right."""
    a, b = device.frame(128, 127), device.frame(128, 127)
    columns = device.columns
    busy = [
        *a,
        *broken(b, "row_short", device.random.randrange(columns), columns),  # the guard fills it up
        *broken(b, "start_early", device.random.randrange(1, columns), columns),  # the next start waits for the filler
        *(word for _ in range(len(phases(device.config)) // device.pixels + 1) for word in b + a),
    ]
    after = [*a, *b, *[None] * device.drain()]

    def entries_of(stream: Sequence[Word | None], noted: bool) -> list[int]:
        out = [
            bench.entry("idle", 1) if item is None else item.user * bench.USER | item.last * bench.LAST | item.data
            for item in stream
        ]
        if noted:
            for place in range(0, 2 * device.pixels, device.pixels):
                out[place] |= bench.NOTE
                out[place + device.pixels - 1] |= bench.NOTE
        return out

    busy_entries, after_entries = entries_of(busy, False), entries_of(after, True)
    entries: list[int] = []
    for reset in chosen:
        entries += [
            bench.entry("sink", PROFILES.get(reset.sink, bench.turns(0, 4095))),
            bench.entry("arm", reset.phase),
        ]
        entries += [len(entries) + 1 + len(busy_entries), *busy_entries]
        entries += [bench.entry("reset", reset.clocks), bench.entry("sink"), *after_entries, bench.entry("reset", 1)]
    played = device.bench(entries, clocks=40 * len(entries))

    busy_codes, _ = device.model([f.pixels for f in frame_guard(busy, device.rows, columns).frames if not f.bad])
    codes, _ = device.model([[word.data for word in words] for words in (a, b)])
    marks = [numbers for letter, numbers in played.events if letter == "r"]
    assert len(marks) == 2 * len(chosen), "resets"
    begin, latency = 0, last_pixel_to_first_depth(device.config)
    for reset, (_, interrupted), (_, end) in zip(chosen, marks[::2], marks[1::2], strict=True):
        early, late = played.codes[begin:interrupted], played.codes[interrupted:end]
        assert (early == busy_codes.reshape(-1)[: len(early)]).all(), f"codes before {reset}"
        assert len(late) == codes.size, f"{len(late)} codes left after {reset}"
        assert (late == codes.reshape(-1)).all(), f"codes after {reset}"
        begin = end
    segment = -1
    taken: list[Any] = []
    depths: list[Any] = []
    for letter, numbers in (*played.events, ("r", (0, 0))):
        if letter == "r":
            if segment % 2 == 0:
                drained = [depth - last for depth, last in zip(depths, taken[1::2], strict=True)]
                assert drained == [latency] * 2, f"last pixel to first depth after {chosen[segment // 2]}: {drained}"
            segment, taken, depths = segment + 1, [], []
        elif letter in "td":
            (taken if letter == "t" else depths).append(numbers[0])
    return Outcome(len(chosen), {"reset": len(chosen)}, 0, 2 * len(chosen), len(played.codes))
