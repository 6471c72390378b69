# SPDX-License-Identifier: Apache-2.0
"""The models that take the most time, in numpy or compiled."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from tactile_depth.chip.gradient.light_gains import settled
from tactile_depth.chip.poisson.elimination import elimination
from tactile_depth.chip.poisson.substitution import substitution
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse, dst_inverse_pairs

Model = Callable[..., "np.ndarray"]


class Cores(NamedTuple):
    """Models with the arguments and the results of those in numpy."""

    dst_forward: Model
    dst_inverse: Model
    dst_inverse_pairs: Model
    elimination: Model
    substitution: Model
    settled: Model


NUMPY = Cores(dst_forward, dst_inverse, dst_inverse_pairs, elimination, substitution, settled)
"""The reference, with which RTL is compared."""


@cache
def fastest() -> Cores:
    """Return the compiled models if numba (extra `fast`) is installed and can keep its code, else `NUMPY`."""
    try:
        from tactile_depth.chip.poisson import fast
    except (ImportError, RuntimeError):
        return NUMPY
    return NUMPY._replace(**{name: getattr(fast, name) for name in Cores._fields if hasattr(fast, name)})
