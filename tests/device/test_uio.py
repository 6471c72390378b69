# SPDX-License-Identifier: Apache-2.0
"""Device on a Zynq: registers in files with the model behind them, and depth from a buffer that a VDMA writes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.device import frame_stores, uio, vdma
from tactile_depth.device.uio import Uio
from tests.device.conftest import GRID, BuildZynq
from tests.device.zynq import Played, Zynq, on_grid

CONFIGURATIONS: Mapping[str, Mapping[str, Any]] = {
    "three bytes": {},
    "two bytes": {"data_width": 15, "gain_width": 16, "depth_range_mm": 2},
    "spectral": {"solver": "spectral", "boundary": "dirichlet", "grid": (16, 16), "data_width": 20},
    "colours": {"model": "lut"},
}


@pytest.fixture(scope="session")
def pictures(sample: td.Sample) -> list[np.ndarray]:
    """Pictures that differ: pressed, untouched, and pressed less, uint8 (rows, columns, 3)."""
    untouched, pressed = (picture.astype(np.float64) for picture in (sample.reference, sample.image))
    return [np.rint(untouched + part * (pressed - untouched)).astype(np.uint8) for part in (1, 0, 0.6, 0.8)]


@pytest.fixture
def scenes(steady: td.Pipeline, pictures: list[np.ndarray]) -> np.ndarray:
    """Four pictures on the grid."""
    return on_grid(steady, pictures)


@pytest.fixture
def channel(zynq: Zynq) -> Iterator[Uio]:
    """Channel to the device, which collects."""
    channel = Uio(str(zynq.registers), str(zynq.vdma), str(zynq.buffer))
    channel.collect(True)
    yield channel
    channel.close()


def frames_of(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> list[int]:
    """Show pictures, look for a frame after each, and return the numbers of those that came; each is the model's."""
    numbers = []
    for picture in scenes:
        zynq.show(picture)
        for _ in range(3):
            arrival = channel.frame(0, channel.lost)
            if arrival is not None:
                require_made(arrival.frame, zynq)
                numbers.append(arrival.frame.number)
    return numbers


def noisy(untouched: np.ndarray) -> np.ndarray:
    """Return twelve untouched pictures that differ: their depth has no contact, so their records do not tell them."""
    noise = np.random.default_rng(3)
    pictures = [np.clip(untouched + noise.integers(-3, 4, untouched.shape), 0, 255) for _ in range(12)]
    return np.stack(pictures).astype(np.uint8)


def require_made(frame: Any, zynq: Zynq) -> None:
    """Require that a frame is the one that the model made under its number."""
    codes, record = zynq.made[frame.record.frame]
    np.testing.assert_array_equal(frame.codes, codes)
    assert frame.record == record
    assert frame.number == record.frame


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_frames_are_those_of_the_package(
    name: str, sample: td.Sample, pictures: list[np.ndarray], build_zynq: BuildZynq
) -> None:
    arguments = {"grid": GRID, "light_gains": False, **CONFIGURATIONS[name]}
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference, **arguments)
    zynq = build_zynq(pipeline)
    shown = on_grid(pipeline, pictures)
    results = {result.codes.tobytes(): result for result in pipeline(np.stack(pictures))}
    assert len(results) > 3
    zynq.film(shown)
    with td.Device(zynq.address, pipeline) as device:
        device.load()
        frames = list(islice(device.depth(), 12))
        zynq.stop()
    for frame in frames:
        require_made(frame, zynq)
        result = results[frame.codes.tobytes()]
        np.testing.assert_array_equal(frame.height_mm, result.height_mm.astype(np.float32))
        np.testing.assert_array_equal(frame.mask, result.mask)
        assert frame.contact.touching == result.contact.touching
        assert frame.picture is None
    numbers = [frame.number for frame in frames]
    assert numbers == sorted(set(numbers))
    lost = frames[-1].lost - frames[0].lost
    assert lost == numbers[-1] - numbers[0] - len(frames) + 1, "every frame between them is counted"


def test_light_gains_and_captures_of_the_camera(
    pipeline: td.Pipeline, sample: td.Sample, pictures: list[np.ndarray], build_zynq: BuildZynq
) -> None:
    zynq = build_zynq(pipeline)
    zynq.film(on_grid(pipeline, [sample.reference]))
    with td.Device(zynq.address, pipeline) as device:
        device.load()
        device.capture_reference(frames=4)
        device.capture_zero(frames=4)
        device.set_thresholds(touch_mm=0.1)
        zynq.stop()
        zynq.film(on_grid(pipeline, pictures))
        for frame in islice(device.depth(), 6):
            require_made(frame, zynq)
            assert frame.threshold_mm == pytest.approx(0.1, abs=pipeline.depth_lsb_mm)
        status = device.status()
    assert status[:4] == (*GRID, pipeline.config.data_width, 0)
    assert (status.delivered, status.skipped, status.bad_packets, status.bad_packets_of_device) == (6, 0, 0, 0)
    assert status.frames_in >= status.sent >= frame.number


def test_a_frame_comes_once(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    assert frames_of(channel, zynq, scenes) == [1, 2, 3, 4]
    assert (channel.delivered, channel.lost, zynq.dma.starts) == (4, 0, 1)


def test_frames_that_nobody_took_are_counted(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    assert frames_of(channel, zynq, scenes[:1]) == [1]
    for picture in scenes:
        zynq.show(picture)
    assert frames_of(channel, zynq, scenes[:2]) == [6, 7]
    assert channel.lost == 4
    for picture in scenes:
        zynq.show(picture)
    assert channel.ask().sent == 11
    assert channel.lost == 7, "the newest may still be taken"
    arrival = channel.frame(0, channel.lost)
    assert arrival is not None
    assert (arrival.frame.number, arrival.lost) == (11, 7)


def test_numbers_wrap(zynq: Zynq, scenes: np.ndarray) -> None:
    zynq.model.events.frames = (1 << 32) - 4
    zynq.show(scenes[0])
    channel = Uio(str(zynq.registers), str(zynq.vdma), str(zynq.buffer))
    channel.collect(True)
    assert frames_of(channel, zynq, scenes) == [(1 << 32) - 2, (1 << 32) - 1, 0, 1]
    assert channel.lost == 0
    channel.close()


@pytest.mark.parametrize("before", [True, False])
def test_the_record_comes_before_or_after_the_end_of_its_frame(
    before: bool, channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last words come to memory up to some microseconds after the record, or the other way round."""
    waiting: list[Callable[[], None]] = []

    def settle() -> None:
        while waiting:
            waiting.pop(0)()

    def late(land: Callable[[], None]) -> None:
        waiting.append(land)

    monkeypatch.setattr(uio, "_settle", settle)
    assert frames_of(channel, zynq, scenes[:1]) == [1]
    if before:
        zynq.landing = late
    assert frames_of(channel, zynq, scenes[1:]) == [2, 3, 4]


def test_a_store_that_is_written_while_it_is_copied_is_not_delivered(
    channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert frames_of(channel, zynq, scenes[:1]) == [1]
    copy, more = frame_stores.FrameStores.codes, [3, 1]

    def overtaken(stores: frame_stores.FrameStores, store: int) -> np.ndarray:
        for picture in scenes[: more.pop(0) if more else 0]:
            zynq.show(picture)
        return copy(stores, store)

    monkeypatch.setattr(frame_stores.FrameStores, "codes", overtaken)
    assert frames_of(channel, zynq, scenes[1:2]) == [5, 6], "2 was overtaken by three, 5 by one, which does no harm"
    assert channel.lost == 3


def test_a_frame_that_comes_while_the_first_is_looked_for(
    channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The number that is read then is not that of the store that was seen: the VDMA is started anew."""
    late = [scenes[1], scenes[2]]

    def settle() -> None:
        if late:
            zynq.show(late.pop(0))

    monkeypatch.setattr(uio, "_settle", settle)
    assert frames_of(channel, zynq, scenes[:1]) == []
    assert zynq.dma.starts == 2
    assert frames_of(channel, zynq, scenes) == [4, 5, 6, 7]


def test_frames_that_came_before_the_first_was_looked_for(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    pictures = noisy(scenes[1])
    for picture in pictures[:2]:
        zynq.show(picture)
    assert channel.frame(0, channel.lost) is None
    channel.ask()
    assert frames_of(channel, zynq, pictures[2:]) == list(range(3, 13))
    assert channel.lost == 0, "the stream begins with the first that is found"


def test_frames_that_come_too_fast(
    channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(uio, "_settle", lambda: zynq.show(scenes[1]))
    monkeypatch.setattr(uio, "MISSES", 3)
    with pytest.raises(td.DeviceError, match="frames come faster than this program reads them: let the camera send"):
        frames_of(channel, zynq, np.concatenate([scenes] * 2))


def test_a_record_that_changes_while_it_is_read_is_not_delivered(
    channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert frames_of(channel, zynq, scenes[:1]) == [1]
    read, offset, due = Played.read, uio.REGISTERS["RECORD_PEAK"].offset, [True]

    def overtaken(words: Played, at: int) -> int:
        if at == offset and due:
            due.clear()
            zynq.show(scenes[2])
        return read(words, at)

    monkeypatch.setattr(Played, "read", overtaken)
    assert frames_of(channel, zynq, scenes[1:2]) == [3]
    assert channel.lost == 1


def test_untouched_frames_that_come_in_pairs_have_their_own_depth(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    """Without contact a record says nothing of the depth: the store is found by the number alone."""
    pictures = noisy(scenes[1])
    assert frames_of(channel, zynq, pictures[:1]) == [1]
    for first in range(1, 11, 2):
        zynq.show(pictures[first])
        assert frames_of(channel, zynq, pictures[first + 1 : first + 2]) == [first + 2]
    assert len({codes.tobytes() for codes, _ in zynq.made.values()}) > 9
    assert (channel.delivered, channel.lost) == (6, 5)


@pytest.mark.parametrize("error", vdma.ERRORS.values())
def test_an_error_of_the_vdma_starts_it_anew(error: str, channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    assert frames_of(channel, zynq, scenes[:2]) == [1, 2]
    zynq.dma.fail(error)
    zynq.dma.store = 0
    assert frames_of(channel, zynq, scenes[:3]) == [4, 5]
    assert (zynq.dma.starts, channel.lost) == (2, 1)


def test_an_error_while_a_store_is_copied(
    channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert frames_of(channel, zynq, scenes[:1]) == [1]
    copy, errors = frame_stores.FrameStores.codes, ["VDMASlvErr"]

    def failing(stores: frame_stores.FrameStores, store: int) -> np.ndarray:
        while errors:
            zynq.dma.fail(errors.pop())
        return copy(stores, store)

    monkeypatch.setattr(frame_stores.FrameStores, "codes", failing)
    assert frames_of(channel, zynq, scenes[:3]) == [3, 4]
    assert (zynq.dma.starts, channel.lost) == (2, 1)


def test_errors_before_the_first_frame_do_not_count(zynq: Zynq, scenes: np.ndarray) -> None:
    channel = Uio(str(zynq.registers), str(zynq.vdma), str(zynq.buffer))
    channel.collect(True)
    zynq.dma.fail("EOLEarlyErr")
    assert frames_of(channel, zynq, scenes) == [1, 2, 3, 4]
    channel.close()


def test_an_error_that_stays_is_named(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    zynq.dma.stuck[vdma.STATUS] = 1 << 7 | 1 << 15
    with pytest.raises(td.DeviceError, match=r"the VDMA has errors: SOFEarlyErr, EOLLateErr: docs/cable\.md"):
        frames_of(channel, zynq, np.concatenate([scenes] * 3))
    zynq.dma.stuck.clear()
    assert len(frames_of(channel, zynq, scenes)) > 2, "the next call works"


def test_a_vdma_that_was_stopped_is_started(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    assert frames_of(channel, zynq, scenes[:2]) == [1, 2]
    zynq.dma._reset()
    assert frames_of(channel, zynq, scenes) == [4, 5, 6]
    assert channel.lost == 1


def test_depth_that_the_device_drops_shifts_no_store(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    zynq.dropped = {6}
    assert frames_of(channel, zynq, noisy(scenes[1])) == [1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12]
    assert channel.lost == 1


def test_frames_that_do_not_reach_the_buffer(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    zynq.landing = lambda land: None
    with pytest.raises(td.DeviceError, match="4 frames passed, and none reached the buffer: no error: connect m_axis"):
        frames_of(channel, zynq, np.concatenate([scenes] * 5))


def test_depth_that_is_not_that_of_its_record(
    channel: Uio, zynq: Zynq, scenes: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    take = zynq.dma.take
    monkeypatch.setattr(zynq.dma, "take", lambda codes, width: take(codes // 2, width))
    with pytest.raises(td.DeviceError, match="the depth in the buffer is not that of the record: m_axis goes to"):
        frames_of(channel, zynq, np.stack([scenes[0]] * 16))


def test_a_reset_is_raised_once(zynq: Zynq, steady: td.Pipeline, scenes: np.ndarray) -> None:
    zynq.film(scenes)
    with td.Device(zynq.address, steady) as device:
        device.load()
        frames = device.depth()
        require_made(next(frames), zynq)
        zynq.reset()
        with pytest.raises(td.DeviceError, match=r"the device was reset or lost its power: .* call load\(\) again"):
            list(islice(frames, 3))
        assert device.status().resets == 1
        device.load()
        for frame in islice(device.depth(), 3):
            require_made(frame, zynq)
        zynq.stop()


def test_a_reset_that_many_frames_have_followed(channel: Uio, zynq: Zynq, scenes: np.ndarray) -> None:
    channel.write([(uio.REGISTERS["THRESHOLD"].offset, 100)])
    assert frames_of(channel, zynq, scenes[:1]) == [1]
    zynq.reset()
    for picture in scenes:
        zynq.show(picture)
    with pytest.raises(td.DeviceError, match="the device was reset"):
        channel.check()
    channel.check()
    assert frames_of(channel, zynq, scenes[:2]) == [5, 6]


def test_a_reset_of_a_device_without_thresholds(build_zynq: BuildZynq, steady: td.Pipeline, scenes: np.ndarray) -> None:
    zynq = build_zynq(steady)
    zynq.show(scenes[0])
    zynq.show(scenes[0])
    channel = Uio(str(zynq.registers), str(zynq.vdma), str(zynq.buffer))
    zynq.reset()
    zynq.show(scenes[0])
    with pytest.raises(td.DeviceError, match="the device was reset"):
        channel.ask()
    assert (channel.ask().sent, channel.status.resets) == (1, 1)
    channel.close()


def test_thresholds_of_power_up_that_are_written_are_no_reset(channel: Uio, zynq: Zynq) -> None:
    watched = [uio.REGISTERS[name] for name in uio.WATCHED]
    assert all(register.reset is not None for register in watched)
    channel.write([(register.offset, register.reset or 0) for register in watched])
    channel.check()
    channel.write([(watched[0].offset, 100)])
    zynq.reset()
    with pytest.raises(td.DeviceError, match="the device was reset"):
        channel.check()


def test_an_index_beyond_a_table_closes_it(channel: Uio) -> None:
    select, index, low = (uio.REGISTERS[name].offset for name in ("TABLE_SELECT", "TABLE_INDEX", "TABLE_LOW"))
    assert channel.write([(select, 3), (index, 0), (low, 1), (low, 2), (index, 4000), (low, 3)]) == 5


def test_registers_by_name(zynq: Zynq, steady: td.Pipeline) -> None:
    """No access that the device refuses reaches it: its answer would end the program."""
    with td.Device(zynq.address, steady) as device:
        assert device.registers["ID"] == 0x54444550
        device.registers["THRESHOLD"] = -1
        assert device.registers["THRESHOLD"] == -1
        device.registers["TABLE_SELECT"] = 3
        device.registers["TABLE_INDEX"] = (1 << 12) - 1
        with pytest.raises(td.DeviceError, match="the device refuses to write TABLE_LOW"):
            device.registers["TABLE_LOW"] = 1
        with pytest.raises(td.DeviceError, match="the device refuses to read TABLE_HIGH"):
            device.registers["TABLE_HIGH"]
        device.registers["TABLE_INDEX"] = 0
        assert device.registers["TABLE_LOW"] == 0
        device.registers["TABLE_COMMIT.zero"] = 1
        with pytest.raises(td.DeviceError, match="the device refuses to write TABLE_LOW"):
            device.registers["TABLE_LOW"] = 1
        with pytest.raises(td.DeviceError, match="the device refuses to write ZERO_CAPTURE"):
            device.registers["ZERO_CAPTURE.start"] = 1
        device.registers["REFERENCE_CAPTURE.start"] = 1
        device.registers["TABLE_SELECT"] = 2
        with pytest.raises(td.DeviceError, match="the device refuses to write TABLE_LOW"):
            device.registers["TABLE_LOW"] = 1
        assert device._line is not None
        assert device._line.read([0, 0x3FC, 4]) == [0x54444550]
        assert device._line.write([(0x14, 5), (0, 1), (0x14, 6)]) == 1


def test_captures_that_a_device_without_their_tables_refuses(sample: td.Sample, build_zynq: BuildZynq) -> None:
    pipeline = td.Pipeline(td.load("synthetic"), grid=(16, 16), zero_offset=False)
    with td.Device(build_zynq(pipeline).address, pipeline) as device:
        for name in ("REFERENCE_CAPTURE", "ZERO_CAPTURE"):
            with pytest.raises(td.DeviceError, match=f"the device refuses to write {name}"):
                device.registers[f"{name}.start"] = 1


def test_pictures_are_not_sent(
    zynq: Zynq, steady: td.Pipeline, sample: td.Sample, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Uio, "quiet_s", 0.05)
    line = "uio carries no pictures to the device: they come from its camera: let the camera send"
    with td.Device(zynq.address, steady) as device:
        with pytest.raises(td.DeviceError, match=line):
            next(device.depth([sample.image]))
        with pytest.raises(td.DeviceError, match=line):
            device.load()
