# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/black_level.sv."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

LATENCY = 1


def black_level(samples: np.ndarray, level: int) -> np.ndarray:
    """Return the samples, int64, less the black level."""
    return samples - level


@dataclass
class BlackLevel:
    """State of the core: settings of the present frame, None before the first, and what leaves in this clock."""

    bits: int
    channels: int
    settings: tuple[int, int] | None = None
    out: dict[str, int] = field(default_factory=dict)

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"out_valid": 0, "out_abort": 0} | self.out
        if pins["en"]:
            self.out = {"out_abort": pins["in_abort"]}
            if pins["in_valid"]:
                if pins["in_frame_start"]:
                    self.settings = pins["level"], pins["gains"]
                assert self.settings is not None, "a frame begins with its start"
                level, gains = self.settings
                width = self.bits + 2
                samples = np.array([pins["in_samples"] >> width * n for n in range(self.channels)], object)
                words = (word % (1 << width) << width * n for n, word in enumerate(black_level(samples, level)))
                marks = {f"out_{mark}": pins[f"in_{mark}"] for mark in ("colour", "row_start", "frame_start")}
                self.out |= {"out_valid": 1, "out_samples": sum(words), "out_gains": gains, **marks}
        if pins["rst"]:
            self.out = {}
        return out
