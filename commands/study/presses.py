# SPDX-License-Identifier: Apache-2.0
"""`make presses`: what the pipeline makes of real ball presses, each by a calibration from all others, and in RTL.

Heights, caps, untouched gel, centroid and area of each whole press, `PRESET=sensor` and 24 bits, alone and in other
light; errors of fits to fewer presses; then each press through the RTL with its own calibration, every code against the
model. The folder is that of `make calibrate`. RTL=0: model only. Exit status: 1 if a code differs, 2 on bad input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

import tactile_depth as td
from commands.common import recorded, variables
from commands.common import simulator as simulation
from commands.common.press_data import data_folder, pixels
from commands.common.progress import progress_bar
from commands.common.tabular import Column, Table, shown
from commands.common.variables import EQUAL, MISMATCH, Place, one, real
from commands.run import bench
from commands.study.study import VERSION
from tactile_depth.base import files
from tactile_depth.calibrate.fitting import DRAWN_OUT, errors_by_number, fit_presses
from tactile_depth.calibrate.press_pictures import PressPictures, camera_pitch_mm, gather
from tactile_depth.calibrate.presses import GridPress, to_grid
from tactile_depth.chip.configuration import STORED
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.sensor.calibration_file import PIXEL_PITCHES_MM

NUMBERS = (8, 12, 18, 24, 36)  # presses of a fit
LIGHTS = ((0.8,) * 3, (0.9,) * 3, (0.95,) * 3, (1.05,) * 3, (1.1,) * 3, (1.05, 1.0, 0.95), (0.95, 1.0, 1.05))


@dataclass(frozen=True)
class Measured:
    """One press: lengths in mm, areas over that of the contact circle.

    Attributes
    ----------
    height_rms, cap : float
        Standard deviation of depth from the ball in the contact; recovered over true height of the cap.
    rest_rms, rest_largest : float
        RMS and largest depth of untouched gel, less its mean.
    centroid : float
        Distance from the ball's centre.
    area : float
    """

    height_rms: float
    cap: float
    rest_rms: float
    rest_largest: float
    centroid: float
    area: float


def measured(result: td.Result, press: GridPress) -> Measured:
    """Measure the result of a picture of a press whose geometry is on the same grid."""
    pitch, depth = result.pixel_pitch_mm, result.depth_mm
    rest = depth[press.untouched]
    rest = np.abs(rest - rest.mean())
    row, column = result.contact.centroid_px  # of the depth map, whose centre of the ball is at y + 0.5, x + 0.5
    return Measured(
        press.height_rms(depth / pitch) * pitch,
        press.recovered(depth / pitch),
        float(np.sqrt((rest**2).mean())),
        float(rest.max()),
        float(np.hypot(row - press.y - 0.5, column - press.x - 0.5)) * pitch,
        result.contact.area_mm2 / (np.pi * (press.contact_radius * pitch) ** 2),
    )


def in_light(picture: np.ndarray, light: Sequence[float]) -> np.ndarray:
    """Return a picture, uint8 (rows, columns, 3), in light that is so many times as strong in each colour."""
    return np.rint(picture * np.array(light)).clip(0, 255).astype(np.uint8)


def codes_differ(simulator: str, pipeline: td.Pipeline, picture: np.ndarray, result: td.Result) -> int:
    """Play a picture through the RTL with the calibration of a pipeline; return how many codes differ."""
    config, rows = pipeline.config, len(result.codes)
    assert result.light_gains is not None
    gains = np.rint(result.light_gains / LIGHT_GAIN.lsb).astype(int)
    with files.temporary() as folder:
        played = bench.play(
            simulator,
            config,
            pipeline.sensor,
            bench.frame_entries(picture[None]),
            folder,
            clocks=20 * picture.shape[0] * picture.shape[1],
            total_frames=1,
            registers=dict(zip(GAINS, gains.tolist(), strict=True)),
            zero=pipeline.zero_codes,
        )
    return int(np.count_nonzero(played.codes.reshape(rows, -1)[::-1] != result.codes))


@dataclass(frozen=True)
class Accuracy:
    """Accuracy of heights and contacts over the presses of a place: means unless the head says otherwise."""

    place: Annotated[str, Column("where")]
    presses: Annotated[int, Column("presses")]
    height_um: Annotated[float, Column("height in the contact, RMS, um", ".1f")]
    untouched_um: Annotated[float, Column("untouched gel, RMS, um", ".1f")]
    cap: Annotated[float, Column("caps, recovered / true", ".3f")]
    cap_error: Annotated[float, Column("RMS error of caps", ".3f")]
    centroid_mm: Annotated[float, Column("centroid off, mm", ".3f")]
    area: Annotated[float, Column("area / circle", ".2f")]


def accuracy(place: str, values: Sequence[Measured]) -> Accuracy:
    """Return the accuracy of presses of a place."""
    of = {each.name: np.array([getattr(value, each.name) for value in values]) for each in fields(Measured)}
    mean = {name: float(each.mean()) for name, each in of.items()}
    return Accuracy(
        place=place,
        presses=len(values),
        height_um=1000 * mean["height_rms"],
        untouched_um=1000 * mean["rest_rms"],
        cap=mean["cap"],
        cap_error=float(np.sqrt(((of["cap"] - 1) ** 2).mean())),
        centroid_mm=mean["centroid"],
        area=mean["area"],
    )


def accuracy_table(document: Mapping[str, Any]) -> Table:
    """Return the table of what `run` found, with its sentence."""
    return shown(Accuracy, document["places"])._replace(title=f"{document['setting']}. {sentence(document)}.")


def sentence(document: Mapping[str, Any]) -> str:
    """Return the sentence on accuracy that pages quote."""
    where = {"middle": "in the middle of the picture", "sides": "at its sides"}
    heights = [f"{each['height_um']:.1f} um {where[each['place']]}" for each in document["places"][:-1]]
    untouched = document["places"][-1]["untouched_um"]
    return (
        f"The RMS error of heights in a contact is {' and '.join(heights)}, of untouched gel beside the contact "
        f"{untouched:.1f} um"
    )


def run(pictures: PressPictures, pitch_mm: float, simulator: str | None) -> tuple[int, dict[str, Any]]:
    """Print the tables; return the exit status, and what docs/figures.json keeps. `simulator` None: no RTL."""
    presses = to_grid(pictures, pitch_mm)
    fit = fit_presses(presses, ("cubic",))
    by_name = {press.name: press for press in pictures.presses}
    views = [view for view in presses.views if view.press.name in fit.without]
    same, lit, differing = list[Measured](), {light: list[Measured]() for light in LIGHTS}, 0
    for view in progress_bar(views, "presses"):
        name = view.press.name
        picture = pixels(by_name[name])
        sensor = replace(fit.without[name], camera=fit.sensor.camera)
        pipeline = td.Pipeline(sensor, presses.background)
        result = pipeline(picture)
        same.append(measured(result, view.press))
        for light, values in lit.items():
            values.append(measured(pipeline(in_light(picture, light)), view.press))
        if simulator is not None:
            differing += codes_differ(simulator, pipeline, view.frame, result)
    central = [value for value, view in zip(same, views, strict=True) if view.press.is_central]
    sides = [value for value, view in zip(same, views, strict=True) if not view.press.is_central]
    config = pipeline.config
    document = {
        "setting": f"{len(presses.views)} presses of {pictures.name}, whole ones measured by a calibration from all "
        f"others; default configuration: {presses.grid[1]} x {presses.grid[0]}, {config.solver}, {config.boundary}, "
        f"`{config.gradient_model}`, {getattr(config, STORED)}-bit words, light gains, zero offset",
        "places": [
            asdict(accuracy(place, values))
            for place, values in (("middle", central), ("sides", sides), ("all", same))
            if values
        ],
    }
    print(accuracy_table(document))
    rows = []
    for light, values in lit.items():
        caps, areas = (
            np.array([getattr(value, name) / getattr(alike, name) for value, alike in zip(values, same, strict=True)])
            for name in ("cap", "area")
        )
        rows.append(
            [
                " ".join(f"{x:g}" for x in light),
                f"{caps.mean():.4f}",
                f"{100 * np.abs(caps - 1).max():.1f} %",
                f"{areas.mean():.4f}",
            ]
        )
    head = ["light, of red, green, blue", "caps over those in the same light, mean", "largest change", "areas, mean"]
    print(f"\n{Table(head, rows)}")
    numbers = [number for number in NUMBERS if number + DRAWN_OUT <= len(presses.views)]
    if numbers and len(central) >= DRAWN_OUT:
        by_number = errors_by_number(presses, numbers, progress=lambda each: progress_bar(each, "fits"))
        rows = [[str(number), f"{cap:.3f}", f"{1000 * rms:.1f}"] for number, (cap, rms) in by_number.items()]
        print(f"\n{Table(('presses fitted', 'caps, RMS error in the middle', 'height RMS, um'), rows)}")
    if simulator is not None:
        total = len(views) * presses.grid[0] * presses.grid[1]
        print(f"\nRTL on {simulator}: {total - differing:,} of {total:,} codes equal the model's")
    return MISMATCH if differing else EQUAL, document


def sources(arguments: Sequence[str]) -> str:
    """Return the digest of models and command, for docs/figures.json."""
    variables.read(Variables, arguments)
    return recorded.digest([Path(__file__)], VERSION)


@dataclass(frozen=True)
class Variables:
    presses: Place | None = None
    pitch: Annotated[float | None, real(*PIXEL_PITCHES_MM)] = None
    simulator: simulation.Simulator = simulation.SIMULATORS[0]
    rtl: Annotated[bool, one({"1": True, "0": False})] = True


def main(chosen: Variables) -> int:
    if chosen.rtl:
        simulation.check(chosen.simulator)
    pictures = gather(chosen.presses or data_folder())
    status, document = run(pictures, camera_pitch_mm(pictures, chosen.pitch), chosen.simulator if chosen.rtl else None)
    recorded.record(recorded.rounded(document))
    return status
