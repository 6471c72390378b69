# SPDX-License-Identifier: Apache-2.0
"""Tables of tactile_depth: content of the build, content that frames use, and accesses by registers.

Tables survive a reset, so the next test finds the content that a test wrote. `changed` holds the names of the tables
that differ from the build, and every test begins with `restore`, which writes them back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import pixel_gains
from tactile_depth.chip.gradient.polynomial_gradient import coefficient_map
from tactile_depth.chip.limits import CUBIC
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import REGISTERS, TABLES
from tactile_depth.chip.table_entries import ONE_WORD, table_entries
from tactile_depth.chip.tactile_depth import Tables
from tactile_depth.sensor.synthetic import synthetic
from tb.axil import RegisterClient

COMMIT = REGISTERS["TABLE_COMMIT"]

changed: set[str] = set()  # tables of the device that differ from the build; only this state outlives a test


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
        """Return the content of the build."""
        return cls(config, table_entries(synthetic(config.bits_per_channel), config))

    def with_table(self, name: str, entries: np.ndarray) -> Content:
        """Return this content with one table replaced."""
        return Content(self.config, {**self.entries, name: entries.copy()})

    @cached_property
    def slopes(self) -> Tables:
        """Return the tables with which the models convert colours to slopes."""
        gains = None
        if "reference" in self.entries:
            nodes = self.entries["reference"][:, 0].reshape(*self.config.reference_nodes, 4)
            gains = pixel_gains(nodes[..., :3], self.config)
        if "coefficients" in self.entries:
            words = self.entries["coefficients"][:, 0].reshape(CUBIC)
            return Tables(gains, coefficient_map(words, self.config), self.entries.get("gradient"))
        return Tables(gains, self.entries["gradient"])

    @cached_property
    def zero(self) -> np.ndarray | None:
        """Return the zero offset, int64 (node rows, node columns); None in a build without it."""
        zero = self.entries.get("zero")
        return None if zero is None else zero[:, 0].reshape(self.config.reference_nodes)


class DeviceTables:
    """The tables of the device, through its registers.

    Attributes
    ----------
    content : Content
        Content that the next frames use.
    """

    def __init__(self, config: Configuration, registers: RegisterClient) -> None:
        self.registers = registers
        self.content = Content.built(config)

    def use(self, name: str, entries: np.ndarray) -> None:
        """Expect the next frames to use this table."""
        changed.add(name)
        self.content = self.content.with_table(name, entries)

    async def restore(self) -> None:
        """Write the content of the build to the changed tables and commit them: the next frame uses them."""
        for name in sorted(changed):
            await self.write(name, self.content.entries[name])
        await self.registers.write("TABLE_COMMIT", COMMIT.pack(**dict.fromkeys(changed, 1)))

    async def write(self, name: str, entries: np.ndarray) -> None:
        """Write every entry of the free bank in order, after the previous change-over."""
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
        """Write one entry of the free bank; return the response to its lower word."""
        for register, value in (("TABLE_SELECT", TABLES[name]), ("TABLE_INDEX", index), ("TABLE_HIGH", high)):
            assert await self.registers.write(register, value) == Response.OKAY
        return await self.registers.write("TABLE_LOW", low)

    async def read(self, name: str) -> np.ndarray:
        """Return the entries of the free bank, int64 (entries, 2), as signed words."""
        await self.registers.write("TABLE_SELECT", TABLES[name])
        await self.registers.write("TABLE_INDEX", 0)
        words = []
        for _ in range(await self.registers.read("TABLE_SIZE")):
            high = await self.registers.read("TABLE_HIGH")
            words.append([await self.registers.read("TABLE_LOW"), high])
        return np.array(words, np.uint32).astype(np.int32).astype(np.int64)

    async def commit(self, name: str, entries: np.ndarray | None = None) -> None:
        """Commit the table; with `entries` expect the next frames to use them."""
        changed.add(name)
        assert await self.registers.write("TABLE_COMMIT", COMMIT.pack(**{name: 1})) == Response.OKAY
        if entries is not None:
            self.use(name, entries)
