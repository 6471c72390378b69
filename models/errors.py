# SPDX-License-Identifier: Apache-2.0
"""The one kind of error that a user's input raises."""

LONGEST = 1000  # characters


class InputError(ValueError):
    """Input that cannot be used: one line that says what was given, what is accepted and how to mend it.

    What was given may hold line breaks or be very long; the line does not.
    """

    def __init__(self, message: str) -> None:
        line = "".join(character if character.isprintable() else "?" for character in message)
        if len(line) > LONGEST:
            line = f"{line[: LONGEST // 2]} .. {line[-LONGEST // 4 :]}"
        super().__init__(line)
