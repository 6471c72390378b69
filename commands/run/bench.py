# SPDX-License-Identifier: Apache-2.0
"""Input and recording of tb/frame_bench.sv, in which pixels move in bulk, without a step of Python per cycle."""

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from commands.common import repository, wrapper
from commands.common import simulator as simulation
from tactile_depth.chip.camera.pixel_format import stream
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import top_parameters, write_roms
from tactile_depth.sensor.sensor import Sensor
from tb.settings import RunSettings

BENCH = "frame_bench"
KINDS = {"pixel": 0, "idle": 1, "sink": 2, "source": 3, "reset": 4, "arm": 5}
NOTE, USER, LAST = 1 << 27, 1 << 25, 1 << 24
# Blanking of an OV7670: 784 x 510 cycles for a picture of 640 x 480.
LINE_BLANKING, FRAME_BLANKING = 144 / 640, 30 / 480
LONG = 600_000  # clocks from which a run of 96 x 128 saves the 5 s that an optimised build takes longer
LARGEST_CODE = 2**31 - 1  # no depth exceeds it


def entry(kind: str, value: int = 0) -> int:
    """Return an entry that is no pixel: idle cycles, a profile of the sink or the source, or a reset."""
    return KINDS[kind] << 28 | value


def turns(on: int, off: int) -> int:
    """Return a profile: high for `on` cycles, then low for `off`; with `on` 0 low with probability off / 4096."""
    return on << 12 | off


def chance(no: float) -> int:
    """Return a profile that is not ready or valid with this probability in each cycle."""
    return turns(0, min(round(no * 4096), 4095))


def frame_entries(frames: np.ndarray) -> np.ndarray:
    """Return the entries of frames, uint8 (..., rows, columns, 3) RGB; first and last pixels are noted."""
    red, green, blue = (frames[..., channel].astype(np.uint32) for channel in range(3))
    entries = red << 16 | blue << 8 | green
    entries[..., -1] |= LAST
    entries[..., 0, 0] |= USER | NOTE
    entries[..., -1, -1] |= NOTE
    return entries.reshape(-1)


def picture_entries(words: np.ndarray, camera: CameraConfiguration) -> np.ndarray:
    """Return the entries of camera pictures, uint32 (pictures, rows, columns), with blanking after rows and before
    pictures.

    The cycles of the first word of a picture and of the camera's `last_word` are noted.
    """
    entries = stream(words, camera).copy()
    count, rows, columns = entries.shape
    entries[..., -1] |= LAST
    entries[:, 0, 0] |= USER | NOTE
    entries.reshape(count, -1)[:, camera.last_word] |= NOTE
    line = round(LINE_BLANKING * columns)
    blanked = np.concatenate((entries, np.full((count, rows, 1), entry("idle", line), np.uint32)), axis=-1)
    frame = entry("idle", round(FRAME_BLANKING * rows) * (columns + line))
    return np.concatenate((np.full((count, 1), frame, np.uint32), blanked.reshape(count, -1)), axis=-1).reshape(-1)


def clocks_of(entries: np.ndarray) -> int:
    """Return the cycles that these entries take without gaps."""
    is_idle = entries >> 28 == KINDS["idle"]
    return int(np.where(is_idle, entries & 0xFFFFFF, 1).sum())


@dataclass(frozen=True)
class Played:
    """Recording of the bench."""

    codes: np.ndarray  # int32, as they left
    events: list[tuple[str, tuple[int, ...]]]  # letter and numbers of each event: see tb/frame_bench.sv
    registers: dict[str, int]  # values at the end

    def clocks(self, letter: str) -> list[int]:
        return [numbers[0] for have, numbers in self.events if have == letter]

    def by_frame(self, letter: str) -> dict[int, int]:
        """Return the cycle of an event, by the number of the frame that leaves; each begins with an event `d`."""
        frame, found = -1, {}
        for have, numbers in self.events:
            frame += have == "d"
            if have == letter:
                found[frame] = numbers[0]
        return found


def frames_left(folder: Path, config: Configuration) -> int:
    """Return the number of frames that have left the device that plays in `folder`."""
    depth = folder / "depth.bin"
    return depth.stat().st_size // (4 * config.rows * config.columns) if depth.exists() else 0


def build(
    simulator: str, config: Configuration, clocks: int, waves: bool = False, camera: CameraConfiguration | None = None
) -> Path:
    """Return the simulator for a configuration, which is built once for each state of the sources.

    It is optimised for runs of up to `LONG` clocks, or for longer ones.
    """
    is_long = clocks > LONG and not waves
    bench = repository.ROOT / "tb" / BENCH
    sources = [*repository.sources(), bench.with_suffix(".sv")]
    program = repository.ROOT / "tb" / "frame_main.cpp"
    parameters = top_parameters(config, camera=camera)
    values = [simulator, waves, is_long, wrapper.wrapper("bench", parameters)]

    def make(folder: Path) -> None:
        simulation.build(
            simulator,
            BENCH,
            [*sources, *(wrapper.write(folder, "bench", parameters | {"Camera": each}) for each in (0, 1))],
            {**wrapper.grid(parameters), "Camera": parameters["Camera"]},
            folder,
            fast=is_long,
            program=None if waves else program,  # cocotb's writes them
            waves=waves,
            log=folder / simulation.LOG,
        )

    return simulation.built_once(values, sources if waves else [*sources, program], f"the {simulator} model", make)


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
    zero: np.ndarray | None = None,
    camera: CameraConfiguration | None = None,
) -> Played:
    """Play entries in `folder` after a reset and the writes of `registers`; then read the registers.

    `zero` is that of `tactile_depth`. With a `camera` the entries are its stream. The run ends when all
    entries are sent and `total_frames` have left, and fails after `clocks` cycles.
    """
    write_roms(folder, calibration, config, zero)
    np.asarray(entries, dtype=">u4").tofile(folder / "entries.bin")
    built = build(simulator, config, clocks, waves, camera)
    registers = dict(registers or {})
    level = registers.get("THRESHOLD", LARGEST_CODE)
    wanted = {
        "inputs": {"passes": passes, "total_frames": total_frames, "seed": seed * 2 + 1, "level": level & 0xFFFFFFFF},
        "registers": registers,
        "clocks": clocks,
        "clocks_itself": simulator == "verilator" and not waves,  # tb/frame_main.cpp
    }
    try:
        count, failed = simulation.run(
            BENCH,
            f"tb.tb_{BENCH}",
            built,
            folder,
            simulator=simulator,
            seed=seed,
            environment=RunSettings(device={"frame_bench": wanted}).environment,
            waves=waves,
            log=folder / "simulation.log",
        )
    except RuntimeError:  # the simulator ended without results
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
