# SPDX-License-Identifier: Apache-2.0
"""`make reflex`: delays from contact to command and to motion, near the sensor with the RTL in the loop, and through a
host.

A pin is pressed into the gel at a set speed, at a time that is uniform relative to the camera's frame clock. The frames
of the sensor go through the RTL at the timing of the camera. The command is the cycle in which the pin `contact` rises.
The host path is a USB camera and the same reconstruction in software, timed on this machine. Every delay is a `Delay`:
a distribution with its source. docs/reflex.md explains the results.

Takes N, CLOCK_MHZ, SPEED (mm/s), TRIALS, HOST_TRIALS, SEED, SIM and OUT as KEY=VALUE arguments. Exit
status: 0 done, 1 the RTL is wrong, 2 bad input.
"""

import itertools
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from commands.common import published, variables
from commands.common import simulator as simulation
from commands.common.machine import machine
from commands.common.progress import following, progress_bar
from commands.common.results import save, written
from commands.common.run_request import CONTACT_THRESHOLD, threshold_code
from commands.common.signals import threads
from commands.run import bench, reflex_picture
from commands.run import reflex_model as model
from commands.run.reflex_model import Draws, ReflexRun, Setup, Times
from commands.run.reflex_tables import sentences, tables
from tactile_depth.base import files
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_pixel_to_first_depth
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.sensor.scenes import SENSOR_WIDTH_MM

RESULTS = ("reflex.json", "reflex.png")
DEFAULT_OUT = ReflexRun.out
INTERRUPTED = "nothing was written"
DECIDING_CLOCKS = 1  # cycles from the deciding depth on m_axis to `contact`


@dataclass(frozen=True)
class Sent:
    """Frame to send to the RTL; a `slow` frame is sent at the timing of the camera."""

    trial: int
    frame: int
    slow: bool


def sequence(setup: Setup, draws: Draws, trial: int) -> Iterator[Sent]:
    """Return the frames of a trial: one before the contact, then all until the pin is well beyond the threshold.

    Frames of less than half the threshold cannot decide and are sent without gaps, which saves time. If such a frame
    decided, the run would fail.
    """
    phase = draws.phase[trial]
    for frame in itertools.count(-1):
        depth = setup.depth(phase, frame)
        yield Sent(trial, frame, 2 * depth >= setup.threshold)
        if depth >= 1.5 * setup.threshold:
            return


@dataclass(frozen=True)
class Decision:
    """Decision of one trial at the pins, in cycles."""

    frame: int  # frame after which `contact` rose; 0 is the first whose exposure ended after the contact
    first_pixel_to_contact: int
    last_pixel_to_contact: int
    last_pixel_to_first_depth: int
    place: int  # depths of the frame before the deciding one
    deciding_to_contact: int


def entries(request: ReflexRun, sent: Sequence[Sent], pixels: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the entries for the bench and the smallest number of cycles that they take."""
    gap, period = model.spacing(request)
    parts: list[Any] = []
    clocks = 0
    for one, frame in zip(sent, pixels, strict=True):
        step, left = (gap, period - gap * request.size**2) if one.slow else (1, 0)
        parts += [[bench.entry("source", bench.turns(1, step - 1))], bench.frame_entries(frame)]
        parts += [[bench.entry("idle", left)]] * bool(left)
        clocks += step * request.size**2 + left
    return np.concatenate(parts), clocks


def decisions(played: bench.Played, sent: Sequence[Sent], config: Configuration) -> tuple[list[Decision], list[str]]:
    """Return the first contact of each trial in the recording of the bench, and a line for each fault."""
    taken, out = played.clocks("t"), played.clocks("d")
    deciding, contact = played.by_frame("b"), played.by_frame("c")
    contacts: list[Decision] = []
    faults = []
    expected = last_pixel_to_first_depth(config)
    decided: set[int] = set()
    if set(deciding) != set(contact):
        faults.append("`contact` rose without a depth above the threshold, or did not rise after one")
    for index, one in enumerate(sent):
        first, last, depth = taken[2 * index], taken[2 * index + 1], out[index]
        if depth - last != expected:
            faults.append(f"trial {one.trial}: first depth {depth - last} clocks after the last pixel, not {expected}")
        if index not in contact or one.trial in decided:
            continue
        decided.add(one.trial)
        if not one.slow:
            faults.append(f"trial {one.trial}: decided in a frame that was sent without gaps")
        clock, above = contact[index], deciding.get(index, contact[index])
        if clock - above != DECIDING_CLOCKS:
            faults.append(f"trial {one.trial}: `contact` came {clock - above} clocks after the deciding depth")
        contacts.append(Decision(one.frame, clock - first, clock - last, depth - last, above - depth, clock - above))
    for trial in sorted({one.trial for one in sent} - decided):
        faults.append(f"trial {trial}: `contact` never rose")
    return contacts, faults


def loop(request: ReflexRun, setup: Setup, draws: Draws) -> dict[str, list[Decision]]:
    """Run the trials through the RTL of both solvers at the same time; return their decisions. Raises Mismatch."""
    sent = [one for trial in range(request.trials) for one in sequence(setup, draws, trial)]
    pixels = np.stack(
        [
            model.picture(setup, draws, one.trial, one.frame, request.size)
            for one in progress_bar(sent, desc="rendering", unit="frame")
        ]
    )
    calibration = model.calibration_on(request.size)
    played_entries, clocks = entries(request, sent, pixels)
    configs = [Configuration(columns=request.size, rows=request.size, solver=solver) for solver in COLUMNS]
    most_clocks = 2 * clocks + 16 * request.size**2
    for config in configs:
        bench.build(request.simulator, config, most_clocks)

    def play(config: Configuration, folder: Path) -> bench.Played:
        folder.mkdir()
        return bench.play(
            request.simulator,
            config,
            calibration,
            played_entries,
            folder,
            clocks=most_clocks,
            total_frames=len(sent),
            registers={"THRESHOLD": threshold_code(config)},
            seed=request.seed,
        )

    with files.temporary() as work, threads(min(len(configs), os.cpu_count() or 1)) as pool:
        folders = [work / config.solver for config in configs]
        runs = [pool.submit(play, config, folder) for config, folder in zip(configs, folders, strict=True)]

        def left() -> int:
            return sum(map(bench.frames_left, folders, configs))

        with following("RTL in the loop", len(sent) * len(configs), "frame", left):
            played = [run.result() for run in runs]
    decided, faults = {}, []
    for config, one in zip(configs, played, strict=True):
        decided[config.solver], found = decisions(one, sent, config)
        if not (one.codes == tactile_depth(pixels, calibration, config).ravel()).all():
            found.append("RTL differs from the model")
        faults += [f"{config.solver}, {fault}" for fault in found]
    if faults:
        raise variables.Mismatch("; ".join(faults[:5]) + (f"; and {len(faults) - 5} more" if len(faults) > 5 else ""))
    return decided


def described(path: Times) -> dict[str, Any]:
    """Return the statistics of a path and of its parts, and the times of each trial."""
    parts = {name: model.statistics(part) for name, part in path.parts.items() if part.any()}
    both = zip(path.command.tolist(), path.motion.tolist(), strict=True)
    trials = [{"command_ms": command, "motion_ms": motion} for command, motion in both]
    statistics = {"command": model.statistics(path.command), "motion": model.statistics(path.motion)}
    return {**statistics, "parts": parts, "trials": trials}


def measure(request: ReflexRun) -> dict[str, Any]:
    """Measure everything, and return the document that reflex.json holds."""
    gap, _ = model.spacing(request)
    clocks_per_ms = 1000 * request.clock_mhz
    threshold = CONTACT_THRESHOLD * SENSOR_WIDTH_MM
    read_out = gap * (request.size**2 - 1) / clocks_per_ms
    frame_ms, press = model.FRAME_MS, (request.speed, threshold)
    transfer = model.CAMERA_BYTES / model.USB_BYTES_PER_MS
    share = read_out / frame_ms["near"]
    near = Setup(*press, frame_ms["near"], model.EXPOSURE, read_out=share, waiting=0, wake_up=0)
    host = Setup(*press, frame_ms["host"], model.EXPOSURE, transfer=transfer)
    near_draws = model.draw(request.trials, request.seed, "near")
    host_draws = model.draw(request.host_trials, request.seed, "host")
    load = os.getloadavg()[0]
    decided = loop(request, near, near_draws)
    host_base = model.in_software(host, host_draws, request.size, "host")
    host_times = model.times(host, host_draws, *host_base)
    solvers: dict[str, Any] = {}
    bases: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
    for solver, trials in decided.items():
        frames = np.array([decision.frame for decision in trials])
        # The cycles count from the first pixel; `times` counts the read-out separately.
        pipeline = np.array([d.first_pixel_to_contact for d in trials]) / clocks_per_ms - read_out
        base = bases[solver] = (frames, pipeline, np.zeros(request.trials))
        measured = model.times(near, near_draws, *base)
        stated = described(measured)
        solvers[solver] = {
            **stated,
            "command_against_host": model.rank_sum(measured.command, host_times.command),
            "motion_against_host": model.rank_sum(measured.motion, host_times.motion),
            "within_published": model.within_published(stated["motion"]),
            "trials": [asdict(d) | both for d, both in zip(trials, stated["trials"], strict=True)],
        }
    first = next(iter(decided))
    software, _, _ = model.in_software(near, near_draws, request.size, "near, in software")
    return {
        "grid": [request.size, request.size],
        "clock_mhz": request.clock_mhz,
        "speed_mm_s": request.speed,
        "threshold_mm": threshold,
        "seed": request.seed,
        "simulator": request.simulator,
        "machine": machine(),
        "load_before": load,
        "published": published.REFLEX,
        "delays": model.delays(request, near, host),
        "near": solvers,
        "host": described(host_times),
        "sub_frame": sub_frame(decided, request),
        "same_frame_by_double_precision": int((software == bases[first][0]).sum()),
        "difference": difference(solvers[first], near),
        "sensitivity": {
            "near": model.sensitivity(near, near_draws, request.size, bases[first], model.NEAR_NAMES),
            "host": model.sensitivity(host, host_draws, request.size, host_base, model.HOST_NAMES),
        },
    }


def sub_frame(decided: dict[str, list[Decision]], request: ReflexRun) -> dict[str, Any]:
    """Return the position of the deciding depth in its frame, and the time that the earlier solver saves."""
    rows: dict[str, Any] = {}
    contact: dict[str, np.ndarray] = {}
    for solver, trials in decided.items():
        contact[solver] = np.array([d.last_pixel_to_contact for d in trials])
        rows[solver] = {
            "last_pixel_to_first_depth": trials[0].last_pixel_to_first_depth,
            "place": model.statistics(np.array([d.place for d in trials])),
            "last_pixel_to_contact": model.statistics(contact[solver]),
            "deciding_to_contact": sorted({d.deciding_to_contact for d in trials}),
        }
    earlier = model.statistics(contact["spectral"] - contact["tridiagonal"])
    earlier["mean_us"] = earlier["mean"] / request.clock_mhz
    return {"solvers": rows, "tridiagonal_earlier_clocks": earlier}


def difference(near: dict[str, Any], setup: Setup) -> dict[str, float | None]:
    """Return the changes that would give the published mean and spread of contact to command."""
    mean, spread = published.REFLEX["near"]["command"]
    middle = near["parts"]["indentation grows to the threshold, and the next exposure comes"]["mean"]
    growth = middle - setup.frame / 2
    wanted = growth + mean - near["command"]["mean"]
    motion, motion_spread = published.REFLEX["near"]["motion"]
    others = near["motion"]["mean"] - growth
    slowest, quickest = (motion + sign * motion_spread - others for sign in (1, -1))  # growth, ms
    clock = setup.frame / math.sqrt(12)

    def approach(other: float) -> float | None:
        """Return the speed in mm/s that reaches the threshold in `growth` ms; None if none is fast enough."""
        return setup.speed * growth / other if other > 0 else None

    return {
        "growth_ms": growth,
        "growth_for_published_mean_ms": wanted,
        "speed_for_published_mean_mm_s": approach(wanted),
        "slowest_within_mm_s": approach(slowest),
        "quickest_within_mm_s": approach(quickest),
        "spread_of_frame_clock_ms": clock,
        "spread_left_ms": math.sqrt(max(spread**2 - clock**2, 0)),
    }


def show(document: dict[str, Any]) -> str:
    rows, columns = document["grid"]
    machine = f"{document['machine']} (load {document['load_before']:.1f} before)"
    setting = f"{rows} x {columns}, seed {document['seed']}, {machine}"
    return "\n\n".join([setting, *map(str, tables(document)), "\n".join(sentences(document))])


def run(request: ReflexRun) -> None:
    """Measure, print, and write reflex.json and reflex.png, both or neither.

    Raises InputError, Mismatch or RuntimeError.
    """
    simulation.check(request.simulator)
    with written(request.out, RESULTS) as work:
        document = measure(request)
        print(show(document))
        save(work / "reflex.json", document)
        reflex_picture.plot(work / "reflex.png", document)


main = run
