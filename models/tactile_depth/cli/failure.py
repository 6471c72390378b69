# SPDX-License-Identifier: Apache-2.0
"""The one kind of error for what fails on the way although the input is right."""


class Failure(RuntimeError):
    """One line that says what failed and how to mend it: a library that is missing, a camera that is gone."""
