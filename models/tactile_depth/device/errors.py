# SPDX-License-Identifier: Apache-2.0
"""The error for what fails between a host and a device although the input is right."""

from __future__ import annotations

from tactile_depth.base.errors import _Message


class DeviceError(_Message, RuntimeError):
    """One line that says what failed and how to mend it: a silent device, an unplugged cable, a reset, garbage.

    It is raised once; the next call works if its cause is gone.
    """
