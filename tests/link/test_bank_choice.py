# SPDX-License-Identifier: Apache-2.0
"""bank_choice: RTL against the model, and the model against its rules."""

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.link.bank_choice import BankChoice


class Frames:
    """A writer and a reader around the model, with the number of the frame in each bank."""

    def __init__(self) -> None:
        self.model = BankChoice()
        self.banks: list[int | None] = [None, None]  # None: not whole
        self.begun = self.ended = self.published = -1
        self.taken: list[int] = []
        self.lost = 0
        self.read: int | None = None

    def clock(self, writes: str, publish: bool, reads: bool) -> None:
        """Advance by one clock; a word of the writer that it cannot say now is left out."""
        writing, read = self.model.written is not None, self.model.read is not None
        write_end = writes == "end" and writing
        write_begin = writes == "begin"
        done = reads and read
        take = reads and not read and self.model.ready is not None
        if take:
            assert self.model.ready is not None
            self.read = self.banks[self.model.ready]
            assert self.read == self.published, "not the newest"
            self.taken.append(self.published)
        seen = self.model.clock(write_begin=write_begin, write_end=write_end, publish=publish, take=take, done=done)
        if write_begin:
            self.begun += 1
            assert seen["write_bank"] is not None
            assert seen["write_bank"] != self.model.read, "the bank that is read is written"
            self.banks[seen["write_bank"]] = None
        if write_end:
            assert seen["write_bank"] is not None
            self.banks[seen["write_bank"]] = self.ended = self.begun
        self.lost += bool(seen["replaced"])
        if self.model.ready is not None and publish:
            self.published = max(self.published, self.banks[self.model.ready] or 0)


STEPS = st.lists(st.tuples(st.sampled_from(["", "begin", "end"]), st.booleans(), st.booleans()), max_size=80)


@given(STEPS)
def test_the_newest_frame_is_taken_whole(steps: Sequence[tuple[str, bool, bool]]) -> None:
    frames = Frames()
    for step in steps:
        frames.clock(*step)
    assert frames.taken == sorted(set(frames.taken))


@given(STEPS)
def test_each_frame_is_taken_held_or_lost(steps: Sequence[tuple[str, bool, bool]]) -> None:
    frames, ended = Frames(), 0
    for step in steps:
        before = frames.ended
        frames.clock(*step)
        ended += frames.ended != before
    held = sum(bank is not None for bank in (frames.model.whole, frames.model.ready))
    assert ended == len(frames.taken) + frames.lost + held


@given(st.lists(st.tuples(st.integers(1, 3), st.booleans()), min_size=1, max_size=20))
def test_without_a_reader_the_newest_frame_is_always_there(frames: Sequence[tuple[int, bool]]) -> None:
    """Publish each frame before the next one ends, inside it or before it begins."""
    model, ready = BankChoice(), False
    bank: int | None = None
    for begins, late in frames:
        for number in range(begins):
            seen = model.clock(write_begin=True, publish=late and number == 0 and ready)
            assert model.ready is None or model.ready != seen["write_bank"]
            assert bank is None or seen["write_bank"] != bank or model.ready is not None
        if late and ready:
            assert model.ready == bank
        if not late and ready:
            model.clock(publish=True)
            assert model.ready == bank, "lost before it was ready"
        bank, ready = model.clock(write_end=True)["write_bank"], True
        assert model.whole == bank
