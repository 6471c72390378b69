# SPDX-License-Identifier: Apache-2.0
"""gradient_unit: parameters that it refuses. Its testbench is that of the top."""

REFUSED = {
    "Polynomial=1": "Polynomial_needs_FlatField",
    "FlatField=2": "FlatField_Polynomial_Corrections_and_LightGains_are_0_or_1",
    "LightGains=1": "LightGains_need_Polynomial",
    "Corrections=1": "Corrections_need_Polynomial",
    "BitsPerChannel=0": "BitsPerChannel_must_be_1_to_8",
    "FlatField=1 GainWidth=33": "GainWidth_must_be_2_to_32",
    "FlatField=1 ColourDrop=100": "Drop_must_leave_a_bit_of_the_input",
    "FlatField=1 CaptureLog2=20": "a_sum_over_2_to_the_MaxLog2_frames_must_fit_Width_bits",
    "FlatField=1 BlockLog2=0": "BlockLog2_must_be_at_least_1",
    "FlatField=1 Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
    "FlatField=1 Polynomial=1 SlopeDrop=100": "Drop_must_leave_a_bit_of_the_input",
    "FlatField=1 Polynomial=1 FineBits=-15": "CoeffWidth_must_be_at_most_WordWidth_and_FineBits",
    "FlatField=1 Polynomial=1 CorrectionUnit=-1": "a_correction_must_fit_the_sum",
}
