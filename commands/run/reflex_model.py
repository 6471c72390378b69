# SPDX-License-Identifier: Apache-2.0
"""Model of the delays between contact and motion, near the sensor and through a host, and their statistics."""

import itertools
import time
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from commands.common import published
from commands.common.progress import progress_bar
from commands.common.repository import ROOT
from commands.common.run_request import CONTACT_THRESHOLD
from commands.common.simulator import SIMULATORS, Simulator
from commands.common.variables import Place, Seed, real, whole
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.depth import reference
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.scenes import SYNTHETIC_PIXEL_PITCH_MM, Press, render, scene_pixel_pitch_mm
from tactile_depth.sensor.sensor import Sensor

DEFAULT_OUT = ROOT / "build" / "reflex"
PIN = "ball"  # radius of its round tip, as in models/tactile_depth/sensor/scenes.py
STOP_MM = 1.0  # depth at the end of the press

# Components of the delays.
FRAME_MS = {"near": 1000 / 400, "host": 1000 / 25}
SPEED_MM_S = 20.0
EXPOSURE = 0.5  # of the frame time
SERVO_MS, SERVO_SPREAD_MS = 18.1, 3.3
USB_BYTES_PER_MS = 8 * 3 * 1024  # high speed: 8 microframes a ms, isochronous, at most 3 transactions of 1,024 bytes
CAMERA_BYTES = 640 * 480 * 2  # YUYV
DRIVER_BUFFERS = 4
ASLEEP_MS = 1.0
SCALES = (0.5, 2.0)  # of the sensitivity table


@dataclass(frozen=True)
class Setup:
    """Delays of a path in ms; the sensitivity table scales each of them alone."""

    speed: float  # mm/s
    threshold: float  # mm
    frame: float  # from one exposure to the next
    exposure: float  # fraction of the frame time, at its end
    read_out: float = 0.0  # fraction of the frame time from the end of the exposure to the last pixel
    transfer: float = 0.0  # of a link, in place of the read-out
    waiting: float = 1.0  # this and the next two scale the values drawn or measured in each trial
    compute: float = 1.0
    wake_up: float = 1.0
    servo: float = SERVO_MS
    servo_spread: float = SERVO_SPREAD_MS

    def exposed(self, phase: float, frame: int) -> float:
        """Return the end of the exposure of a frame, ms after the contact; frame 0 is the first that ends after it."""
        return (phase + frame) * self.frame

    def middle(self, phase: float, frame: int) -> float:
        """Return the middle of the exposure of a frame, whose depth a picture of a steady press shows."""
        return self.exposed(phase, frame) - self.exposure * self.frame / 2

    def depth(self, phase: float, frame: int) -> float:
        """Return the depth of the pin at that time, mm."""
        return min(max(self.speed * self.middle(phase, frame) / 1000, 0.0), STOP_MM)


@dataclass(frozen=True)
class Draws:
    """Random draws for the trials of a path, one entry per trial."""

    phase: np.ndarray  # fraction of a frame time from the contact to the end of the exposure
    waiting: np.ndarray  # finished frames that wait in the driver before this one
    servo: np.ndarray  # standard normal
    noise: np.ndarray  # seeds of the camera's noise


def draw(trials: int, seed: int, path: str) -> Draws:
    random = np.random.default_rng([seed, list(FRAME_MS).index(path)])
    return Draws(
        random.random(trials),
        random.integers(DRIVER_BUFFERS, size=trials),
        random.standard_normal(trials),
        random.integers(2**32, size=trials),
    )


Trials = Annotated[int, whole(2, 10_000)]


@dataclass(frozen=True)
class ReflexRun:
    """Trials of both paths: frames of `size` x `size` pixels, and a pin of `speed` mm/s."""

    size: Annotated[int, whole(*COLUMNS["spectral"]), "N"] = 128
    clock_mhz: Annotated[float, real(0.5, 400)] = published.CLOCK_MHZ
    speed: Annotated[float, real(5, 200)] = SPEED_MM_S
    trials: Trials = published.REFLEX["near"]["trials"]
    host_trials: Trials = published.REFLEX["host"]["trials"]
    seed: Seed = 1
    simulator: Simulator = SIMULATORS[0]
    out: Place = DEFAULT_OUT

    def __post_init__(self) -> None:
        for solver in COLUMNS:
            Configuration(columns=self.size, solver=solver)
        least = self.size**2 / FRAME_MS["near"] / 1000
        if self.clock_mhz < least:
            raise InputError(
                f"CLOCK_MHZ={self.clock_mhz:g}: the pixels of {self.size} x {self.size} at "
                f"{1000 / FRAME_MS['near']:g} frames/s come faster: accepted is {least:.4g} and more, or a smaller N"
            )


def picture(setup: Setup, draws: Draws, trial: int, frame: int, size: int) -> np.ndarray:
    """Return one frame of a trial as the sensor sees it: uint8 (size, size, 3)."""
    depth = setup.depth(draws.phase[trial], frame)
    seed = int(np.random.SeedSequence([int(draws.noise[trial]), frame + 1]).generate_state(1)[0])
    name, press = (PIN, Press(depth)) if depth else ("flat", Press())
    return render(name, size, seed=seed, press=press).frames[0]


def calibration_on(size: int) -> Sensor:
    return load("synthetic").scaled(scene_pixel_pitch_mm(size) / SYNTHETIC_PIXEL_PITCH_MM)


def spacing(request: ReflexRun) -> tuple[int, int]:
    """Return the cycles from pixel to pixel at the timing of the camera, and the cycles of a frame time."""
    period = round(FRAME_MS["near"] * request.clock_mhz * 1000)
    return period // request.size**2, period


@dataclass(frozen=True)
class Times:
    """Times of each trial of a path in ms; `parts` add up to contact to motion."""

    command: np.ndarray
    motion: np.ndarray
    parts: dict[str, np.ndarray]


def times(setup: Setup, draws: Draws, frames: np.ndarray, compute: np.ndarray, wake_up: np.ndarray) -> Times:
    """Return the times from the deciding frames to motion.

    Parameters
    ----------
    frames : int array, the deciding frame of each trial
    compute, wake_up : float array, ms: from the last pixel to the decision, and how late the operating system was
    """
    middles = np.array([setup.middle(phase, frame) for phase, frame in zip(draws.phase, frames, strict=True)])
    parts = {
        "indentation grows to the threshold, and the next exposure comes": middles,
        "half the exposure": np.full(len(frames), setup.exposure * setup.frame / 2),
        "read-out": np.full(len(frames), setup.read_out * setup.frame),
        "transfer": np.full(len(frames), setup.transfer),
        "frames waiting": setup.waiting * draws.waiting * setup.frame,
        "reconstruction": setup.compute * compute,
        "operating system": setup.wake_up * wake_up,
        "servo": setup.servo + setup.servo_spread * draws.servo,
    }
    motion = np.sum(list(parts.values()), axis=0)
    return Times(motion - parts["servo"], motion, parts)


def first_above(setup: Setup, draws: Draws, trial: int, size: int, calibration: Sensor) -> tuple[int, float, float]:
    """Return the deciding frame in double precision, its compute time and the lateness after a sleep, ms."""
    for frame in itertools.count():
        if 2 * setup.depth(draws.phase[trial], frame) < setup.threshold:
            continue  # see `sequence`
        pixels = picture(setup, draws, trial, frame, size)
        begin = time.perf_counter()
        time.sleep(ASLEEP_MS / 1000)
        woken = time.perf_counter()
        deepest = reference.depth(pixels, calibration).max() * scene_pixel_pitch_mm(size)
        done = time.perf_counter()
        if deepest > setup.threshold:
            return frame, 1000 * (done - woken), max(1000 * (woken - begin) - ASLEEP_MS, 0.0)
    raise AssertionError("unreachable")


def in_software(setup: Setup, draws: Draws, size: int, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return `first_above` of each trial: deciding frames, compute and wake-up in ms."""
    calibration = calibration_on(size)
    reference.depth(picture(setup, draws, 0, 0, size), calibration)  # the first is slower: imports, plans
    trials = progress_bar(range(len(draws.phase)), desc=name, unit="trial", delay=2)
    decided = [first_above(setup, draws, trial, size, calibration) for trial in trials]
    frames, compute, wake_up = (np.array(values) for values in zip(*decided, strict=True))
    return frames, compute, wake_up


def sensitivity(
    setup: Setup, draws: Draws, size: int, base: tuple[np.ndarray, np.ndarray, np.ndarray], names: dict[str, str]
) -> list[dict[str, Any]]:
    """Return contact to motion with one number of the setup halved or doubled, in descending order of effect.

    `base` holds the arguments of `times` for the setup, `names` the name in the table of each field of the setup.
    """
    rows = []
    for field, name in names.items():
        row: dict[str, Any] = {"delay": name, "value": getattr(setup, field)}
        for scale in SCALES:
            changed = replace(setup, **{field: scale * getattr(setup, field)})
            if max(changed.exposure, changed.read_out) > 1:  # the frame time is too short for it
                row[f"x{scale:g}"] = None
                continue
            frames, compute, wake_up = base
            if field in ("speed", "threshold", "frame", "exposure"):
                frames, _, _ = in_software(changed, draws, size, f"{name} x {scale:g}")
            motion = times(changed, draws, frames, compute, wake_up).motion
            row[f"x{scale:g}"] = {"mean": float(motion.mean()), "sd": float(motion.std(ddof=1))}
        rows.append(row)
    middle = float(times(setup, draws, *base).motion.mean())

    def moves(row: dict[str, Any]) -> float:
        return max(abs(row[f"x{scale:g}"]["mean"] - middle) for scale in SCALES if row[f"x{scale:g}"])

    return sorted(rows, key=moves, reverse=True)


def statistics(values: np.ndarray) -> dict[str, Any]:
    numbers = {"mean": values.mean(), "sd": values.std(ddof=1), "min": values.min(), "max": values.max()}
    return {"trials": len(values), **{name: float(value) for name, value in numbers.items()}}


def rank_sum(near: np.ndarray, host: np.ndarray) -> dict[str, float]:
    """Return the two-sided Mann-Whitney U; 0: every trial near the sensor was faster than every other."""
    from scipy.stats import mannwhitneyu  # it takes longer to import than all others

    result = mannwhitneyu(near, host, alternative="two-sided")
    return {"U": float(result.statistic), "p": float(result.pvalue)}


def within_published(near: dict[str, Any]) -> bool:
    """Return True if the mean is within published mean +- deviation and the spread is no wider."""
    mean, spread = published.REFLEX["near"]["motion"]
    return abs(near["mean"] - mean) <= spread and near["sd"] <= spread


def delays(request: ReflexRun, near: Setup, host: Setup) -> list[dict[str, str]]:
    """Return every delay of the simulation: path, name, distribution and source."""
    gap, _ = spacing(request)
    threshold = f"{near.threshold:.3g} mm, {CONTACT_THRESHOLD * request.size:g} px"
    rows = [
        ("both", "approach", f"constant, {near.speed:g} mm/s", "assumption (SPEED); none is published"),
        ("both", "threshold", f"constant, {threshold}", "that of make sim; none is published"),
        ("near", "frame clock", f"uniform over {near.frame:g} ms", "published: 400 frames/s"),
        ("near", "exposure", f"constant, {near.exposure:g} of a frame", "assumption; its middle counts"),
        (
            "near",
            "read-out",
            f"constant, {near.read_out * near.frame:.3f} ms",
            f"assumption: all of the frame, {gap} clocks a pixel",
        ),
        ("near", "pipeline", "the clocks counted in each trial", f"RTL, at {request.clock_mhz:g} MHz (CLOCK_MHZ)"),
        ("both", "servo", f"normal, {near.servo:g} +- {near.servo_spread:g} ms", "published; its shape: assumption"),
        ("host", "frame clock", f"uniform over {host.frame:g} ms", "published: 25 frames/s"),
        ("host", "exposure", f"constant, {host.exposure:g} of a frame", "assumption; its middle counts"),
        (
            "host",
            "transfer",
            f"constant, {host.transfer:.1f} ms",
            "640 x 480 YUYV (assumption) at USB 2.0's isochronous limit, 3 x 1,024 bytes a microframe (5.6.3, 5.9.2)",
        ),
        (
            "host",
            "frames waiting",
            f"0 to {DRIVER_BUFFERS - 1} frames, each as likely",
            "OpenCV asks V4L2 for 4 buffers (opencv/opencv#11047, #13145), one being filled; how many wait: assumption",
        ),
        ("host", "reconstruction", "as measured in each trial", "tactile_depth.depth.reference on this machine"),
        ("host", "operating system", "as measured in each trial", f"lateness after a sleep of {ASLEEP_MS:g} ms, here"),
    ]
    return [dict(zip(("path", "name", "distribution", "source"), row, strict=True)) for row in rows]


NEAR_NAMES = {
    "speed": "approach speed, mm/s",
    "threshold": "threshold, mm",
    "frame": "frame time, ms (exposure and read-out with it)",
    "exposure": "exposure, share of the frame time",
    "read_out": "read-out, share of the frame time",
    "compute": "pipeline (scale)",
    "servo": "servo, ms",
    "servo_spread": "servo's spread, ms",
}

HOST_NAMES = {
    **{name: text for name, text in NEAR_NAMES.items() if name not in ("frame", "read_out", "compute")},
    "frame": "frame time, ms (exposure and waiting with it)",
    "transfer": "transfer, ms",
    "waiting": "frames waiting (scale)",
    "compute": "reconstruction (scale)",
    "wake_up": "operating system (scale)",
}
