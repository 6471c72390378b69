# SPDX-License-Identifier: Apache-2.0
"""State that outlives a frame, after 10 million frames: light gains, counters, numbers and times.

Pictures that repeat move the light gains by a function of the gains alone; once the gains are
what they were before, they go round, and where they are after any number of frames is known. Counters and times are set
to their largest value first.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from commands.common.tabular import Column
from commands.study.drawn_light import DrawnLight
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.contact_events import WORD_BITS, ContactEvents, Settings
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.registers.event_registers import (
    COUNTERS,
    EVENT_COUNTERS,
    LARGEST_COUNT,
    SATURATIONS,
    EventRegisters,
)
from tactile_depth.chip.tactile_depth import slope_tables
from tactile_depth.sensor.sensor import Sensor

FRAMES = 10_000_000
PICTURES = 4  # that repeat, each with its own noise of the camera
LONGEST = 400  # passes over the pictures until the gains must go round
LIGHTS = {
    "light of the reference": (1.0,) * PICTURES,
    "x 0.51": (0.51,) * PICTURES,
    "x 1.3": (1.3,) * PICTURES,
    "x 1.6": (1.6,) * PICTURES,
    "x 1.99": (1.99,) * PICTURES,
    "x 0.99 and x 1.01 in turn": (0.99, 1.01) * (PICTURES // 2),
}
RATES = (0, 1)


@dataclass(frozen=True)
class LightState:
    """Gains of a stream of pictures that repeat.

    Attributes
    ----------
    settled_after : int
        Frames after which the gains go round; -1: they did not within the frames that were run.
    period : int
        Frames after which they are the same again.
    off_percent : float
        Largest distance of gain * light from 1 on the round, in %.
    gains : (int, int, int)
        Codes after FRAMES frames, of red, green and blue.
    """

    light: Annotated[str, Column("light")]
    rate: Annotated[int, Column("LIGHT.rate")]
    settled_after: Annotated[
        int, Column("goes round after", lambda after: "no round found" if after < 0 else f"{after:,}")
    ]
    period: Annotated[int, Column("period", ",")]
    off_percent: Annotated[float, Column("gain x light off 1 by, %", ".3f")]
    gains: Annotated[tuple[int, ...], Column(f"gains after {FRAMES:,}", lambda gains: ", ".join(map(str, gains)))]


def light_states(drawn: DrawnLight, sensor: Sensor, config: Configuration, exposure: float) -> list[LightState]:
    """Run the light gains of untouched gel in every light and at every rate.

    `exposure` is the light of the sensor's reference, over that of the drawn sensor.
    """
    gains = slope_tables(sensor, config).gains
    assert gains is not None
    states = []
    for name, lights in LIGHTS.items():
        pictures = drawn.pictures(drawn.untouched, [(exposure * light,) * 3 for light in lights], seed=3)
        relative = gains.ratios(pictures)
        states += [light_state(name, relative, np.array(lights), Light.of(config), rate) for rate in RATES]
    return states


def light_state(name: str, relative: np.ndarray, lights: np.ndarray, light: Light, rate: int) -> LightState:
    """Return the gains after FRAMES frames of ratios (pictures, rows, columns, 3) that repeat."""
    stream = LightFilter(light, rate=rate)
    passes: dict[bytes, int] = {}
    used: list[np.ndarray] = []
    count = len(relative)
    while stream.gains.tobytes() not in passes and len(passes) < LONGEST:
        passes[stream.gains.tobytes()] = len(passes)
        used += list(stream.take_all(relative))
    first = passes.get(stream.gains.tobytes(), -1)
    start = max(first, 0) * count
    period = len(used) - start
    round_of_gains = np.array(used[start:])
    product = round_of_gains / light.unity * np.resize(lights, period)[:, None]
    after = used[start + (FRAMES - start) % period]
    settled_after = start if first >= 0 else -1
    return LightState(name, rate, settled_after, period, 100 * float(np.abs(product - 1).max()), tuple(after.tolist()))


@dataclass(frozen=True)
class LongCount:
    """A register that counts, after FRAMES frames and at its end.

    Attributes
    ----------
    share_percent : float
        Of its range, that FRAMES frames take; above 100: it came to its end before.
    after_the_end : int
        Value one event after its largest one.
    """

    register: Annotated[str, Column("register")]
    share_percent: Annotated[float, Column(f"range used after {FRAMES:,} frames, %", ",.2f")]
    after_the_end: Annotated[int, Column("after its largest value", ",")]


def counts(config: Configuration, clipped_per_frame: int, clocks_per_frame: int) -> list[LongCount]:
    """Return what becomes of every counter, number and time in FRAMES frames that each clip so many values."""
    largest = (1 << WORD_BITS) - 1
    model = EventRegisters()
    model.values.update(LARGEST_COUNT)
    model.clock(tuple(EVENT_COUNTERS), 1, 0, None, 0)
    each: Mapping[str, int] = {
        SATURATIONS: clipped_per_frame,
        "DARK_PIXELS": config.rows * config.columns,
        "DEPTH_DROPPED": config.rows * config.columns,
    }
    rows = [(name, each.get(name, 1), model.values[name]) for name in COUNTERS]
    contact = ContactEvents(config.rows, config.columns, config.depth.width, bottom_first=True)
    contact.frames = largest
    codes = np.zeros((config.rows, config.columns), np.int64)
    record = contact.whole_frame(codes, Settings(1, 1, 1, 1, 1), time=largest)
    after = (largest + clocks_per_frame) % (largest + 1)
    rows += [("RECORD_FRAME", 1, record.frame), ("RECORD_TIME", clocks_per_frame, after)]
    ranges = {name: LARGEST_COUNT.get(name, largest) + 1 for name, _, _ in rows}
    return [LongCount(name, 100 * FRAMES * per_frame / ranges[name], end) for name, per_frame, end in rows]
