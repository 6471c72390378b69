# SPDX-License-Identifier: Apache-2.0
"""Registers of a device by name."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator, MutableMapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress

from tactile_depth.base.errors import Argument, InputError, counted
from tactile_depth.chip.registers.register_map import REGISTERS, WORD, Field, Register
from tactile_depth.device.channel import Channel
from tactile_depth.device.errors import DeviceError

REMEDY = "docs/generated/registers.md says when"
VALUE = "value"  # the field of a register that holds a single number


def read_words(line: Channel, names: Sequence[str]) -> dict[str, int]:
    """Return the words of registers by name, all of one request if they are at most 128.

    Raises DeviceError if the device refuses one, or does not answer.
    """
    words = line.read([REGISTERS[name].offset for name in names])
    if len(words) < len(names):
        raise DeviceError(f"the device refuses to read {names[len(words)]}", remedy=REMEDY)
    return dict(zip(names, words, strict=True))


def write_words(line: Channel, pairs: Sequence[tuple[str, int]]) -> None:
    """Write words to registers, in order. Raises DeviceError if the device refuses one, or does not answer."""
    done = line.write([(REGISTERS[name].offset, word & WORD) for name, word in pairs])
    if done < len(pairs):
        problem = f"the device refuses to write {pairs[done][0]} ({done} of {counted(len(pairs), 'access')} done)"
        raise DeviceError(problem, remedy=REMEDY)


@contextmanager
def meanwhile(line: Channel, name: str, word: int, then: int) -> Iterator[None]:
    """Write a word to a register, and `then` at the end of the context. Raises DeviceError as `write_words`."""
    failed = False
    try:
        write_words(line, [(name, word)])
        yield
    except BaseException:  # also the end of a loop that was left, when the line may be closed
        failed = True
        raise
    finally:
        with suppress(DeviceError) if failed else nullcontext():  # the first error says what happened
            write_words(line, [(name, then)])


class Registers(MutableMapping[str, int]):
    """Registers of a device by name, such as `FRAMES_OUT`, and fields, such as `CONTROL.hold_contact`.

    Each access goes to the device. A value with a sign is signed. An assignment to a field leaves the other settings
    of its register as they are.

    Parameters
    ----------
    line : function
        Gives a context with the line to the device.
    """

    def __init__(self, line: Callable[[], AbstractContextManager[Channel]]) -> None:
        self._line = line

    def __getitem__(self, name: str) -> int:
        """Return a value. Raises InputError for an unknown name, DeviceError if the device does not answer."""
        register, field = _named(name)
        with self._line() as line:
            word = read_words(line, [register.name])[register.name]
        return word if field is None else _value(word, field)

    def __setitem__(self, name: str, value: int) -> None:
        """Write a value. Raises InputError if it does not fit, DeviceError if the device refuses or does not answer."""
        register, field = _named(name)
        low, high = _limits(field)
        if isinstance(value, bool):
            value = int(value)
        if not isinstance(value, int) or not low <= value <= high:
            raise InputError(Argument(name, value), accepted=f"a whole number, {low} to {high}")
        if not register.writable or (field is not None and field.access == "ro"):
            raise InputError(Argument(name, value), ": the register is read-only")
        with self._line() as line:
            word = value & WORD
            if field is not None:
                kept = sum(other.mask for other in register.fields if other.setting and other is not field)
                word = value << field.low & field.mask
                word |= read_words(line, [register.name])[register.name] & kept if kept else 0
            write_words(line, [(register.name, word)])

    def __delitem__(self, name: str) -> None:
        raise InputError(Argument(name), ": a register cannot be deleted")

    def __iter__(self) -> Iterator[str]:
        """Give the names of the registers."""
        return iter(REGISTERS)

    def __len__(self) -> int:
        return len(REGISTERS)

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and bool(_named(name))
        except InputError:
            return False

    def __repr__(self) -> str:
        return f"Registers({len(self)})"


def _named(name: str) -> tuple[Register, Field | None]:
    """Return a register and its field; None for the whole word of a register with several fields."""
    text, dot, part = name.partition(".") if isinstance(name, str) else ("", "", "")
    register = REGISTERS.get(text)
    if register is None:
        near = difflib.get_close_matches(text, REGISTERS, n=3)
        raise InputError(Argument("register", name), " is unknown", accepted=near or list(REGISTERS))
    if not dot:
        return register, register.fields[0] if [field.name for field in register.fields] == [VALUE] else None
    field = next((field for field in register.fields if field.name == part), None)
    if field is None:
        accepted = [f"{text}.{field.name}" for field in register.fields]
        raise InputError(Argument("register", name), " is unknown", accepted=accepted)
    return register, field


def _limits(field: Field | None) -> tuple[int, int]:
    if field is None:
        return 0, WORD
    return (-1 << field.width - 1, (1 << field.width - 1) - 1) if field.signed else (0, (1 << field.width) - 1)


def _value(word: int, field: Field) -> int:
    value = (word & field.mask) >> field.low
    return value - (value >> field.width - 1 << field.width) if field.signed else value
