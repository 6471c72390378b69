# SPDX-License-Identifier: Apache-2.0
"""The models that take the most time, in numpy or compiled."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from tactile_depth.gradient.light_gains import settled
from tactile_depth.poisson.back_substitution import back_substitution
from tactile_depth.poisson.forward_elimination import forward_elimination
from tactile_depth.poisson.transform.dst_forward import dst_forward
from tactile_depth.poisson.transform.dst_inverse import dst_inverse

Model = Callable[..., np.ndarray]


class Cores(NamedTuple):
    """Models with the arguments and the results of those in numpy."""

    dst_forward: Model
    dst_inverse: Model
    forward_elimination: Model
    back_substitution: Model
    settled: Model


NUMPY = Cores(dst_forward, dst_inverse, forward_elimination, back_substitution, settled)
"""The reference, with which RTL is compared."""


@cache
def fastest() -> Cores:
    """Return the compiled models if numba (extra `fast`) is installed and can keep its code, else `NUMPY`."""
    try:
        from tactile_depth import fast
    except (ImportError, RuntimeError):
        return NUMPY
    return Cores(*(getattr(fast, name) for name in Cores._fields))
