# SPDX-License-Identifier: Apache-2.0
"""tb/frame_bench.sv: what it plays and what it writes down; pixels move in bulk, without a Python step a clock."""

from __future__ import annotations

import fcntl
import hashlib
import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from commands.common import repository
from commands.common import simulator as simulation
from tactile_depth.configuration import Configuration
from tactile_depth.sensor import Sensor
from tactile_depth.tactile_depth import top_parameters, write_roms

BENCH = "frame_bench"
KINDS = {"pixel": 0, "idle": 1, "sink": 2, "source": 3, "reset": 4, "arm": 5}
NOTE, USER, LAST = 1 << 27, 1 << 25, 1 << 24
LARGEST_CODE = 2**31 - 1  # no depth is above it


def entry(kind: str, value: int = 0) -> int:
    """An entry that is no pixel: clocks without one, a profile of the sink or the source, a reset."""
    return KINDS[kind] << 28 | value


def turns(on: int, off: int) -> int:
    """A profile: `on` clocks of yes by turns with `off` clocks of no; with `on` 0 a no of probability off / 4096."""
    return on << 12 | off


def chance(no: float) -> int:
    """A profile: each clock a no of this probability."""
    return turns(0, min(round(no * 4096), 4095))


def frame_entries(frames: np.ndarray) -> np.ndarray:
    """Whole frames, uint8 (..., rows, columns, 3) RGB; the clocks of their first and last pixels are noted."""
    red, green, blue = (frames[..., channel].astype(np.uint32) for channel in range(3))
    entries = red << 16 | blue << 8 | green
    entries[..., -1] |= LAST
    entries[..., 0, 0] |= USER | NOTE
    entries[..., -1, -1] |= NOTE
    return entries.reshape(-1)


@dataclass(frozen=True)
class Played:
    """Recording of the bench.

    Attributes
    ----------
    codes : int32 array, depth codes as they left
    events : list of tuple
        Letter and numbers of each, in the order of their clocks: see tb/frame_bench.sv.
    registers : dict of str to int, as they were at the end
    """

    codes: np.ndarray
    events: list[tuple[str, tuple[int, ...]]]
    registers: dict[str, int]

    def clocks(self, letter: str) -> list[int]:
        return [numbers[0] for have, numbers in self.events if have == letter]


def build(simulator: str, config: Configuration, waves: bool = False) -> Path:
    """The simulator for a configuration, built once for each state of the sources."""
    bench = repository.ROOT / "tb" / BENCH
    sources = [*repository.sources(), bench.with_suffix(".vlt"), bench.with_suffix(".sv")]
    parameters = top_parameters(config)
    key = hashlib.sha256(json.dumps([simulator, waves, parameters, simulation.versions()]).encode())
    for source in (*sources, Path(simulation.__file__)):
        key.update(source.read_bytes())
    folder = simulation.BUILD / "simulators" / key.hexdigest()[:16]
    complete = folder / "complete"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another run may be building the same
        if complete.exists():
            return folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        print(f"building the {simulator} model (once for this configuration) ..", flush=True)
        try:
            simulation.build(
                simulator,
                BENCH,
                sources,
                parameters,
                folder,
                fast=not waves,
                waves=waves,
                log=folder / "build.log",
            )
        except (RuntimeError, SystemExit) as error:
            raise RuntimeError(f"the build failed: see {folder / 'build.log'}") from error
        complete.touch()
    return folder


def play(
    simulator: str,
    config: Configuration,
    calibration: Sensor,
    entries: np.ndarray | Sequence[int],
    folder: Path,
    *,
    clocks: int,
    passes: int = 1,
    total_frames: int = 0,
    registers: Mapping[str, int] | None = None,
    seed: int = 1,
    waves: bool = False,
    floor: np.ndarray | None = None,
) -> Played:
    """Play entries in `folder`, from reset on, with `registers` written; then read the registers. `floor`: of
    `tactile_depth.tactile_depth`.

    It ends when the file does and `total_frames` have left, and fails after so many `clocks`.
    """
    write_roms(folder, calibration, config, floor)
    np.asarray(entries, dtype=">u4").tofile(folder / "entries.bin")
    built = build(simulator, config, waves)
    registers = dict(registers or {})
    level = registers.get("THRESHOLD", LARGEST_CODE)
    wanted = {
        "inputs": {"passes": passes, "total_frames": total_frames, "seed": seed * 2 + 1, "level": level & 0xFFFFFFFF},
        "registers": registers,
        "clocks": clocks,
    }
    try:
        count, failed = simulation.run(
            BENCH,
            f"tb.tb_{BENCH}",
            built,
            folder,
            simulator=simulator,
            seed=seed,
            environment={"FRAME_BENCH": json.dumps(wanted)},
            waves=waves,
            log=folder / "simulation.log",
        )
    except RuntimeError:  # it ended without results
        count, failed = 0, 0
    if failed or not count:
        log = shutil.copy(folder / "simulation.log", built / "simulation.log")
        raise RuntimeError(f"the simulation failed: see {log}")
    events = []
    for line in (folder / "events.txt").read_text().splitlines():
        letter, *numbers = line.split()
        events.append((letter, tuple(map(int, numbers))))
    return Played(
        codes=np.fromfile(folder / "depth.bin", dtype="<i4"),
        events=events,
        registers=json.loads((folder / "registers.json").read_text()),
    )
