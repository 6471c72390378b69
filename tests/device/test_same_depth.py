# SPDX-License-Identifier: Apache-2.0
"""A device gives of pictures what the package gives, with its doubts; another depth is refused."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.gradient.flat_field import captured_gains
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormatName, received
from tactile_depth.chip.table_entries import reference_entries
from tactile_depth.device import captures
from tactile_depth.sensor.sensor import TOO_DARK, equal_areas
from tests.device.cable import Cable
from tests.device.conftest import Plug
from tests.device.test_device import grid_picture, require_equal, singles

GRID = (24, 32)
NAMES: tuple[DepthFormatName, ...] = get_args(DepthFormatName)
LIGHTS = (0.9, 1.0, 1.05, 1.1, 1.2)
FIRST = r"call load\(\) first"


@pytest.fixture(scope="module")
def pipeline(sample: td.Sample) -> td.Pipeline:
    return td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID, model="quadratic")


def in_light(image: np.ndarray, light: Any) -> np.ndarray:
    return np.clip(np.rint(image * light), 0, 255).astype(np.uint8)


def told(call: Callable[[], Any]) -> tuple[Any, list[str]]:
    """Return what a call returns, and the warnings that it gives."""
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        result = call()
    return result, [str(each.message) for each in given]


@pytest.fixture(scope="module")
def doubtful(sample: td.Sample) -> list[np.ndarray]:
    """Pictures with and without doubts: other light, light that changes across, clipped pixels, gel that stands out."""
    across = np.linspace(0.95, 1.05, sample.image.shape[1])[:, None]
    return [
        *(in_light(sample.image, light) for light in LIGHTS),
        in_light(sample.image, across),
        in_light(sample.image, across[::-1]),
        in_light(sample.image, 0.8),
    ]


def test_pictures_have_the_doubts_of_the_package(
    device: td.Device, pipeline: td.Pipeline, doubtful: list[np.ndarray]
) -> None:
    frames, warned = told(lambda: list(device.depth(doubtful)))
    results, expected = told(lambda: singles(pipeline, doubtful))
    require_equal(frames, results)
    assert warned == expected
    assert len(set(map(str, warned))) >= 3
    assert any(frame.warnings for frame in frames)


def test_a_stream_has_the_doubts_of_the_package_and_warns_once_of_each_kind(
    device: td.Device, pipeline: td.Pipeline, doubtful: list[np.ndarray]
) -> None:
    pictures = [picture for picture in doubtful for _ in range(3)]
    frames, warned = told(lambda: list(device.depth(iter(pictures))))
    results, expected = told(lambda: list(pipeline.stream(pictures)))
    require_equal(frames, results)
    assert warned == expected
    assert len(warned) < sum(bool(frame.warnings) for frame in frames)


def test_a_picture_in_other_light_is_that_of_a_pipeline(
    device: td.Device, pipeline: td.Pipeline, sample: td.Sample
) -> None:
    for light in LIGHTS:
        picture = in_light(sample.image, light)
        (frame,) = device.depth([picture])
        np.testing.assert_array_equal(frame.codes, pipeline(picture).codes)


def test_right_light_has_no_doubt(device: td.Device, sample: td.Sample) -> None:
    pictures = [in_light(sample.image, 1 + 0.002 * np.sin(index)) for index in range(20)]
    assert not any(frame.warnings for frame in device.depth(iter(pictures)))


def test_the_rate_of_the_light_is_that_of_the_device(
    device: td.Device, pipeline: td.Pipeline, sample: td.Sample
) -> None:
    device.registers["LIGHT"] = 2 << 4  # a program that was killed has left `follow` at 0
    stream = pipeline.new_stream()
    assert stream.light is not None
    stream.light.rate = 2
    pictures = [in_light(sample.image, 0.93)] * 4
    require_equal(list(device.depth(iter(pictures))), list(pipeline.stream(pictures, stream)))


def test_light_that_changes_over_a_line_that_loses_packets(cable: Cable, device: td.Device, sample: td.Sample) -> None:
    """Depth that got lost behind the device has moved its light gains, a picture that got lost before it has not."""
    pictures = [in_light(sample.image, 1 + 0.05 * np.sin(index)) for index in range(40)]
    assert cable.setup is not None
    cable.setup.damage["drop"] = 0.05
    frames: list[td.DeviceFrame] = []
    while device.status().lost < 3:
        frames += device.depth(iter(pictures))
    cable.setup.damage.clear()
    assert frames


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("grid", [GRID, (25, 32)])
def test_masks_have_the_values_of_the_depth(
    name: DepthFormatName, grid: tuple[int, int], sample: td.Sample, plug: Plug
) -> None:
    reference = sample.reference.copy()
    reference[:40, :50, 0] = 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pipeline = td.Pipeline(sample.sensor, reference, grid=grid, model="quadratic")
        with td.Device(plug(pipeline).address, pipeline, depth_format=name) as device:
            device.load()
            (frame,) = device.depth(sample.image)
        result = pipeline(sample.image)
    assert result.dark.any()
    for wanted, mask in ((result.dark, frame.dark), (result.outside, frame.outside)):
        assert mask is not None
        if name == "averaged":
            low = wanted[grid[0] % 2 :]
            wanted = low[::2, ::2] | low[1::2, ::2] | low[::2, 1::2] | low[1::2, 1::2]
        np.testing.assert_array_equal(mask, wanted)
    assert frame.warnings == result.warnings
    assert frame.saturations == result.saturations


def filmed(
    pipeline: td.Pipeline, plug: Plug, images: list[np.ndarray], count: int, **form: Any
) -> list[td.DeviceFrame]:
    """Return frames of a device whose camera gives pictures, one after another and then the last one again."""
    camera = np.stack([frame for _, frame in pipeline.reader.pictures(images, "pictures")[0]])
    cable = plug(pipeline, camera=camera[-1:], camera_s=0.002)
    with td.Device(cable.address, pipeline, **form) as device:
        device.load()
        assert cable.setup is not None
        cable.setup.camera, cable.setup.camera_s = camera, 0.005
        return list(itertools.islice(device.depth(), count))


@pytest.mark.parametrize("name", NAMES)
def test_a_camera_in_right_light_has_no_doubt(
    name: DepthFormatName, pipeline: td.Pipeline, sample: td.Sample, plug: Plug
) -> None:
    images = [in_light(image, 1 + 0.002 * np.sin(n)) for n in range(10) for image in (sample.image, sample.reference)]
    frames, warned = told(lambda: filmed(pipeline, plug, images, 100, depth_format=name))
    assert [text[:50] for text in warned] == ["the reference is not from the device's own camera:"]
    for frame in frames:
        assert (frame.warnings, frame.saturations, frame.dark, frame.outside) == ((), None, None, None)
        assert frame.light_gains == pytest.approx(1, abs=0.03)
        assert frame.flags == frame.record.flags
        assert frame.flags._replace(light_gains=(0, 0, 0)) == FrameFlags()


@pytest.mark.parametrize(
    ("scene", "choices", "text"),
    [
        (
            "dim",
            {},
            "its light differs from that of the reference by .* or more, and the light gains do not undo it: take",
        ),
        (
            "flicker",
            {},
            "its light differs from that of the reference, and the light gains do not undo it yet: take a ref",
        ),
        (
            "deep",
            {"depth_range_mm": 0.5},
            r"\d+ of its depths clipped, heights there are too small: give a larger depth_range",
        ),
        ("black", {}, "100 % of its pixels are black, which reads as flat gel: switch the lights on"),
        ("half black", {}, "50 % of its pixels are black, which reads as flat gel: switch the lights on"),
        ("exchanged", {}, "its gel stands out by .* mm, as if something touched it in the reference: take a reference"),
    ],
)
@pytest.mark.parametrize("name", NAMES)
def test_what_a_device_says_of_its_camera(
    scene: str, choices: dict[str, Any], text: str, name: DepthFormatName, sample: td.Sample, plug: Plug
) -> None:
    images = {"dim": [in_light(sample.image, 0.4)], "flicker": [in_light(sample.image, 0.8), sample.image]}
    lit = (sample.image * 0, np.where(np.arange(len(sample.image))[:, None, None] % 80 < 40, sample.image, 15))
    images |= {name: [image.astype(np.uint8)] for name, image in zip(("black", "half black"), lit, strict=True)}
    is_exchanged = scene == "exchanged"
    reference = sample.image if is_exchanged else sample.reference
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pipeline = td.Pipeline(sample.sensor, reference, grid=GRID, model="quadratic", **choices)
    shown = [sample.reference] if is_exchanged else images.get(scene, [sample.image])
    frames, warned = told(lambda: filmed(pipeline, plug, shown, 40, depth_format=name))
    (said,) = (each for each in warned if each.startswith("frame "))
    assert re.fullmatch(rf"frame \d+: {text}.*", said)
    assert re.search(text, frames[-1].warnings[-1])


@pytest.mark.parametrize("stream", [False, True])
def test_a_black_spot_in_a_picture_that_is_sent_is_that_of_the_package(
    stream: bool, cable: Cable, device: td.Device, sample: td.Sample
) -> None:
    """The device counts black pixels of its camera as dark, but not those of pictures that the host has checked."""
    spotted = sample.image.copy()
    spotted[100:110, 100:110] = 0
    assert grid_picture(device.pipeline, spotted).max(axis=-1).min() < TOO_DARK
    for picture in (sample.image, spotted):
        (frame,) = device.depth([picture], stream=stream)
        assert not frame.flags.dark
    device.capture_zero([spotted])
    assert len(list(device.depth([spotted]))) == 1


def test_a_device_with_lanes(pipeline: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    """Its depth is that of one value a clock."""
    cable = plug(pipeline)
    cable.unplug()
    assert cable.setup is not None
    cable.setup.config = replace(pipeline.config, lanes=4)
    cable.plug()
    with td.Device(cable.address, pipeline) as device:
        device.load()
        (frame,) = device.depth([sample.image])
        device.capture_reference([sample.reference])
        device.capture_zero([sample.reference])
        assert len(list(device.depth([sample.image]))) == 1
    np.testing.assert_array_equal(frame.codes, pipeline(sample.image).codes)


def test_a_second_depth_waits_for_the_end_of_the_first(pipeline: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    with td.Device(plug(pipeline).address, pipeline) as device:
        device.load()
        first = device.depth(iter([sample.image] * 3))
        next(first)
        with pytest.raises(td.InputError, match=r"a depth\(\), load\(\) or capture has not ended: end its loop"):
            next(device.depth([sample.image]))
        for change in (device.load, lambda: device.capture_reference([sample.reference]), device.capture_zero):
            with pytest.raises(td.InputError, match="has not ended: end its loop"):
                change()
        assert len(list(first)) == 2
        assert len(list(device.depth([sample.image]))) == 1


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("bottom_first", [True, False])
def test_codes_that_are_received_are_those_of_words_in_each_format(name: DepthFormatName, bottom_first: bool) -> None:
    codes = np.random.default_rng(2).integers(-(1 << 23), 1 << 23, (5, 8), np.int32)
    got = received(codes, FORMATS[name], 24, 8, bottom_first)
    if name == "words":
        np.testing.assert_array_equal(got, codes)
        return
    values = codes.astype(float)
    if name == "averaged":
        values = (values[1:] if bottom_first else values[:4]).reshape(2, 2, 4, 2).mean(axis=(1, 3))
    np.testing.assert_array_equal(got, np.rint(values / 256).clip(-32768, 32767) * 256)


def test_a_capture_of_the_camera_is_not_known(steady: td.Pipeline, sample: td.Sample, plug: Plug) -> None:
    ((_, camera),) = steady.reader.pictures(in_light(sample.reference, 0.9), "picture")[0]
    cable = plug(steady, camera=camera[None], camera_s=0.002)
    with td.Device(cable.address, steady) as device:
        device.load()
        device.capture_reference(frames=1)
        with pytest.raises(td.DeviceError, match=rf"the reference of the device is not known .*: {FIRST}"):
            list(device.depth([sample.image]))
        with pytest.raises(td.DeviceError, match=FIRST):
            device.capture_zero(sample.reference)
        assert next(device.depth()).codes.shape == steady.grid


def test_a_reference_that_is_not_of_the_camera_is_warned_of_once(
    steady: td.Pipeline, sample: td.Sample, plug: Plug
) -> None:
    camera = grid_picture(steady, in_light(sample.reference, 0.97))[None]
    cable = plug(steady, camera=camera, camera_s=0.002)
    with td.Device(cable.address, steady) as device:
        device.load()
        with pytest.warns(
            td.InputWarning, match=r"not from the device's own camera: .*: with .* call capture_reference\(\)"
        ):
            next(device.depth())
        assert told(lambda: next(device.depth()))[1] == []
    with td.Device(cable.address, steady) as device:
        device.load()
        device.capture_reference(frames=1)
        assert told(lambda: next(device.depth()))[1] == []
    with pytest.warns(td.InputWarning, match="from a capture before"), td.Device(cable.address, steady) as device:
        assert told(lambda: next(device.depth()))[1] == []


@pytest.mark.parametrize("light", [1.0, np.linspace(0.95, 1.05, 320)[:, None]])
@pytest.mark.parametrize("touched", [False, True])
def test_a_zero_offset_of_the_camera_is_checked(
    touched: bool, light: Any, pipeline: td.Pipeline, sample: td.Sample, plug: Plug
) -> None:
    untouched, seen = (
        grid_picture(pipeline, in_light(image, light))
        for image in (sample.reference, (sample.reference, sample.image)[touched])
    )
    cable = plug(pipeline, camera=untouched[None], camera_s=0.02)
    assert cable.setup is not None
    with td.Device(cable.address, pipeline) as device:
        device.load()
        device.capture_reference(frames=1)
        cable.setup.camera = seen[None]
        _, warned = told(lambda: device.capture_zero(frames=1))
        cable.setup.camera = untouched[None]
        frames, more = told(lambda: list(itertools.islice(device.depth(), 4)))
    assert len(warned) == touched
    assert more == []
    assert [list(frame.warnings) for frame in frames] == [warned] * 4
    for text in warned:
        assert re.fullmatch(r"the zero offset that .* camera: it is not smooth .* touched the gel: capture .*", text)


@pytest.fixture(scope="module")
def mini() -> tuple[td.Pipeline, np.ndarray]:
    """Pipeline of a real sensor, and its calibration's own picture without contact on the grid."""
    sensor = td.load("gelsight-mini")
    assert sensor.untouched is not None
    assert sensor.camera is not None
    own = np.rint(sensor.untouched).clip(0, 255).astype(np.uint8)
    picture = np.array(
        Image.fromarray(own).resize((sensor.camera.columns, sensor.camera.rows), Image.Resampling.BICUBIC)
    )
    pipeline = td.Pipeline(sensor, picture, grid=(48, 64), model="quadratic", light_gains=False)
    return pipeline, next(pipeline.reader.pictures(picture, "picture")[0])[1]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda rest: rest, None),
        (lambda rest: rest[..., ::-1], "red and blue are exchanged"),
        (lambda rest: rest[..., [1, 0, 2]], "red and green are exchanged"),
        (lambda rest: rest[:, ::-1], "it is mirrored left to right"),
        (lambda rest: rest[::-1], "it is mirrored top to bottom"),
        (lambda rest: rest[::-1, ::-1], "it is rotated by 180 degrees"),
        (lambda rest: np.repeat(rest[..., 1:2], 3, axis=-1), "it is grey"),
        (lambda rest: rest // 200, "under 16 grey levels in a colour"),
    ],
)
def test_a_reference_of_the_camera_is_checked(
    wrong: Callable[[np.ndarray], np.ndarray],
    message: str | None,
    mini: tuple[td.Pipeline, np.ndarray],
    plug: Plug,
) -> None:
    """Colours in another order are those of another Bayer phase."""
    pipeline, rest = mini
    cable = plug(pipeline, camera=np.ascontiguousarray(wrong(rest))[None], camera_s=0.05)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        if message is None:
            _, warned = told(lambda: device.capture_reference(frames=1))
            assert warned == []
            captured = cable.serving.device._used("reference")[:, 0]
            gains = captured_gains(rest[None], pipeline.config)
            np.testing.assert_array_equal(captured, reference_entries(gains)[:, 0])
            assert next(device.depth()).codes.shape == pipeline.grid
            return
        with pytest.raises(td.InputError, match=f"the reference that the device took from its camera: {message}"):
            device.capture_reference(frames=1)
        with pytest.raises(td.DeviceError, match=FIRST):
            next(device.depth())
        device.load()
        assert next(device.depth()).codes.shape == pipeline.grid


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda rest: 0.9 * rest, None),
        (lambda rest: rest * np.linspace(0.97, 1.03, rest.shape[1])[:, None], None),
        (lambda rest: rest - 10, "another gamma, brightness, contrast or saturation"),
        (lambda rest: 255 * (rest / 255) ** 1.15, "another gamma, brightness, contrast or saturation"),
    ],
)
@pytest.mark.parametrize("grid", [(48, 64), (64, 64)])
def test_a_reference_of_the_camera_has_the_tone_of_the_calibration(
    grid: tuple[int, int], change: Callable[[np.ndarray], np.ndarray], message: str | None, mini: Any
) -> None:
    """A square grid cuts the calibration's own picture too."""
    sensor = mini[0].reader.sensor
    own = equal_areas(sensor.untouched, (sensor.camera.rows, sensor.camera.columns))
    pipeline = td.Pipeline(sensor, np.rint(own).astype(np.uint8), grid=grid, model="quadratic")
    gains = captured_gains(grid_picture(pipeline, in_light(change(own), 1))[None], pipeline.config)
    (doubts, _), warned = told(lambda: captures.check_reference_of_camera(pipeline, reference_entries(gains)[:, 0]))
    assert [*map(str, doubts)] == warned
    assert len(warned) == (message is not None)
    assert message is None or message in warned[0]


def test_the_message_names_the_picture(cable: Cable, device: td.Device, sample: td.Sample) -> None:
    model = cable.serving.device
    frames = device.depth(iter([sample.image] * 3))
    next(frames)
    model.tables["coefficients"][:, 3] += 1 << 8
    with pytest.raises(td.DeviceError, match=re.escape("picture 1: the device computes another depth")):
        next(frames)
