# SPDX-License-Identifier: Apache-2.0
"""Pictures and streams that a pipeline takes, and those that it refuses with a remedy."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td

COARSE: dict[str, Any] = {"data_width": 15, "depth_range_mm": 100.0}


@pytest.fixture(scope="module")
def drawn() -> td.Sample:
    return td.sample()


@pytest.fixture(scope="module")
def pipeline(drawn: td.Sample) -> td.Pipeline:
    return td.Pipeline(drawn.sensor, drawn.reference, grid=(24, 32))


def test_a_memory_map_and_a_grid_of_numpy_are_taken(pipeline: td.Pipeline, drawn: td.Sample, tmp_path: Path) -> None:
    np.save(tmp_path / "p.npy", np.stack([drawn.image, drawn.reference]))
    mapped, right = np.load(tmp_path / "p.npy", mmap_mode="r"), pipeline(drawn.image).codes
    of_numpy = td.Pipeline(drawn.sensor, drawn.reference, grid=tuple(np.array([24, 32])))
    for codes in (pipeline(mapped).codes[0], pipeline(mapped[0]).codes, of_numpy(drawn.image).codes):
        np.testing.assert_array_equal(codes, right)


@pytest.mark.parametrize("mode", ["YCbCr", "HSV", "L", "RGBA", "CMYK"])
def test_pil_images_of_another_mode_are_refused(pipeline: td.Pipeline, drawn: td.Sample, mode: str) -> None:
    image = Image.fromarray(drawn.image)
    np.testing.assert_array_equal(pipeline(image).codes, pipeline(drawn.image).codes)
    message = rf'a PIL image of mode {mode}: accepted is RGB: give it after \.convert\("RGB"\)'
    other = image.convert(mode)
    refusals: list[Any] = [
        lambda: pipeline(other),
        lambda: pipeline([image, other]),
        lambda: next(pipeline.stream([other])),
        lambda: next(pipeline.stream(other)),  # type: ignore[arg-type]
        lambda: td.Pipeline(drawn.sensor, other),
        lambda: td.identify(other),
        lambda: td.BallPress(other, 4.0),  # type: ignore[arg-type]
    ]
    for refused in refusals:
        with pytest.raises(td.InputError, match=message):
            refused()


def test_pil_images_of_damaged_files_or_several_frames_are_refused(
    tmp_path: Path, pipeline: td.Pipeline, drawn: td.Sample
) -> None:
    image, path = Image.fromarray(drawn.image), tmp_path / "press.jpg"
    image.save(path)
    path.write_bytes(path.read_bytes()[:-500])
    with pytest.raises(td.InputError, match=r"not a readable picture \(.*truncated"):
        pipeline(Image.open(path))
    with pytest.warns(td.InputWarning, match="truncated"):
        assert len(list(pipeline.stream([image, Image.open(path), image]))) == 2
    image.save(tmp_path / "two.tif", save_all=True, append_images=[image])
    with Image.open(tmp_path / "two.tif") as two, pytest.raises(td.InputError, match="a PIL image of several frames"):
        pipeline(two)
    image.save(tmp_path / "two.jpg", "MPO", save_all=True, append_images=[image])
    with pytest.warns(td.InputWarning, match="the first of its pictures alone counts"):
        pipeline(tmp_path / "two.jpg")


def test_a_mask_is_not_lost(pipeline: td.Pipeline, drawn: td.Sample) -> None:
    with pytest.raises(td.InputError, match=r"a masked array, whose mask would be lost: give it after \.filled"):
        pipeline(np.ma.masked_equal(drawn.image, 0))


def test_a_stream_that_is_none_is_refused(pipeline: td.Pipeline, drawn: td.Sample) -> None:
    refusals: list[Any] = [
        lambda: pipeline(drawn.image, stream="x"),  # type: ignore[arg-type]
        lambda: next(pipeline.stream([drawn.image], "x")),  # type: ignore[arg-type]
    ]
    for refused in refusals:
        with pytest.raises(
            td.InputError, match=r"stream is a str: accepted is a Stream: make one with `pipeline\.new_"
        ):
            refused()


@pytest.mark.parametrize("given", [object(), 0, None, np.uint8(3)])
def test_pictures_of_a_stream_that_are_none_are_refused(pipeline: td.Pipeline, given: Any) -> None:
    with pytest.raises(td.InputError, match=r"accepted is a|accepted is uint8"):
        next(pipeline.stream(given))


def test_steps_that_are_coarser_than_a_press_are_warned_of(drawn: td.Sample) -> None:
    with pytest.warns(td.InputWarning, match=r"data_width=15 and a depth range of 100 mm have steps of") as caught:
        coarse = td.Pipeline(drawn.sensor, drawn.reference, grid=(96, 128), **COARSE)
    shallower, wider = str(caught[0].message).rpartition("give depth_range_mm=")[2].split(" or data_width=")
    with pytest.warns(td.InputWarning):
        assert coarse(drawn.image).height_error is None
    for mended in ({"depth_range_mm": float(shallower)}, {"data_width": int(wider)}):
        fine = td.Pipeline(drawn.sensor, drawn.reference, grid=(96, 128), **(COARSE | mended))
        assert fine.doubts == ()


def test_words_too_short_for_a_fine_grid_are_warned_of(drawn: td.Sample) -> None:
    """Real heights read 0.87 to 1.37 of what double precision gives with 14 bits on this grid."""
    with pytest.warns(
        td.InputWarning, match=r"data_width=14 and a depth range of .* have steps of .*data_width=1[6-9]"
    ):
        td.Pipeline(drawn.sensor, drawn.reference, grid=(192, 256), data_width=14)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        td.Pipeline(drawn.sensor, drawn.reference, grid=(192, 256))
        td.Pipeline(drawn.sensor, drawn.reference, data_width=15)


def test_double_precision_has_no_steps(drawn: td.Sample) -> None:
    assert td.Pipeline(drawn.sensor, drawn.reference, arithmetic="float", **COARSE).doubts == ()
