# SPDX-License-Identifier: Apache-2.0
"""models/register_map.py: the map is consistent, and what is written from it is up to date."""

import pytest

from models.register_map import ACCESSES, ADDRESS_WIDTH, MAP, REGISTERS, ROOT, WORD_BITS, generated


@pytest.mark.parametrize("path", generated(), ids=lambda path: path.name)
def test_generated_files_are_up_to_date(path):
    assert path.read_text() == generated()[path], (
        f"{path.relative_to(ROOT)} is not what the map says: run python -m models.register_map"
    )


def test_offsets_are_words_of_their_own():
    offsets = [register.offset for register in MAP]
    assert len(set(offsets)) == len(offsets)
    assert all(offset % (WORD_BITS // 8) == 0 for offset in offsets)
    assert all(0 <= offset < 1 << ADDRESS_WIDTH for offset in offsets)


def test_names_are_unique():
    assert len(REGISTERS) == len(MAP)
    for register in MAP:
        names = [field.name for field in register.fields]
        assert len(set(names)) == len(names), register.name


def test_accesses_are_known():
    for register in MAP:
        assert {register.access, *(field.access for field in register.fields)} <= set(ACCESSES), register.name


@pytest.mark.parametrize("register", MAP, ids=lambda register: register.name)
def test_fields_share_no_bit(register):
    taken = 0
    for field in register.fields:
        assert 0 <= field.low <= field.high < WORD_BITS, field.name
        assert not taken & field.mask, f"{field.name} overlaps a field before it"
        taken |= field.mask
    if register.fields and register.reset is not None:
        assert register.reset & ~taken == 0


@pytest.mark.parametrize("register", MAP, ids=lambda register: register.name)
def test_pack_is_the_inverse_of_unpack(register):
    fields = {field.name: (n + 1) % (1 << field.width) for n, field in enumerate(register.fields)}
    assert register.unpack(register.pack(**fields)) == fields


def test_a_value_too_large_for_its_field_is_refused():
    with pytest.raises(ValueError, match=r"STATUS\.busy=2 does not fit: accepted are 0 to 1"):
        REGISTERS["STATUS"].pack(busy=2)
    with pytest.raises(KeyError, match="it has rows, columns"):
        REGISTERS["GRID"].field("cols")
