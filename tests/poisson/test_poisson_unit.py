# SPDX-License-Identifier: Apache-2.0
"""poisson_unit: parameters that it refuses. Its testbench is that of the top."""

from tb.structures import Refused

REFUSED = {
    "Tridiagonal=2": "Tridiagonal_and_Neumann_are_0_or_1",
    "Lanes=2": "the_spectral_solver_has_one_lane",
    "Neumann=-1": "Tridiagonal_and_Neumann_are_0_or_1",
    "Rows=64": "the_spectral_solver_takes_square_grids_Rows_must_be_Columns",
    "Columns=12": "the_spectral_solver_takes_square_grids_Rows_must_be_Columns",
    "DataWidth=33": "DataWidth_must_be_2_to_32",
    "GradientWidth=1": "GradientWidth_and_CoeffWidth_must_be_2_to_32",
    "CoeffWidth=1": "GradientWidth_and_CoeffWidth_must_be_2_to_32",
    "StoreStyle=3": "StoreStyle_must_be_0_to_2",
    "DivideShiftWidth=0": "DivideShiftWidth_must_be_1_to_6",
    "DivideDrop=100": "Drop_must_leave_a_bit_of_the_input",
    "RowForwardOut=100": "Drop_must_leave_a_bit_of_the_input",
    "ColumnForwardIn=100": "Drop_must_leave_a_bit_of_the_input",
    "ColumnInverseOut=100": "Drop_must_leave_a_bit_of_the_input",
    "RowInverseIn=100": "Drop_must_leave_a_bit_of_the_input",
    "RowInverseOut=100": "Drop_must_leave_a_bit_of_the_input",
    "Tridiagonal=1 WordsPerRow=0": Refused("WordsPerRow_must_be_at_least_1", {"verilator": "depth_must_be_at_least_2"}),
    "Tridiagonal=1 TableWords=1": "Depth_must_be_at_least_2",
    "Tridiagonal=1 SettledWidth=0": "SettledWidth_must_be_1_to_16_and_LastShiftWidth_1_to_6",
    "Tridiagonal=1 LastShiftWidth=0": "SettledWidth_must_be_1_to_16_and_LastShiftWidth_1_to_6",
    "Tridiagonal=1 Lanes=8 DownWords=32": "Words_and_Columns_must_be_powers_of_two_with_at_least_8_clocks_in_a_burst",
    "Tridiagonal=1 Lanes=8 DownTableWords=1": "Depth_must_be_at_least_2",
    "Tridiagonal=1 Lanes=8 DownSettledWidth=0": "DownSettledWidth_and_UpSettledWidth_must_be_1_to_16",
    "Tridiagonal=1 Lanes=8 UpTableWords=1": "Depth_must_be_at_least_2",
    "Tridiagonal=1 Lanes=8 UpSettledWidth=0": "DownSettledWidth_and_UpSettledWidth_must_be_1_to_16",
    "Tridiagonal=1 Lanes=8 LastShiftWidth=0": "LastShiftWidth_must_be_1_to_6",
    "Tridiagonal=1 Neumann=1 MeanReciprocal=0": "MeanReciprocal_must_fit_CoeffWidth",
    "Tridiagonal=1 Neumann=1 MomentDrop=100": "Drop_must_leave_a_bit_of_the_input",
    "Tridiagonal=1 Neumann=1 MeanDrop=100": "Drop_must_leave_a_bit_of_the_input",
}
