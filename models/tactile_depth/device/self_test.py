# SPDX-License-Identifier: Apache-2.0
"""Self-test of a device: the signature of the depth of a picture from inside."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace

from tactile_depth.chip.gradient.flat_field import pixel_gains
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.chip.registers.event_registers import CONTROL, SELF_TEST
from tactile_depth.chip.self_test import self_test
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.arrived import arrived
from tactile_depth.device.captures import Unseen, codes_at_nodes, gains_at_nodes, unity_light, write_gains
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
    with unity_light(line):
        try:
            write_words(line, [(CONTROL.name, control)])
            return _awaited(line)
        finally:
            write_gains(line, [*before.values()])


def expected_signature(twin: Pipeline, unseen: Mapping[str, Unseen], dark_level: int) -> int:
    """Return the signature of a pipeline with the tables of captures whose entries are known."""
    config, tables, zero = twin.config, twin.twin.tables, twin.zero_codes
    entries = {name: each.entries for name, each in unseen.items() if each.entries is not None}
    if "reference" in entries:
        tables = replace(tables, gains=pixel_gains(gains_at_nodes(entries["reference"], config), config))
    if "zero" in entries:
        zero = codes_at_nodes(entries["zero"], config)
    return self_test(config, tables, zero, dark_level)


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
