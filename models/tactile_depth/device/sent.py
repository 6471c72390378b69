# SPDX-License-Identifier: Apache-2.0
"""Pictures that the host sends to a device: the depth of each, compared with that of the package."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from tactile_depth.base.errors import InputError, Part
from tactile_depth.base.npy import Bytes
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.link.depth_formats import received
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.depth.result import Result
from tactile_depth.depth.twin import PICTURES
from tactile_depth.device import captures
from tactile_depth.device.channel import Arrival, Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.exchange import Exchange
from tactile_depth.device.registers import meanwhile, read_words, write_words
from tactile_depth.pictures.picture_check import check_picture
from tactile_depth.pictures.pictures import Picture, Pictures, each_of, is_array
from tactile_depth.pictures.reader import Reader

THRESHOLDS = ("THRESHOLD", "OFF_THRESHOLD")
REMEDY = "call load() first; if that was done, build the device for this calibration"


class Sent(NamedTuple):
    """A picture that was sent.

    Attributes
    ----------
    picture : int
        Its number among those that were given.
    arrival : Arrival
        Its depth, as the device computed it.
    result : Result
        Its depth, as the package computes it.
    """

    picture: int
    arrival: Arrival
    result: Result


def are_whole(pictures: Pictures | Iterable[Picture]) -> bool:
    """Return True for pictures as a call of a pipeline takes them, False for an iterable that gives one by one."""
    return is_array(pictures) or isinstance(pictures, str | Path | Sequence) or not isinstance(pictures, Iterable)


def single(line: Channel, twin: Pipeline, pictures: Pictures | Iterable[Picture]) -> Generator[Sent, None, None]:
    """Send pictures that stand for themselves.

    The host sets the light gains of each, and sends it twice, without hysteresis: then its contact does not depend on
    the picture before.

    Parameters
    ----------
    twin : Pipeline
        With what the device holds.
    """
    has_gains = twin.config.light_gains
    with Exchange(line) as exchange, captures.held_light(line) if has_gains else nullcontext():
        for index, (name, frame) in enumerate(_on_grid(pictures, twin.reader)):
            result = twin.result_of(frame[None], [check_picture(frame, twin.rest, name)], None)[0]
            if result.light_gains is not None:
                captures.write_gains(line, np.rint(result.light_gains / LIGHT_GAIN.lsb).astype(int).tolist())
            with _without_hysteresis(line):
                arrival = exchange.depth_of(frame) and exchange.depth_of(frame)
            if arrival is not None:
                _require_equal(arrival, result, name)
                yield Sent(index, arrival, result)


def _without_hysteresis(line: Channel) -> AbstractContextManager[None]:
    """Let what counts as touched not depend on whether something touches, until the end of the context."""
    on, off = read_words(line, THRESHOLDS).values()
    return meanwhile(line, THRESHOLDS[1], on, then=off) if off != on else nullcontext()


def streamed(
    line: Channel, twin: Pipeline, pictures: Pictures | Iterable[Picture], light: int
) -> Generator[Sent, None, None]:
    """Send the pictures of a stream; leave out and count those that give no right depth.

    Parameters
    ----------
    twin : Pipeline
        With what the device holds.
    light : int
        Word of the register `LIGHT`.
    """
    stream = twin.new_stream()
    with Exchange(line) as exchange:
        if stream.light is not None:
            stream.light.rate = captures.LIGHT.unpack(light)["rate"]
            write_words(line, [(captures.LIGHT.name, captures.LIGHT.pack(follow=1, rate=stream.light.rate))])
            captures.write_gains(line, stream.light.gains.tolist())
        for index, picture in enumerate(each_of(pictures)):
            name = f"picture {index}"
            try:
                ((_, frame),) = twin.reader.pictures(picture, name)[0]
                checked = check_picture(frame, twin.rest, name)
            except InputError as error:
                stream.leave_out(error)
                line.count_lost()
                continue
            stream.accepted = True
            arrival = exchange.depth_of(frame)
            if arrival is not None:
                result = twin.result_of(frame[None], [checked], stream)[0]
                _require_equal(arrival, result, name)
                yield Sent(index, arrival, result)
            elif stream.light is not None:  # the device may have computed its depth
                stream.light.gains = np.array(list(read_words(line, GAINS).values()))


def _on_grid(pictures: Pictures | Iterable[Picture], reader: Reader) -> Iterator[tuple[Part, Bytes]]:
    """Give pictures on the grid, each with its name; those of an iterable one by one."""
    if are_whole(pictures):
        yield from reader.pictures(cast(Pictures, pictures), PICTURES)[0]
        return
    for index, picture in enumerate(cast(Iterable[Picture], pictures)):
        yield from reader.pictures(picture, f"picture {index}")[0]


def _require_equal(arrival: Arrival, result: Result, name: Part) -> None:
    """Raise DeviceError unless depth of a device is what it sends of the codes of the package."""
    frame, recorder = arrival.frame, result.recorder
    expected = received(result.codes, frame.depth_format, recorder.width, frame.shift, recorder.bottom_first)
    differing = int(np.count_nonzero(frame.codes != expected))
    if differing:
        where = f"in {differing:,} of {expected.size:,} values"
        problem = f"{name}: the device computes another depth than the pipeline, {where}"
        raise DeviceError(problem, remedy=REMEDY)
