# SPDX-License-Identifier: Apache-2.0
"""sdf_fft: RTL against the model, the model against numpy."""

import numpy as np
import pytest

from models.orders import bit_reversed
from models.rom_files import write_transform
from models.sdf_fft import halvings, sdf_fft, twiddle_stages
from models.twiddle_multiply import coefficient_gain

FFT_SOURCES = [
    "burst_counter.sv",
    "delay_line.sv",
    "dot_product.sv",
    "ram.sv",
    "rom.sv",
    "round_saturate.sv",
    "sdf_butterfly.sv",
    "sdf_fft.sv",
    "twiddle_multiply.sv",
]


@pytest.mark.parametrize("inverse", [0, 1])
@pytest.mark.parametrize(
    ("size", "width", "coeff"), [(16, 27, 18), (32, 15, 10), (64, 27, 18), (128, 35, 24)]
)
def test_rtl(run_tb, size, width, coeff, inverse):
    run_tb(
        "sdf_fft",
        FFT_SOURCES,
        {"Size": size, "Width": width, "CoeffWidth": coeff, "Inverse": inverse},
        roms=lambda folder: write_transform(folder, size, coeff),
    )


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("size", [8, 16, 32, 64, 128, 256, 512, 1024])
def test_model_is_an_fft(size, inverse):
    coeff, width = 24, 40
    rng = np.random.default_rng(size)
    x = rng.integers(-(2**30), 2**30, (3, size, 2))
    order = bit_reversed(size)
    x_in = x[:, order] if inverse else x
    re, im = sdf_fft(x_in[..., 0], x_in[..., 1], inverse, width, coeff)
    z = x[..., 0] + 1j * x[..., 1]
    want = size * np.fft.ifft(z) if inverse else np.fft.fft(z)[:, order]
    want *= 2.0 ** -halvings(size, inverse) * coefficient_gain(coeff) ** twiddle_stages(size)
    # Coefficients of 24 bits err by 2^-24 at most, over at most four stages.
    assert np.abs(re + 1j * im - want).max() < 4 * 2.0**-23 * np.abs(want).max()
