# SPDX-License-Identifier: Apache-2.0
"""Frames: from files to the grid, and errors for bad files."""

import struct
import tracemalloc
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from skimage import io  # type: ignore[attr-defined]

import tactile_depth as td
from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.base.files import RECORD
from tactile_depth.chip.resampling import resampling
from tactile_depth.pictures.frames import EXIF_ORIENTATION, LARGEST_CAMERA, load_frames, read_picture
from tactile_depth.sensor.scenes import SCENES, render, scene_pixel_pitch_mm
from tactile_depth.sensor.synthetic import synthetic
from tests.drawn_light import no_contact
from tests.picture_edits import few_colours


def noise(*shape: Any, seed: int = 1) -> Any:
    return np.random.default_rng(seed).integers(0, 256, shape, dtype=np.uint8)


def picture(path: Path, image: np.ndarray) -> Any:
    io.imsave(path, image, check_contrast=False)
    return path


def refused(source: Any, size: Any = (16, 16), reference: Any = None) -> str:
    with pytest.raises(InputError) as caught:
        load_frames(str(source), size, None if reference is None else str(reference))
    message = str(caught.value)
    assert "\n" not in message
    return message


# Area averages.

cameras = st.tuples(st.integers(16, 60), st.integers(16, 60))
grids = st.tuples(st.integers(1, 16), st.integers(1, 16))


@given(cameras, grids)
def test_weights_cover_the_centred_crop_evenly(camera: Any, grid: Any) -> None:
    plan = resampling(camera, grid)
    for weights, length in ((plan.rows, camera[0]), (plan.columns, camera[1])):
        np.testing.assert_array_equal(weights, np.rint(weights))
        np.testing.assert_array_equal(weights.sum(axis=1), plan.numerator)
        of_camera = weights.sum(axis=0)
        covered = np.flatnonzero(of_camera)
        assert (of_camera[covered[:-1]] == plan.denominator).all()  # the last may be cut
        before, after = covered[0], length - len(weights) * plan.scale - covered[0]
        assert 0 <= after - before < 2 or after == pytest.approx(before)  # centred, to a whole pixel


@given(cameras, grids, st.integers(0, 255))
def test_a_constant_stays_that_constant(camera: Any, grid: Any, value: Any) -> None:
    average = resampling(camera, grid).average(np.full((*camera, 3), value, np.uint8))
    np.testing.assert_array_equal(average, value)


@settings(max_examples=50)
@given(st.integers(1, 16), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_averages_preserve_the_mean_of_what_they_cover(count: int, more: Any, seed: int) -> None:
    camera = (count + more, count + more)
    image = noise(*camera, 3, seed=seed)
    average = resampling(camera, (count, count)).average(image)
    np.testing.assert_allclose(average.mean(axis=(0, 1)), image.mean(axis=(0, 1)), rtol=1e-12)


def test_averages_of_a_ratio_that_is_not_whole() -> None:
    image = np.zeros((1, 3, 3), np.uint8)
    image[0, :, 0] = 10, 20, 60
    plan = resampling((3, 3), (2, 2))
    averages = plan.average(np.repeat(image, 3, axis=0))[:, :, 0]
    np.testing.assert_allclose(averages, [[(10 + 20 / 2) / 1.5, (20 / 2 + 60) / 1.5]] * 2)


def test_many_images_are_averaged_as_one_by_one() -> None:
    images = noise(2, 3, 24, 20, 3)
    plan = resampling((24, 20), (11, 9))
    want = [[plan.average(image) for image in row] for row in images]
    np.testing.assert_array_equal(plan.average(images), want)


def test_averages_are_the_exact_quotients() -> None:
    """Compare averages of integers with exact fractions: each is the nearest number in double precision."""
    image = noise(24, 20, 1)
    plan = resampling((24, 20), (11, 9))
    rows, columns = plan.rows.astype(int), plan.columns.astype(int)
    want = rows @ image[..., 0].astype(int) @ columns.T / plan.numerator**2
    np.testing.assert_array_equal(plan.average(image)[..., 0], want)


def test_the_gelsight_camera_keeps_its_middle_square() -> None:
    plan = resampling((240, 320), (128, 128))
    assert plan.origin == (0, 40)
    assert plan.scale == 1.875
    assert not plan.columns[:, :40].any()
    assert not plan.columns[:, 280:].any()


def test_a_frame_as_wide_as_the_grid_is_not_blurred(tmp_path: Path) -> None:
    frames = noise(2, 19, 16, 3)
    np.save(tmp_path / "f.npy", frames)
    loaded = load_frames(str(tmp_path / "f.npy"), (16, 16))
    np.testing.assert_array_equal(loaded.pixels, frames[:, 1:17])
    assert loaded.pixel_scale == 1


def test_averages_are_rounded_to_even_once(tmp_path: Path) -> None:
    frames = np.zeros((1, 32, 32, 3), np.uint8)
    frames[0, ::2, ::2] = 2  # mean 0.5
    frames[0, 1::2, :, 1] = 2  # mean 1.5 in green
    np.save(tmp_path / "f.npy", frames)
    pixels = load_frames(str(tmp_path / "f.npy"), (16, 16)).pixels
    assert (pixels[..., 0] == 0).all()
    assert (pixels[..., 1] == 2).all()


# Reference.


def test_the_reference_comes_to_the_grid_as_the_frames_do(tmp_path: Path) -> None:
    image, reference = noise(2, 24, 30, 3)
    loaded = load_frames(str(picture(tmp_path / "i.png", image)), (16, 16), str(picture(tmp_path / "r.png", reference)))
    as_frame = load_frames(str(tmp_path / "r.png"), (16, 16))
    np.testing.assert_array_equal(loaded.reference, as_frame.pixels[0])
    np.testing.assert_array_equal(loaded.pixels, load_frames(str(tmp_path / "i.png"), (16, 16)).pixels)
    assert as_frame.reference is None


def test_pictures_reduced_to_a_palette_are_refused_with_a_reference(tmp_path: Path) -> None:
    rest = no_contact(td.load("gelsight-mini"))
    whole, reduced = (str(picture(tmp_path / f"{each.__name__}.png", each(rest))) for each in (np.array, few_colours))
    for frames, reference in ((whole, reduced), (reduced, whole)):
        assert "few_colours.png: it has 2" in refused(frames, (96, 128), reference)
    load_frames(whole, (96, 128), whole)


# Sources.


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_rendered_at_the_size_of_the_grid(name: str) -> None:
    frames = load_frames(name, (32, 32), seed=7)
    np.testing.assert_array_equal(frames.pixels, render(name, 32, seed=7).frames)
    assert len(frames.labels) == len(frames.pixels)
    assert frames.name == name
    assert frames.pixel_scale * synthetic().pixel_pitch_mm == pytest.approx(scene_pixel_pitch_mm(32))


def test_a_folder_is_read_in_natural_order(tmp_path: Path) -> None:
    order = ["2.png", "12.png", "frame2.png", "frame10.png"]
    for value, name in reversed(list(enumerate(order))):
        picture(tmp_path / name, np.full((20, 20, 3), value, np.uint8))
    (tmp_path / "presses.csv").write_text("not a picture")
    frames = load_frames(str(tmp_path), (16, 16))
    assert frames.labels == tuple(order)
    assert frames.pixels[:, 0, 0, 0].tolist() == [0, 1, 2, 3]
    assert frames.pixel_scale == 1.25


def test_transparency_is_dropped(tmp_path: Path) -> None:
    image = noise(16, 16, 4)
    frames = load_frames(str(picture(tmp_path / "a.png", image)), (16, 16))
    np.testing.assert_array_equal(frames.pixels[0], image[:, :, :3])


def test_a_grid_need_not_be_square(tmp_path: Path) -> None:
    frames = noise(1, 40, 20, 3)
    np.save(tmp_path / "f.npy", frames)
    np.testing.assert_array_equal(load_frames(str(tmp_path / "f.npy"), (30, 20)).pixels, frames[:, 5:35])


# Bad input.


@pytest.mark.parametrize("source", ["bal", "absent.png", "absent.npy", "no/such/folder"])
def test_an_unknown_source_is_answered_with_what_is_accepted(source: Any) -> None:
    message = refused(source)
    assert source in message
    assert all(name in message for name in SCENES)


@pytest.mark.parametrize(
    "array",
    [
        noise(2, 16, 16),
        noise(16, 16),
        noise(2, 16, 16, 4),
        noise(0, 16, 16, 3),
        noise(2, 16, 16, 3).astype(np.float32),
        noise(2, 16, 16, 3).astype(np.int8),
    ],
    ids=lambda array: f"{array.dtype}{array.shape}",
)
def test_an_npy_of_wrong_shape_or_type_is_named(tmp_path: Path, array: Any) -> None:
    np.save(tmp_path / "f.npy", array)
    message = refused(tmp_path / "f.npy")
    assert "f.npy" in message
    assert f"{array.dtype} {array.shape}" in message


@pytest.mark.parametrize("share", [0, 0.01, 0.5, 0.99])
def test_a_truncated_npy_is_named(tmp_path: Path, share: float) -> None:
    path = tmp_path / "f.npy"
    np.save(path, noise(2, 16, 16, 3))
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    assert f"{path}: not a readable .npy" in refused(path)


@pytest.mark.filterwarnings("ignore:The legacy")  # imageio tries these plugins on an empty file
@pytest.mark.parametrize("share", [0, 0.01, 0.5, 0.9])
def test_a_truncated_png_is_named(tmp_path: Path, share: float) -> None:
    path = picture(tmp_path / "p.png", noise(40, 40, 3))
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    assert f"{path}: not a readable picture" in refused(path)


def chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png(height: Any, width: int, bits: int, colour: Any, row: bytes, before: bytes = b"") -> bytes:
    """A PNG of equal rows, each unfiltered."""
    head = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    body = chunk(b"IDAT", zlib.compress((b"\0" + row) * height, 1))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + before + body + chunk(b"IEND", b"")


def test_a_jpeg_is_read(tmp_path: Path) -> None:
    path = tmp_path / "p.jpg"
    image = Image.new("RGB", (24, 16), (90, 120, 150))
    image.save(path, quality=95)
    assert np.abs(read_picture(path).astype(int) - (90, 120, 150)).max() <= 2
    assert load_frames(str(tmp_path), (16, 16)).labels == ("p.jpg",)


def test_the_files_that_macos_puts_beside_pictures_are_skipped(tmp_path: Path) -> None:
    picture(tmp_path / "1.png", noise(20, 20, 3))
    (tmp_path / "._1.png").write_bytes(b"\0\5\26\7")
    assert load_frames(str(tmp_path), (16, 16)).labels == ("1.png",)


def test_pictures_of_a_folder_that_are_not_read_are_named(tmp_path: Path) -> None:
    for name in ("1.png", "2.webp", "10.BMP"):
        Image.new("RGB", (20, 20)).save(tmp_path / name)
    for name in ("notes.txt", "3.jfif", "4.jpe", "5.ppm", "6.avif", "7.jp2", "8.tga", "9.npy"):
        (tmp_path / name).touch()
    with pytest.warns(InputWarning, match=r"no PNG or JPEG: 2\.webp, 9 in all: save them as PNG"):
        assert load_frames(str(tmp_path), (16, 16)).labels == ("1.png",)


def test_a_npz_of_frames_is_refused_with_the_way_to_a_npy(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", frames=noise(2, 16, 16, 3))
    with pytest.raises(InputError, match=r"a\.npz: a \.npz: accepted is .*: save its array with numpy\.save, as \.npy"):
        load_frames(str(tmp_path / "a.npz"), (16, 16))


def test_subfolders_that_hold_pictures_are_named(tmp_path: Path) -> None:
    for name in ("ball6/0.png", "ball10/set.1/0.JPG", "empty/notes.txt", ".hidden/0.png", "run/0.png", "run/" + RECORD):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    with pytest.raises(
        InputError, match=r"without any PNG or JPEG, but with subfolders that hold some \(ball6, 2 in all"
    ):
        load_frames(str(tmp_path), (16, 16))
    Image.new("RGB", (20, 20)).save(tmp_path / "background.png")
    with pytest.warns(InputWarning, match="subfolders that hold pictures: ball6, 2 in all: name a subfolder") as caught:
        assert load_frames(str(tmp_path), (16, 16)).labels == ("background.png",)
    assert len(caught) == 1


def test_a_folder_of_pictures_beside_folders_of_others_is_certain(tmp_path: Path) -> None:
    for name in ("1.png", ".hidden/0.png", "run/0.png", "run/" + RECORD, "._mac/._0.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        Image.new("RGB", (20, 20)).save(tmp_path / name, "PNG")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load_frames(str(tmp_path), (16, 16)).labels == ("1.png",)


def npz(path: Path) -> Path:
    np.savez(path.with_suffix(".npz"), frames=noise(2, 16, 16, 3))
    return path.with_suffix(".npz").rename(path)


def claiming(path: Path, *shape: int) -> Path:
    """Return an .npy of a few bytes whose header claims a shape."""
    with path.open("wb") as file:
        np.lib.format.write_array_header_1_0(file, {"descr": "|u1", "fortran_order": False, "shape": shape})
        file.write(bytes(768))
    return path


def twice(path: Path) -> Path:
    """Return an .npy with two arrays, one behind the other."""
    with path.open("wb") as file:
        for _ in range(2):
            np.save(file, np.zeros((16, 16, 3), np.uint8))
    return path


def drawn(path: Path, *size: Any, mode: str = "RGB", **options: Any) -> Path:
    Image.new(mode, size or (24, 16)).save(path, **options)
    return path


def rotated() -> Any:
    exif = Image.Exif()
    exif[EXIF_ORIENTATION] = 6
    return exif


def written(path: Path, *header: Any) -> Path:
    path.write_bytes(png(*header))
    return path


def mixed(folder: Path) -> Path:
    for name, columns in (("1.png", 20), ("2.png", 22)):
        picture(folder / name, noise(20, columns, 3))
    return folder


ANIMATION: dict[str, Any] = {"save_all": True, "append_images": [Image.new("RGB", (24, 16), "red")]}
TOO_LARGE = f"accepted are up to {LARGEST_CAMERA}"
BAD: dict[str, Any] = {
    "an npz": (lambda t: npz(t / "f.npy"), "f.npy: not a readable .npy"),
    "8 bits, grey": (lambda t: written(t / "p.png", 20, 20, 8, 0, bytes(160)), "p.png", "8 bits, grey"),
    "16 bits, RGB": (lambda t: written(t / "p.png", 20, 20, 16, 2, bytes(160)), "p.png", "16 bits, RGB"),
    "16 bits, RGB with": (lambda t: written(t / "p.png", 20, 20, 16, 6, bytes(160)), "p.png", "16 bits, RGB with"),
    "8 bits, grey with": (lambda t: written(t / "p.png", 20, 20, 8, 4, bytes(160)), "p.png", "grey with"),
    "1 bit": (lambda t: written(t / "p.png", 20, 20, 1, 0, bytes(160)), "p.png", "1 bits"),
    "GIF": (lambda t: drawn(t / "p.gif"), "p.gif: not a readable picture (it does not begin as a PNG or a JPEG does)"),
    "BMP": (lambda t: drawn(t / "p.bmp"), "p.bmp: not a readable picture (it does not begin as a PNG or a JPEG does)"),
    "TIFF": (lambda t: drawn(t / "p.tif"), "p.tif: not a readable picture (it does not begin as a PNG or a JPEG does)"),
    "a JPEG that viewers rotate": (lambda t: drawn(t / "p.jpg", exif=rotated()), "asks viewers to rotate it"),
    "a PNG that viewers rotate": (lambda t: drawn(t / "p.png", exif=rotated()), "asks viewers to rotate it"),
    "a palette": (
        lambda t: written(t / "p.png", 20, 20, 8, 3, bytes(20)),
        "8 bits, palette",
        "take it again in full colour",
    ),
    "a JPEG without colour": (lambda t: drawn(t / "p.jpg", mode="L"), "a JPEG of mode L"),
    "a large JPEG": (lambda t: drawn(t / "p.jpg", LARGEST_CAMERA + 1, 16), f"{LARGEST_CAMERA + 1}"),
    "an animation": (lambda t: drawn(t / "p.png", **ANIMATION), "an animation"),
    "a wide claim": (lambda t: written(t / "p.png", 16, 10**6, 8, 2, b""), f"frames of 16 x 1000000: {TOO_LARGE}"),
    "a large claim": (lambda t: written(t / "p.png", 9000, 9000, 8, 2, b""), f"frames of 9000 x 9000: {TOO_LARGE}"),
    "two arrays": (lambda t: twice(t / "f.npy"), "more follows the first array"),
    "2^40 frames": (lambda t: claiming(t / "f.npy", 1 << 40, 16, 16, 3), "f.npy"),
    "a large frame": (lambda t: claiming(t / "f.npy", 1, 4000, 4000, 3), "f.npy"),
    "-1 frames": (lambda t: claiming(t / "f.npy", -1, 16, 16, 3), "f.npy"),
    "2^64 rows": (lambda t: claiming(t / "f.npy", 1 << 32, 1 << 32, 16, 3), "f.npy"),
    "a line break": (lambda t: "a\nb", "a?b"),
    "few rows": (lambda t: picture(t / "p.png", noise(15, 40, 3)), "40 x 15 pixels", "16 x 16"),
    "few columns": (lambda t: picture(t / "p.png", noise(40, 15, 3)), "15 x 40 pixels", "16 x 16"),
    "few of both": (lambda t: picture(t / "p.png", noise(8, 8, 3)), "8 x 8", "16 x 16"),
    "mixed sizes": (mixed, "2.png is 20 x 22", "1.png is 20 x 20"),
    "an empty folder": (lambda t: t, "a folder without any PNG"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_are_no_frames_is_named(tmp_path: Path, case: str) -> None:
    """Refuse a file for what it is; one that claims to be large is not read."""
    make, *parts = BAD[case]
    message = refused(make(tmp_path))
    assert [part for part in parts if part not in message] == []


def test_an_npy_of_pickled_objects_is_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "f.npy", np.array([[[[print]]]], dtype=object), allow_pickle=True)
    assert "object" in refused(tmp_path / "f.npy")


def test_a_name_with_a_digit_that_is_no_number_is_read(tmp_path: Path) -> None:
    for name in ("\u00b2.png", "1.png", "\u0663.png"):
        picture(tmp_path / name, noise(16, 16, 3))
    assert len(load_frames(str(tmp_path), (16, 16)).labels) == 3


@pytest.mark.parametrize("reference", [False, True])
def test_a_name_too_long_for_the_system_is_named(tmp_path: Path, reference: Any) -> None:
    name = "x" * 5000
    frame = picture(tmp_path / "1.png", noise(20, 20, 3))
    message = refused(frame, reference=name) if reference else refused(name)
    assert "too long" in message
    assert len(message) < 1200


def test_a_reference_of_no_use_is_named(tmp_path: Path) -> None:
    frame = picture(tmp_path / "1.png", noise(20, 20, 3))
    reference = picture(tmp_path / "r.png", noise(20, 22, 3))
    message = refused(frame, reference=reference)
    assert f"{reference}: 20 x 22" in message
    assert "20 x 20" in message
    assert "absent.png: no such file" in refused(frame, reference=tmp_path / "absent.png")
    assert f"{tmp_path}: a folder: give an 8-bit RGB picture" in refused(frame, reference=tmp_path)
    message = refused("ball", reference="r.png")
    assert "r.png" in message
    assert "ball" in message


def test_a_scene_fills_the_middle_square_of_a_grid() -> None:
    square = load_frames("ball", (32, 32), seed=3)
    frames = load_frames("ball", (32, 50), seed=3)
    assert frames.pixels.shape == (1, 32, 50, 3)
    assert frames.pixel_scale == square.pixel_scale
    height = render("ball", 32, 50).height
    np.testing.assert_array_equal(height[:, :, 9:41], render("ball", 32).height)
    assert not height[:, :, :9].any()
    assert not height[:, :, 41:].any()


def test_a_large_picture_is_averaged_in_little_memory() -> None:
    image = np.zeros((LARGEST_CAMERA, LARGEST_CAMERA, 3), np.uint8)
    plan = resampling(image.shape[:2], (128, 128))
    tracemalloc.start()
    plan.average(image)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 256 << 20  # the whole picture in float64 has 400 MB
