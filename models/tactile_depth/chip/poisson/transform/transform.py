# SPDX-License-Identifier: Apache-2.0
"""Formats of a sine or cosine transform of bursts, which its models share."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Transform:
    """Formats of a transform.

    Attributes
    ----------
    input_drop, output_drop : int
        Fraction bits dropped between the input and the `width` bits of the arithmetic (negative: added), and between
        the arithmetic and the `output_width` bits of the output.
    factor_width : int
        Bits of the coefficients.
    alternate : bool
        If False, the sign (-1)^n is left out, and the transform is a DCT-II or its inverse.
    """

    input_drop: int
    width: int
    factor_width: int
    output_drop: int
    output_width: int
    alternate: bool = True

    @property
    def factor_drop(self) -> int:
        """Fraction bits of a coefficient."""
        return self.factor_width - 1
