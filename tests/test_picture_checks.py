# SPDX-License-Identifier: Apache-2.0
"""Checks of pictures and references: each wrong kind is refused or warned of, right ones are not."""

import pickle
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.calibrate.press_folder import read_presses
from tactile_depth.pictures.blocks import Rest
from tactile_depth.pictures.frames import read_picture
from tactile_depth.pictures.picture_check import check_picture
from tactile_depth.sensor.scenes import BENCH
from tests.ball_presses import real_folder
from tests.drawn_light import as_picture, no_contact, pressed
from tests.picture_edits import DOUBTED, LIGHTS, REFUSED, Edit, X, Y, grey, in_light, mirrored, ordered


@pytest.fixture(scope="module")
def mini() -> td.Sensor:
    return td.load("gelsight-mini")


@pytest.fixture(scope="module")
def reference(mini: td.Sensor) -> np.ndarray:
    return no_contact(mini)


@pytest.fixture(scope="module")
def press(mini: td.Sensor) -> np.ndarray:
    return as_picture(pressed(mini), seed=2)


@pytest.fixture(scope="module")
def pipeline(mini: td.Sensor, reference: np.ndarray) -> td.Pipeline:
    return td.Pipeline(mini, reference)


@pytest.fixture(scope="module", params=BENCH)
def drawn(request: pytest.FixtureRequest) -> tuple[td.Pipeline, np.ndarray]:
    """Return a pipeline with a drawn reference, and the picture of a contact."""
    sample = td.sample(request.param)
    return td.Pipeline(sample.sensor, sample.reference), sample.image


@pytest.fixture(scope="module")
def real() -> tuple[td.Pipeline, np.ndarray, list[np.ndarray]]:
    """Return the pipeline of the real presses, their reference and each third of them."""
    folder = real_folder()
    background = read_picture(folder / "background.png")
    presses = [read_picture(press.image) for press in read_presses(folder)[0]]  # type: ignore[arg-type]
    return td.Pipeline(td.load("gelsight-mini"), background), background, presses


def certain(pipeline: td.Pipeline, picture: np.ndarray) -> td.Result:
    """Return the depth of a picture; fail if anything is doubted."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = pipeline(picture)
    assert result.warnings == ()
    return result


def doubted(pipeline: td.Pipeline, picture: np.ndarray, message: str) -> td.Result:
    with pytest.warns(td.InputWarning, match=message):
        result = pipeline(picture)
    assert result.warnings
    assert all(isinstance(text, str) for text in result.warnings)
    assert result.height_error is None
    return result


# Pictures with a right reference.


@pytest.mark.parametrize("light", [1, *LIGHTS])
def test_right_pictures_are_certain(
    pipeline: td.Pipeline, press: np.ndarray, reference: np.ndarray, light: Any
) -> None:
    for picture in (press, reference):
        assert certain(pipeline, in_light(light)(picture)).height_error is not None
    doubled = np.kron(press, np.ones((2, 2, 1), np.uint8))
    certain(pipeline, doubled)


def test_a_picture_of_another_size_than_its_reference_is_warned_of(mini: td.Sensor, reference: np.ndarray) -> None:
    pipeline = td.Pipeline(mini, reference)
    smaller = reference[12:-12, 16:-16].copy()  # the same aspect ratio
    sizes = [f"{shape[1]} x {shape[0]}" for shape in (smaller.shape, reference.shape)]
    with pytest.warns(td.InputWarning, match=" .* had ".join(sizes) + ", and may show another part of the gel"):
        pipeline(smaller)


def test_drawn_contacts_are_certain(drawn: tuple[td.Pipeline, np.ndarray]) -> None:
    pipeline, picture = drawn
    for light in (1, 0.8, 1.1):
        certain(pipeline, in_light(light)(picture))


def test_a_picture_of_a_real_sensor_is_doubted_by_the_synthetic_one(press: np.ndarray, reference: np.ndarray) -> None:
    pipeline = td.Pipeline(td.load("synthetic"))
    for picture in (press, reference):
        doubted(pipeline, picture, "does not look like one of the synthetic sensor: give the calibration and a ref")
    for name in BENCH:
        certain(pipeline, td.sample(name).image)


@pytest.mark.parametrize("kind", REFUSED)
def test_a_picture_that_gives_no_depth_is_refused(pipeline: td.Pipeline, press: np.ndarray, kind: str) -> None:
    edit, message = REFUSED[kind]
    with pytest.raises(td.InputError, match=f"pictures: .*{message}"):
        pipeline(edit(press))


@pytest.mark.parametrize("kind", DOUBTED)
def test_a_picture_that_gives_a_doubtful_depth_is_warned_of(
    pipeline: td.Pipeline, press: np.ndarray, kind: str
) -> None:
    edit, message = DOUBTED[kind]
    doubted(pipeline, edit(press), message)


@pytest.mark.parametrize("size", [(128, 128), (24, 32)])
def test_other_grids_see_the_same(mini: td.Sensor, reference: np.ndarray, press: np.ndarray, size: Any) -> None:
    pipeline = td.Pipeline(mini, reference, grid=size)
    certain(pipeline, press)
    for kind in ("red and blue", "torn by 40 pixels", "half black", "grey"):
        with pytest.raises(td.InputError, match=REFUSED[kind][1]):
            pipeline(REFUSED[kind][0](press))


def test_light_gains_that_are_off_compensate_nothing(mini: td.Sensor, reference: np.ndarray, press: np.ndarray) -> None:
    pipeline = td.Pipeline(mini, reference, light_gains=False)
    certain(pipeline, press)
    doubted(pipeline, in_light(1.1)(press), r"by \+10 % in red, .* and there are no light gains")


def test_no_contact_of_slightly_other_light_is_silent_without_light_gains(real: Any) -> None:
    _, background, _ = real
    pipeline = td.Pipeline(td.load("gelsight-mini"), background, light_gains=False)
    assert doubted(pipeline, in_light(0.98)(background), "there are no light gains").contact.touching
    certain(pipeline, background)


def test_square_pictures_can_be_rotated_by_90_degrees(mini: td.Sensor) -> None:
    square = no_contact(mini)[:, :240]
    for turns, angle in ((1, 270), (3, 90)):
        with pytest.raises(td.InputError, match=f"rotated by {angle} degrees"):
            check_picture(np.ascontiguousarray(np.rot90(square, turns)), Rest.of(square[None]), "picture")


# References.


PAIRS: dict[str, tuple[Edit, str]] = {
    "BGR": (ordered(2, 1, 0), "red and blue are exchanged"),
    "red and green": (ordered(1, 0, 2), "red and green are exchanged"),
    "green and blue": (ordered(0, 2, 1), "green and blue are exchanged"),
    "rotated": (lambda p: np.rot90(p, 2).copy(), "rotated by 180 degrees"),
    "upside down": (lambda p: p[::-1].copy(), "mirrored top to bottom"),
    "mirrored": (mirrored, "it is mirrored left to right, by the lighting of gelsight-mini"),
    "grey": (grey, "is grey"),
    "one grey": (lambda p: np.full_like(p, 128), "is grey"),
    "clipped": (in_light(2.2), "of its pixels are clipped"),
    "white": (lambda p: np.full_like(p, 255), "of its pixels are clipped"),
}


@pytest.mark.parametrize("kind", PAIRS)
def test_a_reference_that_gives_no_depth_is_refused(mini: td.Sensor, reference: np.ndarray, kind: str) -> None:
    edit, message = PAIRS[kind]
    with pytest.raises(td.InputError, match=f"reference: .*{message}"):
        td.Pipeline(mini, edit(reference))


def test_a_reference_with_contact_is_warned_of(mini: td.Sensor, reference: np.ndarray, press: np.ndarray) -> None:
    with pytest.warns(td.InputWarning, match="reference: it is not smooth .* as if something touched"):
        pipeline = td.Pipeline(mini, press)
    doubted(pipeline, reference, "stands out by .* as if something touched it in the reference")
    with pytest.warns(td.InputWarning, match="it is not smooth"):
        pipeline = td.Pipeline(mini, press)
    assert pipeline(press).height_error is None


def test_a_wrong_crop_is_told_without_what_it_causes(mini: td.Sensor) -> None:
    """The remedies of the picture's own doubts, as another reference, would not mend it."""
    assert mini.untouched is not None
    levels = [np.asarray(Image.fromarray(each).resize((320, 240))) for each in np.moveaxis(mini.untouched, -1, 0)]
    reference = as_picture(np.stack(levels, axis=-1))
    uneven = in_light(1 + 0.02 * X)(reference)
    doubted(td.Pipeline(mini, reference), uneven, "changes across it by")
    with pytest.warns(td.InputWarning, match="by its light it shows 0.71 of .* give crop=gs_sdk"):
        pipeline = td.Pipeline(mini, reference, crop="none")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (text,) = pipeline(uneven).warnings
    assert "give crop=gs_sdk" in text
    assert len(doubted(pipeline, in_light(0.25)(reference), "differs from that of the reference").warnings) == 2


def test_a_real_press_with_a_wrong_crop_has_one_warning(real: Any) -> None:
    _, background, presses = real
    with pytest.warns(td.InputWarning, match="give crop=gs_sdk"):
        pipeline = td.Pipeline(td.load("gelsight-mini"), background, crop="none")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert {text for press in presses for text in pipeline(press).warnings} == set(map(str, pipeline.doubts))


def test_a_reference_of_another_sensor_is_warned_of(mini: td.Sensor, reference: np.ndarray) -> None:
    with pytest.warns(td.InputWarning, match="does not look like the sensor of gelsight-mini"):
        td.Pipeline(mini, in_light((1, 1, 0.3))(reference))


def test_the_frames_of_a_reference_agree(mini: td.Sensor, reference: np.ndarray, press: np.ndarray) -> None:
    with pytest.raises(td.InputError, match="reference: picture 3 is -100 % as bright as the others"):
        td.Pipeline(mini, np.stack([reference] * 3 + [np.zeros_like(reference)]))
    with pytest.raises(td.InputError, match="reference: picture 1 differs from the others"):
        td.Pipeline(mini, np.stack([reference, press, reference, reference]))


def test_a_captured_reference_is_checked(mini: td.Sensor, reference: np.ndarray, press: np.ndarray) -> None:
    pipeline = td.Pipeline(mini, reference)
    with pytest.raises(td.InputError, match="red and blue are exchanged"):
        pipeline.capture_reference(ordered(2, 1, 0)(reference))
    with pytest.raises(td.InputError, match="it is black"):
        pipeline.capture_zero(np.zeros_like(reference))
    certain(pipeline, press)
    with pytest.warns(td.InputWarning, match="it is not smooth"):
        pipeline.capture_reference(press)
    assert pipeline(press).warnings
    pipeline.capture_reference(reference)
    assert "the zero offset is of the reference before" in pipeline(press).warnings[0]
    pipeline.capture_zero(reference)
    certain(pipeline, press)


# Batches and streams.


def gamma(picture: np.ndarray) -> np.ndarray:
    return np.rint(255 * (picture / 255) ** 1.2).astype(np.uint8)


def test_a_capture_that_is_refused_changes_nothing(mini: td.Sensor, reference: np.ndarray, press: np.ndarray) -> None:
    """The doubts of the reference in use stay, too."""
    with pytest.warns(td.InputWarning, match="as if something touched"):
        pipeline = td.Pipeline(mini, press)
    with pytest.raises(td.InputError, match="under 16 grey levels"):
        pipeline.capture_reference(np.full_like(reference, 5))
    assert "as if something touched" in str(pipeline.doubts[0])
    assert pipeline(press).height_error is None


@pytest.mark.parametrize("edit", [in_light(1 + 0.02 * X), lambda p: np.roll(p, 8, axis=1), gamma])
def test_a_zero_offset_in_other_light_or_another_view_is_warned_of(
    pipeline: td.Pipeline, reference: np.ndarray, press: np.ndarray, edit: Edit
) -> None:
    other = pipeline.copy()
    with pytest.warns(td.InputWarning, match="changes across them .* capture the reference and the zero offset again"):
        other.capture_zero(edit(reference))
    assert other(press).height_error is None


@pytest.mark.parametrize("zoom", [0.96, 0.92, 0.86])
def test_a_picture_of_another_view_than_its_reference_is_warned_of(
    pipeline: td.Pipeline, press: np.ndarray, zoom: float
) -> None:
    picture = Image.fromarray(press)
    width, height = (zoom * size for size in picture.size)
    left, top = ((1 - zoom) / 2 * size for size in picture.size)
    box = left, top, left + width, top + height
    doubted(pipeline, np.asarray(picture.resize(picture.size, Image.Resampling.BILINEAR, box)), "its light")


def test_a_folder_names_the_picture(tmp_path: Path, pipeline: td.Pipeline, press: np.ndarray) -> None:
    for name, picture in (("1.png", press), ("2.png", np.zeros_like(press))):
        Image.fromarray(picture).save(tmp_path / name)
    with pytest.raises(td.InputError, match=r"2\.png: it is black"):
        pipeline(tmp_path)


def test_a_batch_names_the_picture(pipeline: td.Pipeline, press: np.ndarray) -> None:
    with pytest.raises(td.InputError, match=r"pictures\[1\]: it is black"):
        pipeline(np.stack([press, np.zeros_like(press)]))
    with pytest.warns(td.InputWarning, match=r"pictures\[1\]: its light changes across it"):
        batch = pipeline(np.stack([press, in_light(1 + 0.03 * X)(press)]))
    assert batch.height_error is None
    assert batch[0].height_error is not None
    assert batch[1].height_error is None


def test_a_stream_leaves_out_what_gives_no_depth(pipeline: td.Pipeline, press: np.ndarray) -> None:
    stream, black, bgr = pipeline.new_stream(), np.zeros_like(press), press[..., ::-1].copy()
    with pytest.warns(td.InputWarning) as warned:
        results = list(pipeline.stream([black, press, bgr, press], stream))
    assert [str(each.message)[:48] for each in warned] == ["left out and counted: picture 0: it is black, at"]
    assert (stream.taken, stream.failed) == (4, 2)
    expected = list(pipeline.stream([press, press]))
    for result, same in zip(results, expected, strict=True):
        np.testing.assert_array_equal(result.codes, same.codes)


def test_a_stream_that_gave_depth_leaves_out_pictures_of_any_wrong_kind(
    pipeline: td.Pipeline, press: np.ndarray
) -> None:
    others = [press[:, : press.shape[1] // 2], press.astype(float) / 2, None]
    stream = pipeline.new_stream()
    with pytest.warns(td.InputWarning, match="left out and counted: picture 1: "):
        results = list(pipeline.stream([press, *others, press], stream))  # type: ignore[list-item]
    assert (len(results), stream.taken, stream.failed) == (2, 5, 3)
    for other in others:
        with pytest.raises(td.InputError):
            list(pipeline.stream([other, press]))  # type: ignore[list-item]


def test_a_stream_begins_afresh_at_a_capture(pipeline: td.Pipeline, press: np.ndarray) -> None:
    """Gains that followed the light before it would shade the first pictures after it."""
    captured, dim = pipeline.copy(), np.rint(0.8 * press).astype(np.uint8)
    stream = captured.new_stream()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in captured.stream([dim] * 8, stream):
            pass
        captured.capture_reference(dim)
        captured.capture_zero(dim)
        (after,) = captured.stream([dim], stream)
        (new,) = captured.stream([dim])
    np.testing.assert_array_equal(after.codes, new.codes)
    assert after.records == new.records


def test_a_stream_leaves_out_a_file_of_a_folder_that_cannot_be_read(
    pipeline: td.Pipeline, press: np.ndarray, tmp_path: Path
) -> None:
    for number in range(3):
        Image.fromarray(press).save(tmp_path / f"{number}.png")
    whole = (tmp_path / "1.png").read_bytes()
    (tmp_path / "1.png").write_bytes(whole[: len(whole) // 2])
    stream = pipeline.new_stream()
    with pytest.warns(td.InputWarning, match="left out and counted: .*1.png"):
        assert len(list(pipeline.stream(tmp_path, stream))) == 2
    assert (stream.taken, stream.failed) == (3, 1)


def test_a_copy_of_a_stream_goes_on(pipeline: td.Pipeline, press: np.ndarray) -> None:
    stream = pipeline.new_stream()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        list(pipeline.stream([np.rint(0.8 * press).astype(np.uint8)] * 4, stream))
        results = [list(pipeline.stream([press], copied)) for copied in (pickle.loads(pickle.dumps(stream)), stream)]
    assert results[0][0].records == results[1][0].records


def test_a_stream_warns_once_of_each_kind(pipeline: td.Pipeline, press: np.ndarray) -> None:
    uneven = in_light(1 + 0.03 * X)(press)
    with pytest.warns(td.InputWarning) as warned:
        results = list(pipeline.stream([uneven, uneven, uneven]))
    assert len(warned) == 1
    assert all(result.height_error is None for result in results)


# The real presses.


def test_all_real_presses_are_certain(real: Any) -> None:
    pipeline, background, presses = real
    for picture in (background, *presses):
        certain(pipeline, picture)


@pytest.mark.parametrize("light", LIGHTS)
def test_real_presses_in_another_light_are_certain(real: Any, light: Any) -> None:
    for picture in real[2][::3]:
        certain(real[0], in_light(light)(picture))


@pytest.mark.parametrize("kind", [kind for kind in REFUSED if kind != "the rest green"])
def test_real_presses_that_give_no_depth_are_refused(real: Any, kind: str) -> None:
    edit, message = REFUSED[kind]
    for picture in real[2][::9]:
        with pytest.raises(td.InputError, match=message):
            real[0](edit(picture))


@pytest.mark.parametrize("kind", [kind for kind in DOUBTED if "lamp" not in kind and "clipped" not in kind])
def test_real_presses_that_give_a_doubtful_depth_are_warned_of(real: Any, kind: str) -> None:
    edit, message = DOUBTED[kind]
    for picture in real[2][::9]:
        doubted(real[0], edit(picture), message.split(" 4 %")[0])


def test_gains_of_a_real_press_do_not_exchange_colours(real: Any) -> None:
    pipeline, background, presses = real
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        *_, released = pipeline.stream([background, *[presses[0]] * 4, background])
    assert ["light gains that have not followed yet" in text for text in released.warnings] == [True]


def test_a_real_press_is_no_reference(real: Any) -> None:
    _, background, presses = real
    for press in presses[::3]:
        with pytest.warns(td.InputWarning, match="it is not smooth"):
            pipeline = td.Pipeline(td.load("gelsight-mini"), press)
        doubted(pipeline, background, "stands out")


@pytest.mark.parametrize("kind", PAIRS)
def test_real_references_that_give_no_depth_are_refused(real: Any, kind: str) -> None:
    with pytest.raises(td.InputError, match=f"reference: .*{PAIRS[kind][1]}"):
        td.Pipeline(td.load("gelsight-mini"), PAIRS[kind][0](real[1]))


def test_a_mirrored_real_pair_is_refused(real: Any) -> None:
    for picture in (real[1], *real[2][::9]):
        with pytest.raises(td.InputError, match="mirrored left to right"):
            td.Pipeline(td.load("gelsight-mini"), mirrored(picture))


# Light that drifts after the reference was taken, and exchanges that the reference does not show.


DRIFTS = [
    1 + sign * 0.01 * across * np.array(colours)
    for colours in ((1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, -1))
    for across in (X, Y, (X + Y) / 2, (X - Y) / 2)
    for sign in (1, -1)
]


@pytest.mark.parametrize("noise", [0, 1, 2])
def test_untouched_gel_in_drifting_light_touches_nothing_silently(real: Any, noise: float) -> None:
    pipeline, background, _ = real
    warned = 0
    for index, light in enumerate(DRIFTS):
        levels = background * light + np.random.default_rng(index).normal(0, noise, background.shape)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = pipeline(np.clip(np.rint(levels), 0, 255).astype(np.uint8))
        warned += bool(result.warnings)
        assert result.warnings or not result.contact.touching
    assert warned >= 15
    certain(pipeline, in_light(1 + np.random.default_rng(9).normal(0, noise / 100, background.shape))(background))


def test_presses_in_drifting_light_are_right_or_warned_of(real: Any) -> None:
    """Contacts that are central, for which the calibration states its error; beside the edge 10 % at worst."""
    pipeline, _, presses = real
    for index, press in enumerate(presses):
        height = pipeline(press).height_mm.max()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = pipeline(in_light(DRIFTS[7 * index % len(DRIFTS)])(press))
        if result.contact.is_central and not result.warnings:
            assert result.height_mm.max() == pytest.approx(height, rel=0.05)


EXCHANGES = ["red and blue", "red and green", "green and blue", "blue first", "red last", "mirrored", "upside down"]


@pytest.mark.parametrize("kind", [*EXCHANGES, "rotated"])
def test_exchanges_are_warned_of_where_the_light_is_the_same_everywhere(
    drawn: tuple[td.Pipeline, np.ndarray], kind: str
) -> None:
    pipeline, picture = drawn
    with pytest.warns(td.InputWarning, match="colours exchanged, sides mirrored, or new light|stands out|across it"):
        result = pipeline(REFUSED[kind][0](picture))
    assert result.height_error is None
