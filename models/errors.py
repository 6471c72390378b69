# SPDX-License-Identifier: Apache-2.0
"""The one kind of error that a user's input raises."""


class InputError(ValueError):
    """Input that cannot be used: one line that says what was given, what is accepted and how to mend it."""
