# SPDX-License-Identifier: Apache-2.0
"""Shows camera picture, height map, surface and contact in Rerun, or records them for it."""

from __future__ import annotations

import math
import os
import sys
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from tactile_depth.base.errors import InputError
from tactile_depth.cli.drawing import Scale
from tactile_depth.cli.failure import Failure
from tactile_depth.cli.ply import triangles, vertices_mm
from tactile_depth.cli.source import INSTALL
from tactile_depth.depth.result import Result
from tactile_depth.device.frame import DeviceFrame

APPLICATION = "tactile-depth"
TIMELINE = "frame"
JPEG_QUALITY = 90  # of the camera picture: a recording is an eighth of the size, and heights are exact
MM_PER_M = 1000.0
LEAST_RANGE_MM = 0.5  # that the colours of the height map span at first; it grows with the largest height
TIMES_AS_TALL = 5.0  # the surface is drawn; its points are in mm


def load_rerun() -> Any:
    """Return the module rerun.

    Raises
    ------
    Failure
        It is not installed.
    """
    try:
        import rerun
    except ImportError as error:
        raise Failure(f"frames are shown by Rerun, which is not installed: {INSTALL}") from error
    return rerun


class Display(AbstractContextManager["Display"]):
    """A viewer, a recording or both; use it in a `with` block, which closes the recording.

    Entities, at the time `frame`:

        camera                the picture as sent, JPEG; not of a device's own camera
        height                height_mm, float32
        surface               a mesh in mm: x to the right, y up the picture from its upper left corner, z the height
        contact/touching      0 or 1
        contact/peak_mm, contact/area_mm2
        contact/centroid_mm   x and y as in `surface`; NaN without contact

    Parameters
    ----------
    save : path or None
        Of the recording, an `.rrd`.
    window : bool
        Open the viewer.

    Raises
    ------
    Failure
        Rerun is missing, or its viewer does not start.
    InputError
        The recording cannot be written.
    """

    def __init__(self, save: Path | None, window: bool) -> None:
        self._rerun = rerun = load_rerun()
        self._stream = rerun.RecordingStream(APPLICATION)
        sinks = []
        if save is not None:
            try:
                save.parent.mkdir(parents=True, exist_ok=True)
                save.open("wb").close()
            except OSError as error:
                raise InputError(f"{save} cannot be written ({error.strerror}): give a path that can") from error
            sinks.append(rerun.FileSink(save))
        if window:
            viewer = Path(sys.executable).parent / "rerun"  # also where the environment is not activated
            try:
                rerun.spawn(
                    connect=False,
                    executable_path=os.fspath(viewer) if viewer.exists() else None,
                    recording=self._stream,
                )
            except Exception as error:  # its kind is not documented
                raise Failure(f"the viewer does not start ({error}): --headless --save FILE records instead") from error
            sinks.append(rerun.GrpcSink())
        self._stream.set_sinks(*sinks, default_blueprint=_layout(rerun))
        self._highest_mm = LEAST_RANGE_MM
        self._shape: tuple[int, ...] = ()

    def __exit__(self, *raised: object) -> None:
        self._stream.flush()
        self._stream.disconnect()

    def show(self, index: int, picture: np.ndarray | None, result: Result | DeviceFrame) -> None:
        """Show one frame.

        Parameters
        ----------
        index : int
            Time on the timeline `frame`.
        picture : uint8 array (rows, columns, 3), RGB, or None
            Camera picture, if it is there.
        result : Result or DeviceFrame
            Of that picture.
        """
        rerun, stream, contact = self._rerun, self._stream, result.contact
        height = result.height_mm.astype(np.float32)
        if height.shape != self._shape:
            self._begin(height.shape)
        self._highest_mm = max(self._highest_mm, float(height.max()))
        stream.set_time(TIMELINE, sequence=index)
        if picture is not None:
            stream.log("camera", rerun.Image(picture).compress(jpeg_quality=JPEG_QUALITY))
        heights = [0.0, self._highest_mm]
        origin_mm = result.origin_mm if isinstance(result, DeviceFrame) else (0.0, 0.0)
        stream.log("height", rerun.DepthImage(height, meter=MM_PER_M, colormap="viridis", depth_range=heights))
        stream.log(
            "surface",
            rerun.Mesh3D.from_fields(
                vertex_positions=vertices_mm(height, result.pixel_pitch_mm, result.pixel_aspect, origin_mm),
                vertex_normals=_normals(_slopes(result)),
                vertex_colors=Scale(0.0, self._highest_mm).colours(height).reshape(-1, 3),
            ),
        )
        row, column = contact.centroid_mm or (math.nan, math.nan)
        centroid = [column, -row]
        stream.log("contact/touching", rerun.Scalars(float(contact.touching)))
        stream.log("contact/peak_mm", rerun.Scalars(contact.peak_mm))
        stream.log("contact/area_mm2", rerun.Scalars(contact.area_mm2))
        stream.log("contact/centroid_mm", rerun.Scalars(centroid))

    def _begin(self, shape: tuple[int, ...]) -> None:
        """Log what does not change."""
        rerun, stream = self._rerun, self._stream
        self._shape = shape
        stream.log("surface", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        stream.log("surface", rerun.Transform3D(scale=[1.0, 1.0, TIMES_AS_TALL]), static=True)
        stream.log("surface", rerun.Mesh3D.from_fields(triangle_indices=triangles(*shape)), static=True)
        stream.log("contact/centroid_mm", rerun.SeriesLines(names=["x", "y"]), static=True)


def _slopes(result: Result | DeviceFrame) -> np.ndarray:
    """Return dz/dx and dz/dy, float64 (rows, columns, 2); a device gives none, so they are those of its heights."""
    if isinstance(result, Result):
        return result.slopes
    pitch_mm, aspect = result.pixel_pitch_mm, result.pixel_aspect
    down, right = np.gradient(result.height_mm.astype(np.float64), pitch_mm, pitch_mm * aspect)
    return np.stack((right, down), axis=-1)


def _normals(slopes: np.ndarray) -> np.ndarray:
    """Return the normals of the surface, float32 (rows * columns, 3), not of unit length.

    Slopes count down the rows, y up the picture.
    """
    right, down = slopes[..., 0], slopes[..., 1]
    return np.stack([-right, down, np.ones_like(right)], axis=-1).reshape(-1, 3).astype(np.float32)


def _layout(rerun: Any) -> Any:
    """Arrange the views: pictures on the left, the surface in the middle, the contact over time on the right."""
    views = rerun.blueprint
    return views.Blueprint(
        views.Horizontal(
            views.Vertical(
                views.Spatial2DView(origin="camera", name="camera"),
                views.Spatial2DView(origin="height", name="height, mm"),
            ),
            views.Spatial3DView(origin="surface", name=f"surface, {TIMES_AS_TALL:g} times as tall"),
            views.Vertical(
                views.TimeSeriesView(origin="contact/touching", name="touching"),
                views.TimeSeriesView(origin="contact/peak_mm", name="peak, mm"),
                views.TimeSeriesView(origin="contact/area_mm2", name="area, mm2"),
                views.TimeSeriesView(origin="contact/centroid_mm", name="centroid, mm"),
            ),
            column_shares=[1, 2, 1],
        ),
        collapse_panels=True,
    )
