# SPDX-License-Identifier: Apache-2.0
"""Self-test of a device: the signature of the depth of a picture from inside."""

from __future__ import annotations

import time

from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.chip.registers.event_registers import CONTROL, SELF_TEST
from tactile_depth.device.arrived import arrived
from tactile_depth.device.captures import held_light, write_gains
from tactile_depth.device.channel import Channel
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.exchange import CAMERA_S
from tactile_depth.device.registers import read_words, write_words


def signature_of(line: Channel) -> int:
    """Return the signature of a self-test with light gains of 1; the gains are then those before it.

    Raises
    ------
    DeviceError
        The picture does not come through, or the device does not answer.
    """
    before = read_words(line, [CONTROL.name, *GAINS])
    control = before.pop(CONTROL.name) | CONTROL.field("self_test").mask
    with held_light(line):
        write_gains(line, [1 << LIGHT_GAIN.fraction] * len(GAINS))
        try:
            write_words(line, [(CONTROL.name, control)])
            return _awaited(line)
        finally:
            write_gains(line, [*before.values()])


def _awaited(line: Channel) -> int:
    limit_s = line.limit_s + CAMERA_S
    ends = time.monotonic() + limit_s
    while time.monotonic() < ends:
        if signature := read_words(line, [SELF_TEST])[SELF_TEST]:
            return signature
    came = arrived(line)
    reason = f", {came.problem}" if came.problem else ""
    raise DeviceError(
        f"the picture of the self-test has not come through in {limit_s:.1f} s{reason}",
        remedy=came.remedy or "let the camera end its frame, or set TIMEOUT; a sink of depth must take it",
    )
