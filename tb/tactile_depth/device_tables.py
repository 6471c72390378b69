# SPDX-License-Identifier: Apache-2.0
"""The tables of tactile_depth: what the device was built with, what its frames use, and how to write them.

Tables survive a reset, so what a test writes is still there in the next test. `changed` keeps the names of the tables
that are not as built any more, and every test begins with `restore`, which writes those back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tactile_depth.calibration.auto_zero import no_floor
from tactile_depth.calibration.flat_field import pixel_gains, unit_gains
from tactile_depth.configuration import Configuration
from tactile_depth.gradient.gradient_lookup import gradient_codes
from tactile_depth.gradient.quadratic_gradient import coefficient_map, polynomial_words
from tactile_depth.registers.axil_port import Response
from tactile_depth.registers.register_map import REGISTERS, TABLES
from tactile_depth.sensor import COEFFICIENTS, synthetic
from tactile_depth.tactile_depth import Tables
from tb.axil import RegisterClient

COMMIT = REGISTERS["TABLE_COMMIT"]
ONE_WORD = ("coefficients", "reference", "floor")  # tables whose entries have no upper word

changed: set[str] = set()  # tables of the device that are not as built: the one thing that outlives a test


def one_word(low: np.ndarray) -> np.ndarray:
    """Return the entries (n, 2) of a table without upper words."""
    return np.stack([low.ravel(), np.zeros(low.size, np.int64)], axis=-1)


def reference_entries(gains: np.ndarray) -> np.ndarray:
    """Return the entries of the reference table from gains (node rows, node columns, 3): a channel 3 follows, of 0."""
    return one_word(np.pad(gains, ((0, 0), (0, 0), (0, 1))))


@dataclass(frozen=True, eq=False)
class Content:
    """The content of the tables that a frame uses.

    Attributes
    ----------
    entries : mapping of a table's name to int64 array (entries, 2)
        Lower and upper word of each entry, for every table of the build.
    """

    config: Configuration
    entries: Mapping[str, np.ndarray]

    @classmethod
    def built(cls, config: Configuration) -> Content:
        """Return the content that the device comes up with."""
        sensor = synthetic(config.bits_per_channel)
        entries = {}
        if config.gradient_model == "lut":
            entries["gradient"] = gradient_codes(sensor, config)
        else:
            entries["coefficients"] = one_word(polynomial_words(sensor, config, sensor.pixel_pitch_mm))
        if config.flat_field:
            entries["reference"] = reference_entries(unit_gains(config))
        if config.auto_zero:
            entries["floor"] = one_word(no_floor(config))
        return cls(config, entries)

    def with_table(self, name: str, entries: np.ndarray) -> Content:
        """Return this content with another table in place of one."""
        return Content(self.config, {**self.entries, name: entries.copy()})

    @cached_property
    def slopes(self) -> Tables:
        """Tables of the models that turn colours into slopes."""
        gains = None
        if "reference" in self.entries:
            nodes = self.entries["reference"][:, 0].reshape(*self.config.reference_nodes, 4)
            gains = pixel_gains(nodes[..., :3], self.config)
        if "coefficients" in self.entries:
            words = self.entries["coefficients"][:, 0].reshape(COEFFICIENTS)
            return Tables(gains, coefficient_map(words, self.config))
        return Tables(gains, self.entries["gradient"])

    @cached_property
    def floor(self) -> np.ndarray | None:
        """Floor, int64 (node rows, node columns); None in a build without it."""
        floor = self.entries.get("floor")
        return None if floor is None else floor[:, 0].reshape(self.config.reference_nodes)


class DeviceTables:
    """The tables of the device, through its registers.

    Attributes
    ----------
    content : Content
        What the frames to come use.
    """

    def __init__(self, config: Configuration, registers: RegisterClient) -> None:
        self.registers = registers
        self.content = Content.built(config)

    def use(self, name: str, entries: np.ndarray) -> None:
        """Expect the frames to come to use this table."""
        changed.add(name)
        self.content = self.content.with_table(name, entries)

    async def restore(self) -> None:
        """Write what was changed, as built, and commit it: the next frame takes it into use."""
        for name in sorted(changed):
            await self.write(name, self.content.entries[name])
        await self.registers.write("TABLE_COMMIT", COMMIT.pack(**dict.fromkeys(changed, 1)))

    async def write(self, name: str, entries: np.ndarray) -> None:
        """Write every entry of the bank that no frame uses, one after another, after the commit before is over."""
        while await self.registers.read("TABLE_COMMIT"):
            pass
        await self.registers.write("TABLE_SELECT", TABLES[name])
        assert await self.registers.read("TABLE_SIZE") == len(entries)
        await self.registers.write("TABLE_INDEX", 0)
        for index, (low, high) in enumerate(entries.tolist()):
            if name not in ONE_WORD:
                await self.registers.write("TABLE_HIGH", high)
            assert await self.registers.write("TABLE_LOW", low) == Response.OKAY, f"refused at entry {index}"
        assert await self.registers.read("TABLE_INDEX") == 0, "TABLE_INDEX does not wrap at the end of the table"

    async def write_entry(self, name: str, index: int, low: int, high: int) -> Response:
        """Write one entry of the bank that no frame uses; return the response to its lower word."""
        for register, value in (("TABLE_SELECT", TABLES[name]), ("TABLE_INDEX", index), ("TABLE_HIGH", high)):
            assert await self.registers.write(register, value) == Response.OKAY
        return await self.registers.write("TABLE_LOW", low)

    async def read(self, name: str) -> np.ndarray:
        """Return the entries of the bank that no frame uses, int64 (entries, 2), as signed words."""
        await self.registers.write("TABLE_SELECT", TABLES[name])
        await self.registers.write("TABLE_INDEX", 0)
        words = []
        for _ in range(await self.registers.read("TABLE_SIZE")):
            high = await self.registers.read("TABLE_HIGH")
            words.append([await self.registers.read("TABLE_LOW"), high])
        return np.array(words, np.uint32).astype(np.int32).astype(np.int64)

    async def commit(self, name: str, entries: np.ndarray | None = None) -> None:
        """Commit what was written; with `entries` expect the frames to come to use it."""
        changed.add(name)
        assert await self.registers.write("TABLE_COMMIT", COMMIT.pack(**{name: 1})) == Response.OKAY
        if entries is not None:
            self.use(name, entries)
