# SPDX-License-Identifier: Apache-2.0
"""Entries of the tables of a calibration, as software writes them to the registers TABLE_HIGH and TABLE_LOW."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_offset import no_zero
from tactile_depth.chip.gradient.flat_field import reference_gains
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes
from tactile_depth.chip.gradient.polynomial_gradient import correction_entries, polynomial_words

ONE_WORD = ("coefficients", "reference", "zero")
"""Tables whose entries have no upper word."""


def table_entries(
    calibration: Calibration, config: Configuration, zero: np.ndarray | None = None, gains: np.ndarray | None = None
) -> dict[str, np.ndarray]:
    """Return the entries of every table that the hardware of a configuration has, by the table's name in TABLE_SELECT.

    Parameters
    ----------
    zero : int64 array (node rows, node columns), optional
        Zero offset, for a configuration with `zero_offset`; by default nothing is subtracted.
    gains : int64 array (node rows, node columns, 3), optional
        Gains of the flat field; by default those of the calibration's reference.

    Returns
    -------
    dict of int64 array (entries, 2): signed lower and upper word of each entry

    Raises
    ------
    InputError
        The calibration and the configuration do not agree.
    """
    calibration.check(config, gains is not None)
    entries = {}
    if config.polynomials:
        corrections = correction_entries(calibration, config)
        if corrections is not None:
            entries["gradient"] = corrections
        entries["coefficients"] = one_word(polynomial_words(calibration, config))
    else:
        entries["gradient"] = gradient_codes(calibration, config)
    if config.flat_field:
        entries["reference"] = reference_entries(reference_gains(calibration, config) if gains is None else gains)
    if config.zero_offset:
        entries["zero"] = one_word(no_zero(config) if zero is None else zero)
    return entries


def one_word(low: np.ndarray) -> np.ndarray:
    """Return the entries (n, 2) of a table without upper words."""
    return np.stack([low.ravel(), np.zeros(low.size, np.int64)], axis=-1)


def reference_entries(gains: np.ndarray) -> np.ndarray:
    """Return the entries of the reference table from gains (node rows, node columns, 3), with a fourth channel of 0."""
    return one_word(np.pad(gains, ((0, 0), (0, 0), (0, 1))))
