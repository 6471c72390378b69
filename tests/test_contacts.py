# SPDX-License-Identifier: Apache-2.0
"""Contacts: light ones are seen, untouched gel is none, and several are told apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from commands.study.drawn_light import DrawnLight, exact
from commands.study.drawn_sensor import Height
from conftest import SEED
from tactile_depth.calibrate.press_folder import read_presses
from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.depth.regions import regions
from tactile_depth.depth.result import Contact, least_area_mm2
from tactile_depth.pictures.frames import read_picture
from tests.ball_presses import real_folder

CAMERA = (240, 320)
SKIRT_MM = 0.25  # over which the gel falls off beside a ball
PLACES = [(x, y) for x in (-6.0, -3.0, 0.0, 3.0, 6.0) for y in (-4.5, -1.5, 1.5, 4.5)]


def ball(diameter_mm: float, depth_mm: float, x_mm: float = 0.0, y_mm: float = 0.0) -> Height:
    """Return the height of a pressed ball, and of the gel that it draws down; its highest point is `depth_mm` high."""
    radius, contact = diameter_mm / 2, np.linspace(0.01, 0.99 * diameter_mm / 2, 10_000)
    steepness = contact / np.sqrt(radius**2 - contact**2)
    total = radius - np.sqrt(radius**2 - contact**2) + SKIRT_MM * steepness
    edge, slope = (float(each[np.searchsorted(total, depth_mm)]) for each in (contact, steepness))

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        distance = np.hypot(x - x_mm, y - y_mm)
        inside = np.sqrt(radius**2 - np.minimum(distance, edge) ** 2) - np.sqrt(radius**2 - edge**2)
        return inside + SKIRT_MM * slope * np.exp(-np.maximum(distance - edge, 0) / SKIRT_MM)

    return height


def higher(*bodies: Height) -> Height:
    return lambda x, y: np.max([body(x, y) for body in bodies], axis=0)


@pytest.fixture(scope="module")
def drawn() -> DrawnLight:
    """Return a camera whose pictures have the lighting and the colours of the built-in calibration."""
    return DrawnLight(exact(td.load("gelsight-mini")), CAMERA, 1.0)


def noisy(levels: np.ndarray, noise: float, rng: np.random.Generator, count: int = 1) -> np.ndarray:
    """Return pictures with camera noise, uint8 (count, rows, columns, 3)."""
    return np.rint(levels + rng.normal(scale=noise, size=(count, *levels.shape))).clip(0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def seen(drawn: DrawnLight) -> Any:
    """Return a function that gives the result of a drawn height."""
    pipeline = td.Pipeline(drawn.sensor, np.rint(drawn.untouched).astype(np.uint8))
    rng = np.random.default_rng(SEED)
    return lambda height, noise=1.0: pipeline(noisy(drawn.levels(height), noise, rng)[0])


# One contact, or none.


@pytest.mark.parametrize("arithmetic", ["chip", "float"])
@pytest.mark.parametrize("model", ["cubic", "quadratic", "lut"])
def test_untouched_gel_does_not_touch(drawn: DrawnLight, model: Any, arithmetic: Any) -> None:
    """With the noise of a camera in the frames and in the reference, of one frame or the mean of 8."""
    rng = np.random.default_rng(SEED)
    for noise, averaged in ((0.0, 1), (1.0, 8), (2.0, 1)):
        reference = np.rint(noisy(drawn.untouched, noise, rng, averaged).mean(axis=0)).astype(np.uint8)
        pipeline = td.Pipeline(drawn.sensor, reference, model=model, arithmetic=arithmetic)
        results = pipeline(np.concatenate([reference[None], noisy(drawn.untouched, noise, rng, 4)]))
        assert not any(result.contact.touching for result in results)
        assert results.contacts == [[]] * 5


@pytest.mark.parametrize(("model", "arithmetic"), [("cubic", "chip"), ("quadratic", "chip"), ("cubic", "float")])
def test_a_light_touch_is_seen(drawn: DrawnLight, model: Any, arithmetic: Any) -> None:
    """Balls that are pressed 0.12 mm deep, everywhere, with 2 grey levels of noise."""
    rng = np.random.default_rng(SEED)
    pipeline = td.Pipeline(drawn.sensor, noisy(drawn.untouched, 2, rng)[0], model=model, arithmetic=arithmetic)
    for place in PLACES:
        pictures = [noisy(drawn.levels(ball(size, 0.12, *place)), 2, rng)[0] for size in (4.0, 9.5)]
        for result in pipeline(np.stack(pictures)):
            (contact,) = result.contacts
            assert result.contact.touching
            middle = np.array(place)[::-1] + np.array(CAMERA) / 2 * drawn.pitch_mm
            np.testing.assert_allclose(contact.centroid_mm, middle, atol=0.2)


def test_the_least_area_follows_the_threshold() -> None:
    """It is half of what the cap of a ball of 4 mm, 0.12 mm deep, has above it, and 0.1 mm^2 at least."""
    for threshold_mm in (0.01, 0.05, 0.07, 0.08):
        radius_mm, cap_mm = 2.0, 0.12 - threshold_mm
        area_mm2 = np.pi * (radius_mm**2 - (radius_mm - cap_mm) ** 2)
        assert least_area_mm2(threshold_mm) == pytest.approx(area_mm2 / 2, rel=0.03)
    assert least_area_mm2(0.12) == least_area_mm2(2.0) == 0.1


def test_the_least_area_is_in_pixels_of_the_grid(drawn: DrawnLight) -> None:
    reference = np.rint(drawn.untouched).astype(np.uint8)
    for grid, threshold_mm in (((96, 128), 0.07), ((48, 64), 0.07), ((96, 128), 0.5), ((24, 32), 0.5)):
        pipeline = td.Pipeline(drawn.sensor, reference, grid=grid, threshold_mm=threshold_mm)
        settings = pipeline.settings(threshold_mm, threshold_mm, 0.3)
        pixels = least_area_mm2(threshold_mm) / pipeline.pixel_pitch_mm**2
        assert settings.minimum_area == max(1, round(pixels))


def test_specks_have_no_values(seen: Any) -> None:
    """Pixels above the threshold without a contact stay in the record of the hardware alone."""
    result = seen(ball(6.31, 0.8))
    assert result.contact.touching
    codes = np.full_like(result.codes, 0)
    codes[[3, 40, 90], [5, 60, 120]] = 2 * result.threshold
    record = result.recorder.record(codes)
    contact = Contact(record, codes > result.threshold, 0.0, result.depth_lsb_mm, result.pixel_pitch_mm)
    assert (record.area, record.peak) == (3, 2 * result.threshold)
    assert not contact.touching
    assert (contact.peak_mm, contact.peak_height_mm, contact.area_mm2, contact.volume_mm3) == (0, 0, 0, 0)
    assert contact.centroid_mm is None
    assert not contact.is_mostly_empty


def test_real_presses_have_one_contact_and_their_background_none() -> None:
    folder, rng = real_folder(), np.random.default_rng(SEED)
    background = read_picture(folder / "background.png")
    for noise in (0.0, 2.0):
        pipeline = td.Pipeline(td.load("gelsight-mini"), noisy(background, noise, rng)[0])
        assert pipeline(noisy(background, noise, rng, 20)).contacts == [[]] * 20
    for press in read_presses(folder)[0][::4]:
        result = pipeline(press.image)
        (contact,) = result.contacts
        assert contact.record[3:] == result.contact.record[3:]
        assert not contact.is_mostly_empty


def test_the_least_area_exceeds_what_the_reference_itself_reads() -> None:
    """On a grid that ends within a block of the zero offset a corner of the real background reads 0.2 mm."""
    background, rng = read_picture(real_folder() / "background.png"), np.random.default_rng(SEED)
    pipeline = td.Pipeline(td.load("gelsight-mini"), background, grid=(100, 128))
    results = pipeline(noisy(background, 1, rng, 8))
    assert results.mask[0].sum() > 8
    assert results.contacts == [[]] * 8


def test_a_stream_begins_on_untouched_gel() -> None:
    """As the record of a device does that has seen the reference: a corner of it is above the threshold."""
    background = read_picture(real_folder() / "background.png")
    press = read_presses(real_folder())[0][0].image
    pipeline = td.Pipeline(td.load("gelsight-mini"), background, light_gains=False)
    (first,) = pipeline.stream([press])
    untouched, after = pipeline.stream([background, press])
    assert not untouched.contact.touching
    assert first.contact.record[3:] == after.contact.record[3:]
    assert first.contact.record.frame == untouched.contact.record.frame == 1


# Several contacts.


@pytest.mark.parametrize(
    "balls",
    [
        [(6.31, 0.6, -2.0, 0.0), (6.31, 0.6, 2.0, 1.0)],
        [(9.5, 0.8, -3.0, -1.0), (4.0, 0.2, 3.0, 2.0)],  # a deep one, and one above no area threshold
        [
            (9.5, 0.6, -3.0, -1.0),
            (4.0, 0.13, 3.0, 2.0),
        ],  # the deep one lowers the depth of the other
        [(4.0, 0.5, -1.1, 0.0), (4.0, 0.5, 1.1, 0.0)],  # side by side: the gel between them is above the threshold
        [(4.0, 0.3, -5.0, -3.0), (6.31, 0.5, 0.0, 3.0), (9.5, 0.7, 5.0, -2.0)],
    ],
)
def test_each_ball_is_a_contact(drawn: DrawnLight, seen: Any, balls: list[tuple[float, ...]]) -> None:
    result = seen(higher(*(ball(*each) for each in balls)))
    contacts = result.contacts
    assert len(contacts) == len(balls)
    sizes = [int(contact.mask.sum()) for contact in contacts]
    assert sizes == sorted(sizes, reverse=True)
    corner = np.array(CAMERA) / 2 * drawn.pitch_mm
    for size, depth, x, y in balls:
        off = [np.subtract(contact.centroid_mm, np.array((y, x)) + corner) for contact in contacts]
        nearest = contacts[int(np.argmin([np.hypot(*each) for each in off]))]
        np.testing.assert_allclose(nearest.centroid_mm, np.array((y, x)) + corner, atol=0.15)
        assert nearest.peak_height_mm == pytest.approx(depth, rel=0.15), (size, depth)
    assert max(contact.peak_mm for contact in contacts) == result.contact.peak_mm


PARTS = {"two_balls": 2, "seal": 2, "star_intaglio": 2, "letters_relief": 2, "letters_intaglio": 2}
"""Parts of bodies that have several."""


@pytest.mark.parametrize("name", td.samples())
def test_each_part_of_a_drawn_sample_is_a_contact(name: str) -> None:
    sample = td.sample(name)
    result = td.Pipeline(sample.sensor, sample.reference)(sample.image)
    assert len(result.contacts) == PARTS.get(name, 1)
    if name not in PARTS:
        assert result.contacts[0].record[3:] == result.contact.record[3:]


def test_a_batch_has_a_list_of_contacts_for_each_frame() -> None:
    sample = td.sample("two_balls")
    pipeline = td.Pipeline(sample.sensor, sample.reference)
    batch = pipeline([sample.image, sample.reference])
    assert [len(contacts) for contacts in batch.contacts] == [2, 0]
    assert batch.contacts[0] == batch[0].contacts == pipeline(sample.image).contacts


def test_a_record_says_that_its_box_is_mostly_empty(seen: Any) -> None:
    two = seen(higher(ball(4.0, 0.5, -4, -3), ball(4.0, 0.5, 4, 3))).contact
    assert two.is_mostly_empty
    assert two.record.box_share < 0.2
    one = seen(ball(4.0, 0.5)).contact
    assert not one.is_mostly_empty
    assert one.record.box_share == pytest.approx(np.pi / 4, abs=0.06)
    assert Record(0, 0, 0).box_share == 0


# Regions.


def test_regions_of_a_map() -> None:
    heights = np.zeros((12, 20), np.int64)
    heights[2:6, 2:6], heights[3:9, 9:16] = 50, 60
    heights[10, 18] = 90  # too small
    assert [int(each.sum()) for each in regions(heights, 10, 4)] == [42, 16]
    assert regions(heights, 100, 1) == []
    assert [int(each.sum()) for each in regions(heights, 10, 1)] == [42, 16, 1]


@pytest.mark.parametrize(("saddle", "count"), [(79, 2), (81, 1)])
def test_two_summits_are_two_contacts_if_the_height_falls_enough(saddle: int, count: int) -> None:
    """By a fifth of the lower summit, and by half the threshold."""
    heights = np.full((5, 11), 60)
    heights[:, 5] = saddle
    heights[2, 1], heights[2, 9] = 100, 300
    heights[:, 2:5], heights[:, 6:9] = saddle, saddle
    assert len(regions(heights, 10, 3)) == count
    assert len(regions(heights, 43, 3)) == 1


def test_regions_are_those_of_every_pixel_above_the_threshold() -> None:
    """On noise: regions share no pixel, and together are the pixels that have neighbours enough."""
    rng = np.random.default_rng(SEED)
    image = Image.fromarray(rng.integers(0, 255, (15, 20), dtype=np.uint8)).resize((80, 60), Image.Resampling.BICUBIC)
    heights = np.asarray(image).astype(np.int64)
    masks = regions(heights, 120, 1)
    np.testing.assert_array_equal(np.sum(masks, axis=0), heights > 120)
    for mask in masks:
        assert heights[mask].max() > 120


def test_a_device_frame_has_contacts(seen: Any) -> None:
    """In pixels of the grid, whatever the format."""
    result = seen(higher(ball(6.31, 0.6, -3, 0), ball(4.0, 0.4, 3, 1)))
    averaged = np.rint(result.codes.reshape(48, 2, 64, 2).mean(axis=(1, 3))).astype(np.int32)
    units = (result.recorder, result.depth_lsb_mm)
    for name, codes, span in (("words", result.codes, 1), ("averaged", averaged, 2)):
        pitch_mm = span * result.pixel_pitch_mm
        frame = td.DeviceFrame(codes, result.records[0], 1, 0.0, 0, None, *units, pitch_mm, 1.0, name, (96, 128))  # type: ignore[arg-type]
        if name == "words":
            assert frame.contacts == result.contacts
        assert len(frame.contacts) == 2
        for made, expected in zip(frame.contacts, result.contacts, strict=True):
            assert made.mask.shape == (96, 128)
            assert made.centroid_mm == pytest.approx(expected.centroid_mm, abs=0.05)
            assert made.area_mm2 == pytest.approx(expected.area_mm2, rel=0.06)
