# SPDX-License-Identifier: Apache-2.0
"""Steps that make synth, make fpga and make asic share: from a request to a design that Yosys has read."""

import shutil
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np

from commands.common import recorded, repository, run_request
from tactile_depth.base import files
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.pictures.frames import REST_SCENE, Frames, flat_frames, load_frames, on_grid
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import shown

SOLVERS = {"spectral_solver", "tridiagonal_solver"}
# Small ROMs are LUTs. For Yosys "distributed" is a RAM of LUTs, and it has none with a read port alone.
SMALL_ROMS = 'setattr -set rom_style "logic" m:* a:rom_style=distributed %i'


def design(request: run_request.Request, frames: Frames | None = None) -> tuple[Frames, Sensor, Configuration]:
    """Return frames, by default those of a request, calibration on their grid and configuration.

    Without FRAMES the reference is the frame, and shows all that the calibration's pictures show. What CAMERA sends is
    taken to be the sensor's full picture without FRAMES, and so is its reference, unless CROP says what else.

    Raises InputError.
    """
    calibration = run_request.load_sensor(request)
    run_request.check_grid(request)
    size = (request.rows, request.columns)
    flat = request.reference in (None, REST_SCENE)
    named = frames is not None or bool(request.frames)
    without_picture = frames is None and not request.frames and flat and calibration.camera is not None
    crop = request.crop
    if crop is None and not named and request.camera is not None and calibration.view is not None:
        crop = "none"
    calibration, share = shown(calibration, crop)
    if without_picture:
        frames = flat_frames(calibration, size, request.camera, share, with_reference=request.reference is not None)
    elif frames is None:
        source = request.frames or (run_request.DEFAULT_SCENE if flat else str(request.reference))
        frames = load_frames(source, size, request.reference, request.seed, request.press, request.camera, share)
    calibration = on_grid(calibration, frames, whole=not named)
    return frames, calibration, run_request.configure(request, calibration)


def sources(request: run_request.Request, extra: Iterable[Path] | None = None) -> str:
    """Return a digest of what decides a design's hardware: RTL, parameters and tables. Raises InputError.

    `extra` are sources of a board, which takes all of hdl/ beside them.
    """
    frames, calibration, config = design(request)
    unused = SOLVERS - {f"{config.solver}_solver"}
    tops = ["tactile_depth", *(["camera_unit"] if frames.camera else [])]
    needed = (
        [file for top in tops for file in repository.sources(top, unused)] if extra is None else repository.sources()
    )
    with files.temporary() as folder:
        write_roms(folder, calibration, config)
        parameters = hdl_parameters(config, calibration.pixel_pitch_mm, frames.camera)
        return recorded.digest([*needed, *(extra or ()), *folder.glob("*.hex")], parameters)


def workspace(out: Path, names: Iterable[str]) -> AbstractContextManager[Path]:
    """Provide `files.workspace` that stays after a RuntimeError, which names a log in it."""
    return files.workspace(out, names, keep=RuntimeError)


def read(
    folder: Path,
    config: Configuration,
    calibration: Sensor,
    *,
    top: str = "tactile_depth",
    parameters: Mapping[str, int | str] | None = None,
    extra: Sequence[Path] = (),
    options: str = "",
    zero: np.ndarray | None = None,
) -> list[str]:
    """Write sources and ROMs of a configuration into a folder, and return the lines of Yosys that read them there.

    Parameters
    ----------
    parameters : of `top`; those of the design by default
    extra : sources beside those of hdl/; they replace files of the same name
    options : of the front end
    zero : depth codes in the table of the zero offset, for a bitstream
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_roms(folder, calibration, config, zero)
    names = list({source.name: shutil.copy(source, folder) for source in [*repository.sources(), *extra]})
    of_top = hdl_parameters(config) if parameters is None else parameters
    values = " ".join(f"-G {name}={value}" for name, value in of_top.items())
    return [
        f"read_slang --threads 1 -DSYNTHESIS --top {top} {options} {values} {' '.join(names)}",
        f"hierarchy -top {top}",
        "proc",
        SMALL_ROMS,
    ]
