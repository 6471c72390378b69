# SPDX-License-Identifier: Apache-2.0
"""A compiled pipeline whose bits flip while frames stream through (tb/upsets_main.cpp), and what becomes of depth."""

import random
import subprocess
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from pathlib import Path

import numpy as np

from commands.common import repository, run_request, wrapper
from commands.common import simulator as simulation
from commands.common.zero_offset import untouched
from commands.hardware import synthesis
from commands.run.bench import frame_entries
from commands.verify.upset_places import Place, Population, places, populations, visible
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.chip.registers.register_map import REGISTERS, WORD
from tactile_depth.chip.tactile_depth import top_parameters, write_roms
from tactile_depth.depth.twin import Twin

PROGRAM = repository.ROOT / "tb" / "upsets_main.cpp"
TOP = "tactile_depth_bench"
PRESSES = ("0,0", "1,-1")  # frames that alternate, so that an old one in place of a new one shows
BEFORE = 4  # frames before the one that enters as bits flip: more than are in flight
COMPARED = BEFORE + 3
STICKY = REGISTERS["STATUS"].mask("w1c")
Flip = tuple[Place, int, int]
"""Place, bit (numbered through all words) and clock of a flip."""


@dataclass(frozen=True)
class Outcome:
    """Outcome of a flip; three values are those of the frames in flight, the frame after and the frame after that.

    Attributes
    ----------
    codes : tuple of int
        Largest change of a depth code.
    percents : tuple of float
        Largest change of a depth, in % of the peak of its frame.
    lost : tuple of bool
        A frame did not come, or not whole.
    marks, status : int
        Bits of RECORD_FLAGS in a record, and of STATUS, that are 0 without the flip; all ones: the registers do not
        answer.
    """

    codes: tuple[int, ...]
    percents: tuple[float, ...]
    lost: tuple[bool, ...]
    marks: int
    status: int

    @property
    def percent(self) -> float:
        """Largest change of a depth, in % of the peak of its frame."""
        return max(self.percents)

    @property
    def is_flagged(self) -> bool:
        """True if a record has a mark, or STATUS a sticky bit."""
        return bool(self.marks or (self.answers and self.status & STICKY))

    @property
    def answers(self) -> bool:
        """True if the registers answer a read."""
        return self.status != WORD

    @classmethod
    def of(cls, cells: Sequence[str]) -> "Outcome":
        """Return the outcome in a line of tb/upsets_main.cpp."""
        codes, percents, lost = cells[:9:3], cells[1:9:3], cells[2:9:3]
        return cls(
            tuple(map(int, codes)),
            tuple(map(float, percents)),
            tuple(each == "1" for each in lost),
            *map(int, cells[9:]),
        )


@dataclass(frozen=True)
class Model:
    """A compiled pipeline with its frames.

    Attributes
    ----------
    built, folder : Path
        Folders of the program and of the tables.
    start : str
        Input of the program before the flips.
    pixels : int
        Pixels of a frame.
    lsb_mm : float
    populations : dict
    """

    built: Path
    folder: Path
    start: str
    pixels: int
    lsb_mm: float
    populations: Mapping[str, Population]

    @cached_property
    def ends(self) -> dict[str, list[int]]:
        """Bits of the places up to each, by population."""
        return {name: [*accumulate(len(bits) for _, bits in each)] for name, each in self.populations.items()}

    def bits(self, name: str) -> int:
        """Return the bits of a population."""
        return self.ends[name][-1] if self.ends[name] else 0

    def flip(self, name: str, number: int, seed: int) -> Flip:
        """Return flip `number` of a population, each of whose bits has the same probability."""
        rng = random.Random(f"{seed} {name} {number}")
        bit = rng.randrange(self.bits(name))
        index = bisect_right(self.ends[name], bit)
        place, bits = self.populations[name][index]
        return place, int(bits[bit - self.ends[name][index]]), rng.randrange(self.pixels)

    def run(self, flips: Iterable[Flip]) -> list[str]:
        """Return the line of tb/upsets_main.cpp for each flip. Raises RuntimeError."""
        lines = (f"{place.number} {bit} {clock}" for place, bit, clock in flips)
        return simulated(self.built, self.folder, [self.start, *lines])


def simulated(built: Path, folder: Path, lines: Iterable[str]) -> list[str]:
    """Run the program; return the lines of its output. Raises RuntimeError."""
    command = [str(built / TOP), "+verilator+seed+1", "+verilator+rand+reset+2"]
    ended = subprocess.run(command, cwd=folder, input="\n".join(lines), capture_output=True, text=True, check=False)
    if ended.returncode:
        raise RuntimeError(f"{built / TOP}: {ended.stderr.strip() or ended.returncode}")
    return ended.stdout.splitlines()


def build(config: Configuration) -> Path:
    """Return the folder of the program for a configuration, which is built once for each state of the sources."""
    fields, sources = top_parameters(config), repository.sources()

    def make(folder: Path) -> None:
        (folder / "places.vlt").write_text(visible())
        files = [*sources, wrapper.write(folder, "bench", fields), folder / "places.vlt"]
        log = folder / simulation.LOG
        simulation.build("verilator", TOP, files, {}, folder, fast=True, program=PROGRAM, checked=False, log=log)

    values = [wrapper.wrapper("bench", fields), visible()]
    return simulation.built_once(values, [*sources, PROGRAM], "the model whose bits flip", make)


def prepare(values: Mapping[str, str], folder: Path) -> Model:
    """Build a configuration, and check that without a flip its codes are those of the model, and none in doubt.

    `folder` takes the tables. Raises RuntimeError otherwise.
    """
    requests = [run_request.of_values({**values, "AT": at}) for at in PRESSES]
    designs = [synthesis.design(request) for request in requests]
    frames, sensor, config = designs[0]
    pictures = np.concatenate([each.pixels for each, _, _ in designs])
    twin = Twin(sensor, config, untouched(requests[0], frames))
    write_roms(folder, sensor, config, twin.zero)
    codes, light, _ = twin.played(pictures, -(-COMPARED // len(pictures)))
    writes = {} if light is None else dict(zip(GAINS, light[0, 0].tolist(), strict=True))
    built = build(config)

    def played(pictures: np.ndarray, inverted: Sequence[Place], recorded: Sequence[Place]) -> list[str]:
        return simulated(built, folder, [start_of(config, pictures, writes, inverted, recorded)])

    def history(pictures: np.ndarray, inverted: Sequence[Place] = ()) -> np.ndarray:
        played(pictures, inverted, registers)
        size = sum(place.words * place.size for place in registers)
        return np.fromfile(folder / "history.bin", np.uint8).reshape(config.rows * config.columns, size)

    lines = played(pictures, [], [])
    end = lines.index("")
    status = REGISTERS["STATUS"].unpack(int(lines[-1]))
    if found := [name for name in ("flipped", "residual") if status[name]]:
        raise RuntimeError(f"without a flip a check finds an error: STATUS.{found[0]} is 1")
    streamed = np.array([line.split() for line in lines[end + 1 : -1]], int).reshape(-1, config.rows, config.columns)
    expected = np.resize(codes, streamed.shape)  # without light gains all repetitions are equal
    if len(streamed) != COMPARED or not np.array_equal(twin.upright(streamed), expected):
        raise RuntimeError("RTL without a flip differs from the model: run `make sim` with this configuration")
    every = places(lines[:end])
    registers = [place for place in every if not place.is_memory]
    others = np.random.default_rng(1).integers(0, 256, pictures.shape, np.uint8)
    other = history(others, [place for place in every if place.is_table])
    return Model(
        built,
        folder,
        start_of(config, pictures, writes),
        config.rows * config.columns,
        config.depth_lsb_px * sensor.pixel_pitch_mm,
        populations(every, history(pictures), other),
    )


def start_of(
    config: Configuration,
    pictures: np.ndarray,
    writes: Mapping[str, int],
    inverted: Sequence[Place] = (),
    recorded: Sequence[Place] = (),
) -> str:
    """Return the input of the program before the flips; `writes` are registers with their values."""
    words = frame_entries(pictures) & 0x3FF_FFFF
    numbers = [len(inverted), *(place.number for place in inverted), len(recorded), *(each.number for each in recorded)]
    numbers.append(len(writes))
    for name, value in writes.items():
        numbers += [REGISTERS[name].offset, value]
    numbers += [REGISTERS["STATUS"].offset, config.rows * config.columns, config.lanes, -(-config.depth.width // 8)]
    return " ".join(map(str, [*numbers, BEFORE, len(words), *words.tolist()]))
