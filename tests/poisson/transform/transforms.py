# SPDX-License-Identifier: Apache-2.0
"""Error bound that the tests of both sine transforms share."""

from typing import Any

import numpy as np


def coefficient_noise(stages: Any, coeff: int) -> Any:
    """RMS error, relative to the RMS of the result, of a chain of multiplications by rounded factors.

    Both parts of a factor err by up to half a step of 2**(1 - coeff), evenly: sqrt(2 / 12) of it together,
    and stages add in squares. Measured: 0.3 to 0.8 of that, since some factors are exact.
    """
    return np.sqrt(stages / 6) * 2.0 ** (1 - coeff)
