# SPDX-License-Identifier: Apache-2.0
"""The only error that a user's input raises, and the only warning."""

from numbers import Real

LONGEST = 1000  # characters


def is_number(value: object) -> bool:
    """Return True for a real number; True and False are none."""
    return isinstance(value, Real) and not isinstance(value, bool)


class InputError(ValueError):
    """Input cannot be used; the message is one line that says what was given, what is accepted and how to fix it.

    Line breaks in the message are replaced, and a long message is shortened to LONGEST characters.
    """

    def __init__(self, message: str) -> None:
        line = "".join(character if character.isprintable() else "?" for character in message)
        if len(line) > LONGEST:
            line = f"{line[: LONGEST // 2]} .. {line[-LONGEST // 4 :]}"
        super().__init__(line)


class InputWarning(UserWarning):
    """Input is used but may be wrong; the message is one line that says how to make it certain."""
