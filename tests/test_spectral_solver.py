# SPDX-License-Identifier: Apache-2.0
"""spectral_solver: RTL against the model, the model against scipy."""

import pytest

from models.configuration import Configuration
from models.rom_files import write_solver
from models.spectral_solver import solver_parameters

from test_sdf_fft import FFT_SOURCES

SOLVER_SOURCES = [
    *FFT_SOURCES,
    "dst_forward.sv",
    "dst_inverse.sv",
    "mode_pairs.sv",
    "row_reorder.sv",
    "spectral_divide.sv",
    "spectral_solver.sv",
    "transpose.sv",
]


@pytest.mark.parametrize(("size", "data_width", "coeff"), [(16, 24, 18), (32, 12, 10), (16, 32, 24)])
def test_rtl(run_tb, size, data_width, coeff):
    config = Configuration(columns=size, data_width=data_width, coefficient_width=coeff)
    run_tb(
        "spectral_solver",
        SOLVER_SOURCES,
        solver_parameters(config),
        roms=lambda folder: write_solver(folder, config),
    )
