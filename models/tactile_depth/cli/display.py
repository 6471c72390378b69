# SPDX-License-Identifier: Apache-2.0
"""Shows camera picture, height map, surface and contact in Rerun, or records them for it."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from tactile_depth.base.errors import InputError
from tactile_depth.cli.drawing import BACKGROUND, INK, Scale, round_number
from tactile_depth.cli.ply import triangles, vertices_mm
from tactile_depth.cli.viewer import Page, Viewer, load_rerun
from tactile_depth.depth.result import Result
from tactile_depth.device.frame import DeviceFrame

APPLICATION = "tactile-depth"
MAGIC, HEAD = b"RRF", 1024  # an .rrd begins with these bytes, and names its application among so many
NUMBER, TIME = "frame", "captured"  # timelines
JPEG_QUALITY = 90  # of the camera picture: a recording is an eighth of the size, and heights are exact
MM_PER_M = 1000.0
LEAST_RANGE_MM = 0.5  # that the colours of the height map span at first; it grows with the largest height
TIMES_AS_TALL = 3.0  # the surface is drawn; its points are in mm
EYE = (0.5, 1.0, 0.85)  # where the surface is seen from: to the right, down the picture and up, in widths of the gel
BAR, LETTERS, MARGIN = (480, 24), 26, 40  # pixels of the colour bar
PAGE_S, PAGE_WIDTH = 0.1, 320  # seconds between frames of a page, and columns of its camera picture, which is no JPEG:
# a browser without a graphics card takes 10 such frames/s, and decodes JPEGs too late to show them
CLOSING_S = 1.0  # that a viewer has to take the last frames


def require_recording(path: Path) -> None:
    """Raise InputError, or OSError, if a file is there that is neither empty nor a recording of this command."""
    if path.is_file():
        with path.open("rb") as file:
            head = file.read(HEAD)
        if head and not (head.startswith(MAGIC) and APPLICATION.encode() in head):
            raise InputError(f"{path} is there and is no recording of this command: move it away or give another name")


class Display(AbstractContextManager["Display"]):
    """A viewer, a recording or both; use it in a `with` block, which closes the recording.

    Entities, at the times `frame`, the number in its source, and `captured`, the time of capture if it is known:

        camera                the picture as sent, JPEG; not of a device's own camera
        height                height_mm, float32
        scale                 a picture of the colours of the height map, with heights in mm
        surface               a mesh in mm: x to the right, y up the picture from its upper left corner, z the height
        contact/touching      0 or 1
        contact/peak_height_mm, contact/area_mm2
        contact/centroid_mm   x and y as in `surface`; NaN without contact

    With several sensors they are below `sensor_0`, `sensor_1`, ..

    Parameters
    ----------
    save : path or None
        Of the recording, an `.rrd`.
    window : bool
        Open the viewer.
    page : Page or None
        Where browsers find it, in place of a window.
    names : sequence of str
        Names of the sensors.
    timeline : str
        Which the viewer shows, `NUMBER` or `TIME`.

    Raises
    ------
    Failure
        Rerun is missing, the viewer does not start, or a port is in use.
    InputError
        The recording cannot be written, there is no screen, or the address is not one of this computer.
    """

    def __init__(
        self,
        save: Path | None,
        window: bool,
        page: Page | None = None,
        names: Sequence[str] = ("",),
        timeline: str = NUMBER,
    ) -> None:
        rerun = load_rerun()
        self._outputs = []
        if save is not None:
            try:
                save.parent.mkdir(parents=True, exist_ok=True)
                require_recording(save)
                save.open("wb").close()
            except OSError as error:
                raise InputError(f"{save} cannot be written ({error.strerror}): give a path that can") from error
            self._outputs.append(_Output(rerun, rerun.FileSink(save), names, timeline))
        self._viewer = viewer = Viewer(page) if window else None
        if viewer is not None:
            self._outputs.append(_Output(rerun, rerun.GrpcSink(viewer.url), names, timeline, viewer.is_page))

    def __exit__(self, *raised: object) -> None:
        try:
            self._close()
        except BaseException as error:
            raised = (type(error), error, error.__traceback__)
            raise
        finally:
            if self._viewer is not None:
                self._viewer.__exit__(*raised)

    def is_open(self) -> bool:
        """Return False if the user has closed the viewer; raise Failure if it has failed."""
        return self._viewer is None or self._viewer.is_open()

    def _close(self) -> None:
        for output in self._outputs:
            try:
                output.stream.flush(timeout_sec=CLOSING_S)
            except Exception:  # its kind is not documented
                if self.is_open():
                    raise
            output.stream.disconnect()

    def show(self, number: int, picture: np.ndarray | None, result: Result | DeviceFrame, sensor: int) -> bool:
        """Show one frame; return False if the user has closed the viewer.

        Parameters
        ----------
        number : int
            Time on the timeline `frame`.
        picture : uint8 array (rows, columns, 3), RGB, or None
            Camera picture, if it is there.
        result : Result or DeviceFrame
            Of that picture.
        sensor : int
            Number of the sensor.

        Raises
        ------
        Failure
            The viewer has failed.
        """
        if not self.is_open():
            return False
        for output in self._outputs:
            output.show(number, picture, result, sensor)
        return True


class _Output:
    """A recording, a window or a page, and what it shows of each sensor. A page gets less than each frame."""

    def __init__(self, rerun: Any, sink: Any, names: Sequence[str], timeline: str, is_page: bool = False) -> None:
        self._rerun, self._timeline, self._is_page = rerun, timeline, is_page
        self.stream = rerun.RecordingStream(APPLICATION)
        self.stream.set_sinks(sink)
        prefixes = [f"sensor_{index}/" for index in range(len(names))] if len(names) > 1 else [""]
        self._screens = [_Screen(rerun, self.stream, is_page, *each) for each in zip(prefixes, names, strict=True)]

    def show(self, number: int, picture: np.ndarray | None, result: Result | DeviceFrame, sensor: int) -> None:
        screen, now = self._screens[sensor], time.monotonic()
        if self._is_page and now < screen.last_s + PAGE_S:
            return
        screen.last_s = now
        captured_at = result.captured_at if isinstance(result, Result) else result.time_s
        self.stream.set_time(NUMBER, sequence=number)
        if captured_at is None:
            self.stream.disable_timeline(TIME)
        else:
            self.stream.set_time(TIME, timestamp=captured_at)
        camera = None
        if picture is not None:
            coarse = math.ceil(picture.shape[1] / PAGE_WIDTH)
            image = self._rerun.Image(picture[::coarse, ::coarse] if self._is_page else picture)
            camera = image if self._is_page else image.compress(jpeg_quality=JPEG_QUALITY)
        screen.show(camera, result)
        if self._timeline and all(each.extent_mm for each in self._screens):
            self.stream.send_blueprint(_layout(self._rerun, self._screens, self._timeline))
            self._timeline = ""


class _Screen:
    """Entities of one sensor.

    Attributes
    ----------
    prefix, name : str
        Of the entities; of the sensor.
    extent_mm : (float, float) or None
        Width and height of the gel, after the first frame.
    last_s : float
        When a frame was shown, as `time.monotonic` gives it.
    """

    def __init__(self, rerun: Any, stream: Any, is_page: bool, prefix: str, name: str) -> None:
        self._rerun, self._stream, self._is_page, self.prefix, self.name = rerun, stream, is_page, prefix, name
        self._highest_mm = 0.0
        self._shape: tuple[int, ...] = ()
        self.extent_mm: tuple[float, float] | None = None
        self.last_s = -math.inf

    def show(self, camera: Any, result: Result | DeviceFrame) -> None:
        rerun, contact = self._rerun, result.contact
        height = result.height_mm.astype(np.float32)
        if height.shape != self._shape:
            self._begin(height.shape)
            rows, columns = height.shape
            self.extent_mm = (columns * result.pixel_pitch_mm * result.pixel_aspect, rows * result.pixel_pitch_mm)
        if (highest := max(LEAST_RANGE_MM, float(height.max()))) > self._highest_mm:
            self._highest_mm = highest
            bar = rerun.Image(_bar(Scale(0.0, highest)))
            self._log("scale", bar, static=self._is_page)  # a page that opens later gets what is static first
        if camera is not None:
            self._log("camera", camera)
        heights = [0.0, self._highest_mm]
        origin_mm = result.origin_mm if isinstance(result, DeviceFrame) else (0.0, 0.0)
        self._log("height", rerun.DepthImage(height, meter=MM_PER_M, colormap="viridis", depth_range=heights))
        self._log(
            "surface",
            rerun.Mesh3D.from_fields(
                vertex_positions=vertices_mm(height, result.pixel_pitch_mm, result.pixel_aspect, origin_mm),
                vertex_normals=_normals(_slopes(result)),
                vertex_colors=Scale(0.0, self._highest_mm).colours(height).reshape(-1, 3),
            ),
        )
        row, column = contact.centroid_mm or (math.nan, math.nan)
        self._log("contact/touching", rerun.Scalars(float(contact.touching)))
        self._log("contact/peak_height_mm", rerun.Scalars(contact.peak_height_mm))
        self._log("contact/area_mm2", rerun.Scalars(contact.area_mm2))
        self._log("contact/centroid_mm", rerun.Scalars([column, -row]))

    def _begin(self, shape: tuple[int, ...]) -> None:
        """Log what does not change."""
        rerun, self._shape = self._rerun, shape
        self._log("surface", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._log("surface", rerun.Transform3D(scale=[1.0, 1.0, TIMES_AS_TALL]), static=True)
        self._log("surface", rerun.Mesh3D.from_fields(triangle_indices=triangles(*shape)), static=True)
        self._log("contact/centroid_mm", rerun.SeriesLines(names=["x", "y"]), static=True)

    def _log(self, entity: str, what: Any, static: bool = False) -> None:
        self._stream.log(self.prefix + entity, what, static=static)


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


def _bar(scale: Scale) -> np.ndarray:
    """Draw the colours of a scale above their values, uint8 (rows, columns, 3)."""
    width, height = BAR
    canvas = Image.new("RGB", (width + 2 * MARGIN, height + 2 * LETTERS), BACKGROUND)
    draw, letters = ImageDraw.Draw(canvas), ImageFont.load_default(LETTERS)
    colours = scale.colours(np.linspace(scale.low, scale.high, width)[None].repeat(height, axis=0))
    canvas.paste(Image.fromarray(colours), (MARGIN, LETTERS // 4))
    step = round_number((scale.high - scale.low) / 3)
    for multiple in range(round(scale.low / step), math.floor(scale.high / step) + 1):
        x = MARGIN + (multiple * step - scale.low) / (scale.high - scale.low) * width
        draw.line((x, height, x, height + LETTERS // 2), INK, 2)
        draw.text((x, height + LETTERS // 2), f"{multiple * step:g}", INK, letters, anchor="ma")
    draw.text((MARGIN + width, height + LETTERS // 2), scale.unit, INK, letters, anchor="ma")
    return np.asarray(canvas)


def _layout(rerun: Any, screens: Sequence[_Screen], timeline: str) -> Any:
    """Arrange the views, a row for each sensor: pictures on the left, the surface in the middle, then the contact."""
    views = rerun.blueprint
    rows = [_row(views, screen, len(screens) > 1) for screen in screens]
    panel = views.TimePanel(timeline=timeline, state="collapsed")
    return views.Blueprint(
        rows[0] if len(rows) == 1 else views.Vertical(*rows),
        views.BlueprintPanel(state="collapsed"),
        views.SelectionPanel(state="collapsed"),
        panel,
    )


def _row(views: Any, screen: _Screen, is_one_of_many: bool) -> Any:
    """Arrange the views of a sensor."""
    assert screen.extent_mm is not None
    width, height = screen.extent_mm
    right, down, up = (share * width for share in EYE)
    prefix, of = (screen.prefix, f" of {screen.name}") if is_one_of_many else ("", "")
    eye = views.EyeControls3D(
        position=[right, -height / 2 - down, up], look_target=[width / 2, -height / 2, 0], eye_up=[0, 0, 1]
    )
    pictures = views.Horizontal if is_one_of_many else views.Vertical
    series = {"peak_height_mm": "peak height, mm", "area_mm2": "area, mm2"}
    if not is_one_of_many:
        series = {"touching": "touching", **series, "centroid_mm": "centroid, mm"}
    return views.Horizontal(
        pictures(
            views.Spatial2DView(origin=f"{prefix}camera", name=f"camera{of}"),
            views.Vertical(
                views.Spatial2DView(origin=f"{prefix}height", name="height, mm"),
                views.Spatial2DView(origin=f"{prefix}scale", name="colours of the height"),
                row_shares=[4, 1],
            ),
        ),
        views.Spatial3DView(
            origin=f"/{prefix.rstrip('/')}",
            contents=f"/{prefix}surface",
            name=f"surface, {TIMES_AS_TALL:g} times as tall",
            eye_controls=eye,
            line_grid=views.LineGrid3D(visible=False),
        ),
        views.Vertical(
            *(views.TimeSeriesView(origin=f"{prefix}contact/{entity}", name=name) for entity, name in series.items())
        ),
        column_shares=[2 if is_one_of_many else 1, 2, 1],
    )
