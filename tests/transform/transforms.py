# SPDX-License-Identifier: Apache-2.0
"""Sources, parameters and error bounds that the tests of the FFT and of both sine transforms share."""

from typing import Any

import numpy as np

FFT_SOURCES = [
    "burst_counter.sv",
    "delay_line.sv",
    "dot_product.sv",
    "multiply.sv",
    "ram.sv",
    "rom.sv",
    "round_saturate.sv",
    "sdf_butterfly.sv",
    "sdf_fft.sv",
    "twiddle_multiply.sv",
]

# Parameters of dst_forward and dst_inverse, in the order of their structures.
TRANSFORM_PARAMETERS = (
    "Size",
    "InWidth",
    "InputDrop",
    "Width",
    "CoeffWidth",
    "OutputDrop",
    "OutWidth",
    "Alternate",
)


def transform_parameters(*values: Any) -> dict[Any, Any]:
    """Return the parameters of a sine transform by name."""
    return dict(zip(TRANSFORM_PARAMETERS, values, strict=True))


def coefficient_noise(stages: Any, coeff: int) -> Any:
    """RMS error, relative to the RMS of the result, of a chain of multiplications by rounded factors.

    Both parts of a factor err by up to half a step of 2**(1 - coeff), evenly: sqrt(2 / 12) of it together,
    and stages add in squares. Measured: 0.3 to 0.8 of that, since some factors are exact.
    """
    return np.sqrt(stages / 6) * 2.0 ** (1 - coeff)
