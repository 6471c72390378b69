# SPDX-License-Identifier: Apache-2.0
"""A device on a host: tables, captures, thresholds and depth, as the package computes them."""

from __future__ import annotations

import itertools
import re
import textwrap
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from commands.common.repository import ROOT
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.table_entries import table_entries
from tests.device.cable import Cable
from tests.device.conftest import GRID, Plug

OF_COLOURS = ("flat_field", "light_gains", "polynomial_gradient")  # nodes whose clips a device tells of together
CONFIGURATIONS: Mapping[str, Mapping[str, Any]] = {
    "cubic": {},
    "quadratic": {"model": "quadratic"},
    "colours": {"model": "lut"},
    "spectral": {"solver": "spectral", "boundary": "dirichlet", "grid": (16, 16)},
    "without zero offset": {"zero_offset": False},
    "without light gains": {"light_gains": False, "data_width": 20},
}


def require_equal(frames: list[td.DeviceFrame], results: list[td.Result]) -> None:
    """Require that frames of a device are what the package computes."""
    assert [frame.picture for frame in frames] == list(range(len(results)))
    for frame, result in zip(frames, results, strict=True):
        np.testing.assert_array_equal(frame.codes, result.codes)
        np.testing.assert_array_equal(frame.depth_mm, result.depth_mm)
        assert frame.height_mm.dtype == np.float32
        np.testing.assert_array_equal(frame.height_mm, result.height_mm.astype(np.float32))
        assert frame.untouched_mm == result.untouched_mm
        np.testing.assert_array_equal(frame.mask, result.mask)
        assert frame.contact.touching == result.contact.touching
        assert frame.contact.record[3:-1] == result.contact.record[3:-1]
        assert frame.contact.peak_mm == result.contact.peak_mm
        if frame.recorder == result.recorder:  # without hysteresis
            assert frame.contacts == result.contacts
        assert frame.threshold_mm == result.threshold_mm
        require_known(frame, result)


def require_known(frame: td.DeviceFrame, result: td.Result) -> None:
    """Require that a frame of a picture that was sent knows of it what the package does."""
    for name in ("warnings", "saturations", "light_gains", "dark", "outside"):
        np.testing.assert_equal(getattr(frame, name), getattr(result, name), name)
    require_flags(frame.flags, result)


def require_flags(flags: FrameFlags, result: td.Result) -> None:
    """Require that the device says of a picture what the package computes of it."""
    clipped, gains = set(result.saturations), result.light_gains
    solver = clipped - {*OF_COLOURS, "zero_offset"}
    marks = bool(clipped & {*OF_COLOURS}), bool(solver), "zero_offset" in clipped
    assert flags[:3] == marks
    assert flags.light_gains == ((0, 0, 0) if gains is None else tuple(np.rint(gains / LIGHT_GAIN.lsb)))
    assert flags.dark == result.dark.sum()
    assert flags.steep <= result.outside.sum()


def singles(pipeline: td.Pipeline, pictures: Sequence[np.ndarray]) -> list[td.Result]:
    return [pipeline(picture, name=f"pictures[{index}]") for index, picture in enumerate(pictures)]


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_depth_is_that_of_the_package(name: str, sample: td.Sample, pictures: list[np.ndarray], plug: Plug) -> None:
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference, **{"grid": GRID, **CONFIGURATIONS[name]})
    with td.Device(plug(pipeline).address, pipeline) as device:
        device.load()
        require_equal(list(device.depth(iter(pictures))), list(pipeline.stream(pictures)))


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_a_picture_that_stands_for_itself(name: str, sample: td.Sample, pictures: list[np.ndarray], plug: Plug) -> None:
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference, **{"grid": GRID, **CONFIGURATIONS[name]})
    if pipeline.config.light_gains:
        pictures = [*pictures, (0.97 * sample.image).astype(np.uint8)]
    with td.Device(plug(pipeline).address, pipeline) as device:
        device.load()
        for _ in range(2):
            require_equal(list(device.depth(pictures)), singles(pipeline, pictures))
        assert device.registers["LIGHT.follow"] == 1
        require_equal(list(device.depth(pictures, stream=True)), list(pipeline.stream(pictures)))
        require_equal(list(device.depth(iter(pictures), stream=False)), singles(pipeline, pictures))


def test_the_depth_of_a_camera_is_a_stream(device: td.Device) -> None:
    with pytest.raises(td.InputError, match="stream=False: without pictures: give pictures"):
        next(device.depth(stream=False))
    with pytest.raises(td.InputError, match="stream=1: accepted are True, False"):
        next(device.depth(stream=1))  # type: ignore[arg-type]


def test_a_sensor_without_reference(plug: Plug) -> None:
    pipeline = td.Pipeline(td.load("synthetic"), grid=(16, 16))
    picture = np.full((16, 16, 3), 128, np.uint8)
    with td.Device(plug(pipeline).address, pipeline) as device:
        device.load()
        require_equal(list(device.depth(picture)), [pipeline(picture)])
        with pytest.raises(td.InputError, match="takes colours as sent"):
            device.capture_reference(picture)


def test_load_writes_every_table(cable: Cable, device: td.Device, pipeline: td.Pipeline) -> None:
    model = cable.serving.device
    for name, entries in table_entries(pipeline.sensor, pipeline.config, pipeline.zero_codes).items():
        np.testing.assert_array_equal(model.tables[name][model.registers.banks.bank >> TABLES[name] & 1], entries)
    assert device.registers["TABLE_COMMIT"] == 0
    assert device.registers["PITCH"] == round(pipeline.pixel_pitch_mm * 1e6)


def test_each_call_of_depth_begins_a_stream(
    device: td.Device, pipeline: td.Pipeline, pictures: list[np.ndarray]
) -> None:
    """The light gains that pictures in other light have moved do not act on the next stream."""
    dim = [(0.9 * picture).astype(np.uint8) for picture in pictures]
    for _ in range(2):
        require_equal(list(device.depth(iter(dim))), list(pipeline.stream(dim)))


@pytest.mark.parametrize("kind", ["array", "generator", "path", "single"])
def test_pictures_are_those_of_a_pipeline(
    kind: str, device: td.Device, pipeline: td.Pipeline, sample: td.Sample, tmp_path: Any
) -> None:
    stack = np.stack([sample.reference, sample.image])
    np.save(tmp_path / "stack.npy", stack)
    given: Any = {"array": stack, "generator": iter(stack), "path": tmp_path / "stack.npy", "single": sample.image}
    if kind == "generator":
        expected = list(pipeline.stream(stack))
    else:
        expected = [pipeline(given[kind])] if kind == "single" else list(pipeline(given[kind]))
    require_equal(list(device.depth(given[kind])), expected)


def test_a_stream_leaves_out_and_counts_a_picture_that_gives_no_depth_and_a_list_refuses_it(
    device: td.Device, pipeline: td.Pipeline, sample: td.Sample
) -> None:
    pictures = [sample.image, np.zeros_like(sample.image), sample.image]
    with pytest.warns(td.InputWarning, match="left out and counted"):
        frames = list(device.depth(iter(pictures)))
    assert [(frame.picture, frame.lost) for frame in frames] == [(0, 0), (2, 1)]
    assert device.status().lost == 1
    frames_of_each = device.depth(pictures)
    next(frames_of_each)
    with pytest.raises(td.InputError, match=r"^pictures\[1\]: it is black"):
        next(frames_of_each)
    require_equal(list(device.depth(iter(pictures[:1]))), list(pipeline.stream(pictures[:1])))
    others = [sample.image[:, : sample.image.shape[1] // 2], None]
    with pytest.warns(td.InputWarning, match="left out and counted: picture 1: "):
        frames = list(device.depth(iter([sample.image, *others, sample.image])))  # type: ignore[arg-type]
    assert [frame.picture for frame in frames] == [0, 3]
    with pytest.raises(td.InputError):
        list(device.depth(iter(others)))  # type: ignore[arg-type]


HARMS = {"flipped": "a bit of the device had flipped", "residual": "does not fit its slopes"}


@pytest.mark.parametrize("harm", HARMS)
def test_a_frame_that_the_device_doubts_has_a_warning(
    cable: Cable, device: td.Device, sample: td.Sample, harm: str
) -> None:
    cable.serving.device.harms = (harm,)
    with pytest.warns(td.InputWarning, match=HARMS[harm]):
        (frame,) = device.depth(sample.image)
    assert [HARMS[harm] in warning for warning in frame.warnings] == [True]


def test_captures_are_those_of_the_package(device: td.Device, sample: td.Sample, pictures: list[np.ndarray]) -> None:
    """Capture the reference and the zero offset in another light than that of the calibration's reference."""
    levels = np.array([0.93, 0.95, 0.97, 0.96])
    untouched = [(level * sample.reference.astype(float)).astype(np.uint8) for level in levels]
    expected = td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID)
    expected.capture_reference(untouched)
    device.capture_reference(untouched)
    require_equal(list(device.depth(iter(pictures))), list(expected.stream(pictures)))
    expected.capture_zero(untouched[:2])
    device.capture_zero(untouched[:2])
    require_equal(list(device.depth(iter(pictures))), list(expected.stream(pictures)))
    assert device.registers["LIGHT.follow"] == 1


def test_load_replaces_captures(
    device: td.Device, pipeline: td.Pipeline, sample: td.Sample, pictures: list[np.ndarray]
) -> None:
    device.capture_reference((0.9 * sample.reference).astype(np.uint8))
    device.load()
    require_equal(list(device.depth(iter(pictures))), list(pipeline.stream(pictures)))


def test_load_ends_a_capture_that_was_left(device: td.Device, pipeline: td.Pipeline, sample: td.Sample) -> None:
    device.registers["REFERENCE_CAPTURE"] = 1 << 8 | 2
    device.registers["ZERO_CAPTURE"] = 1 << 8 | 3
    device.load()
    require_equal(list(device.depth([sample.image])), singles(pipeline, [sample.image]))


@pytest.mark.parametrize("count", [0, 3])
def test_a_capture_takes_a_power_of_two_of_pictures(count: int, device: td.Device, sample: td.Sample) -> None:
    for capture in (device.capture_reference, device.capture_zero):
        with pytest.raises(td.InputError):
            capture([sample.reference] * count)
        with pytest.raises(td.InputError, match="frames"):
            capture(frames=count)


def test_thresholds(device: td.Device, sample: td.Sample) -> None:
    device.set_thresholds(touch_mm=0.05, release_mm=0.03, area_mm=0.2)
    expected = td.Pipeline(
        sample.sensor, reference=sample.reference, grid=GRID, threshold_mm=0.05, area_threshold_mm=0.2
    )
    codes = {name: device.registers[name] for name in ("THRESHOLD", "OFF_THRESHOLD", "AREA_THRESHOLD", "MINIMUM_AREA")}
    assert tuple(codes.values()) == expected.settings(0.05, 0.03, 0.2)[:-1]
    require_equal(list(device.depth([sample.image])), singles(expected, [sample.image]))
    device.load()
    assert {name: device.registers[name] for name in codes} == codes, "load keeps them"
    device.set_thresholds(0.08)
    assert device.registers["OFF_THRESHOLD"] == device.registers["THRESHOLD"]
    device.set_thresholds(release_mm=0.02)
    assert device.registers["THRESHOLD"] == round(0.08 / expected.depth_lsb_mm)


def test_a_hysteresis_does_not_count_for_pictures_by_themselves(device: td.Device, sample: td.Sample) -> None:
    mild = np.rint(sample.reference + 0.25 * (sample.image.astype(float) - sample.reference)).astype(np.uint8)
    (frame,) = device.depth([mild])
    device.set_thresholds(1.3 * frame.contact.peak_mm, release_mm=0.5 * frame.contact.peak_mm)
    off = device.registers["OFF_THRESHOLD"]
    touching = [[frame.contact.touching for frame in device.depth(each)] for each in ([sample.image, mild], [mild])]
    assert touching == [[True, False], [False]]
    for _ in device.depth([sample.image, mild]):
        assert device.registers["OFF_THRESHOLD"] == off
        break
    assert [frame.contact.touching for frame in device.depth(iter([sample.image, mild]))] == [True, True]


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"touch_mm": 0}, "touch_mm=0: accepted is a depth above 0"),
        ({"touch_mm": 100}, "touch_mm=100"),
        ({"touch_mm": "1"}, "touch_mm=1"),
        ({"touch_mm": float("nan")}, "touch_mm=nan"),
        ({"touch_mm": 0.05, "release_mm": 0.06}, "release_mm=0.06: accepted is at most touch_mm, 0.05"),
        ({"release_mm": 0.2}, "release_mm=0.2"),
        ({"touch_mm": 0.04, "release_mm": -1}, "release_mm=-1"),
        ({"area_mm": -0.1}, "area_mm=-0.1"),
    ],
)
def test_thresholds_that_are_refused(wanted: dict[str, Any], message: str, device: td.Device) -> None:
    before = device.registers["THRESHOLD"]
    with pytest.raises(td.InputError, match=message):
        device.set_thresholds(**wanted)
    assert device.registers["THRESHOLD"] == before


def test_frames_have_numbers_and_times(device: td.Device, sample: td.Sample) -> None:
    began = time.time()
    frames = list(device.depth(iter([sample.image] * 3)))
    assert np.diff([frame.number for frame in frames]).tolist() == [1, 1]
    times = [began, *(frame.time_s for frame in frames), time.time()]
    assert times == sorted(times)
    assert [frame.lost for frame in frames] == [0, 0, 0]
    assert frames[1] == frames[1]
    assert frames[1] != frames[2]
    assert repr(frames[0]).startswith(f"DeviceFrame({frames[0].number}, 16x12, height up to ")


def test_a_loop_that_is_left_disturbs_nothing(
    device: td.Device, pipeline: td.Pipeline, pictures: list[np.ndarray]
) -> None:
    for frame in device.depth(itertools.cycle(pictures)):
        if frame.picture == 2:
            break
    require_equal(list(device.depth(iter(pictures))), list(pipeline.stream(pictures)))
    assert device.status().lost == 0


@pytest.mark.parametrize("stream", [True, False])
def test_a_loop_that_ends_after_its_device_is_closed(
    stream: bool, cable: Cable, pipeline: td.Pipeline, sample: td.Sample
) -> None:
    with td.Device(cable.address, pipeline) as device:
        device.load()
        frames = device.depth([sample.image] * 3, stream=stream)
        next(frames)
    with pytest.raises(td.DeviceError, match="is closed"):
        next(frames)
    frames.close()  # type: ignore[attr-defined]


def test_registers_between_the_frames_of_a_loop(device: td.Device, pictures: list[np.ndarray]) -> None:
    counts = [device.registers["FRAMES_OUT"] for _ in device.depth(iter(pictures))]
    assert np.diff(counts).tolist() == [1, 1, 1]


def test_status(device: td.Device, sample: td.Sample) -> None:
    before = device.status()
    assert len(list(device.depth(iter([sample.image] * 2)))) == 2
    status = device.status()
    assert (status.rows, status.columns, status.data_width) == (*GRID, 24)
    assert [after - past for past, after in zip(before[4:17], status[4:17], strict=True)] == [
        *(2, 0, 0, 0, 2, 0),
        *(2, 2, 0, 0, 0, 0, 0),
    ]
    assert status.touching
    assert not status.busy


def test_pictures_of_the_camera(pipeline: td.Pipeline, plug: Plug, sample: td.Sample, steady: td.Pipeline) -> None:
    """Frames of a device's camera come without end; its own reference and zero offset are taken from it."""
    untouched, touched = grid_picture(steady, sample.reference), grid_picture(steady, sample.image)
    cable = plug(steady, camera=untouched[None], camera_s=0.002)
    with td.Device(cable.address, steady) as device:
        device.load()
        device.capture_reference(frames=4)
        device.capture_zero(frames=2)
        cable.setup.camera = touched[None]  # type: ignore[union-attr]
        frames = list(itertools.islice(device.depth(), 8))
    assert [frame.picture for frame in frames] == [None] * 8
    np.testing.assert_array_equal(frames[-1].codes, steady(sample.image).codes)


@pytest.mark.parametrize(
    ("size", "starts", "message"),
    [
        (GRID, False, r"pixels come without a start of frame.*the source gives no tuser.*set tuser .*integrate\.md"),
        ((GRID[0] - 1, GRID[1]), True, "the source sends 16 x 11, the build takes 16 x 12.*set its width and height"),
        ((GRID[0], GRID[1] + 2), True, "the source sends 18 x 12, the build takes 16 x 12.*set its width and height"),
    ],
)
def test_a_camera_that_does_not_fit_is_named(
    size: tuple[int, int],
    starts: bool,
    message: str,
    pipeline: td.Pipeline,
    plug: Plug,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("tactile_depth.device.exchange.CAMERA_S", 0.1)
    cable = plug(pipeline, camera_s=0.002, camera_starts=starts)
    with td.Device(cable.address, pipeline) as device:
        device.load()
        assert device.status().input == ""
        cable.setup.camera = np.full((1, *size, 3), 135, np.uint8)  # type: ignore[union-attr]
        with pytest.raises(td.DeviceError, match=message):
            next(device.depth())
        status = device.status()
    assert re.search(message, status.input)
    assert status.arrived == (size[0] if starts else 0, size[1])
    assert status.hunting or starts


def grid_picture(pipeline: td.Pipeline, picture: np.ndarray) -> np.ndarray:
    """Return a picture on the grid of a pipeline."""
    return next(pipeline._reader.pictures(picture, "picture")[0])[1]


def test_a_device_without_camera_gives_no_frames(
    device: td.Device, sample: td.Sample, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tactile_depth.device.exchange.CAMERA_S", 0.1)
    monkeypatch.setattr("tactile_depth.device.captures.CAMERA_S", -2.9)
    with pytest.raises(td.DeviceError, match=r"has sent no depth for .* let its camera send pictures"):
        next(device.depth())
    with pytest.raises(td.DeviceError, match="no picture came from the camera"):
        device.capture_reference()
    device.load()
    assert len(list(device.depth([sample.image]))) == 1


def test_pipelines_that_are_refused(sample: td.Sample, cable: Cable) -> None:
    exact = td.Pipeline(sample.sensor, reference=sample.reference, grid=GRID, arithmetic="float")
    with pytest.raises(td.InputError, match="arithmetic=float: a device has the arithmetic of the hardware"):
        td.Device(cable.address, exact)
    with pytest.raises(td.InputError, match="pipeline is a str"):
        td.Device(cable.address, "gelsight-mini")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ({"bottom_first": False}, "has BottomFirst=0, its depth needs 1: build link_unit with BottomFirst=1"),
        ({"data_width": 20}, "takes depth codes of 20 bits, they have 24: build link_unit for these"),
    ],
)
def test_a_link_that_is_not_built_for_its_device(
    own: dict[str, Any], message: str, cable: Cable, pipeline: td.Pipeline
) -> None:
    link = cable.serving.device.link
    link.build = replace(link.build, **own)
    with pytest.raises(td.InputError, match=message):
        td.Device(cable.address, pipeline)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"grid": (24, 32)}, r"grid=\(24, 32\), but the device has \(12, 16\), rows and columns: make the pipeline"),
        ({"solver": "spectral", "grid": (16, 16)}, "grid=.*but the device has"),
        ({"boundary": "dirichlet"}, "DEVICE.boundary is neumann, that of the pipeline dirichlet"),
        ({"light_gains": False}, "DEVICE.light_gains is 1, that of the pipeline 0"),
        ({"data_width": 20}, "FORMAT.data_width is 24, that of the pipeline 20"),
        ({"depth_range_mm": 1.0}, "DEPTH_UNIT"),
    ],
)
def test_a_device_of_another_configuration(
    other: dict[str, Any], message: str, sample: td.Sample, cable: Cable
) -> None:
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference, **{"grid": GRID, **other})
    with pytest.raises(td.InputError, match=message):
        td.Device(cable.address, pipeline)


def test_the_program_of_the_page(
    sample: td.Sample, plug: Plug, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    section = (ROOT / "docs" / "python.md").read_text().partition("\n## Device\n")[2]
    block = re.findall(r"^    import .*\n(?:    .*\n|\n)*", section, re.MULTILINE)[0]
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference)
    for name, picture in (("background", sample.reference), ("press", sample.image)):
        Image.fromarray(picture).save(tmp_path / f"{name}.png")
    monkeypatch.chdir(tmp_path)
    text = textwrap.dedent(block).replace('td.load("gelsight-mini")', 'td.sample("ball").sensor')
    exec(text.replace("serial:/dev/ttyUSB0", plug(pipeline).address), {})
    height_mm = pipeline(sample.image).height_mm.max()
    assert capsys.readouterr().out == f"{np.float32(height_mm)!s} True\n"


def test_several_devices_at_once(
    pipeline: td.Pipeline, steady: td.Pipeline, plug: Plug, pictures: list[np.ndarray]
) -> None:
    one, other = td.Device(plug(pipeline).address, pipeline), td.Device(plug(steady).address, steady)
    with one, other:
        one.load()
        other.load()
        pairs = list(zip(one.depth(iter(pictures)), other.depth(iter(pictures)), strict=True))
    require_equal([frame for frame, _ in pairs], list(pipeline.stream(pictures)))
    require_equal([frame for _, frame in pairs], list(steady.stream(pictures)))


def test_a_closed_device(device: td.Device) -> None:
    device.close()
    device.close()
    for call in (device.status, device.load, lambda: device.registers["ID"], lambda: next(device.depth())):
        with pytest.raises(td.DeviceError, match="is closed"):
            call()
