# SPDX-License-Identifier: Apache-2.0
"""camera_unit: parameters that it refuses. Its testbench is that of tactile_sensor."""

from tb.structures import Refused

SIZES = "pictures_and_windows_have_up_to_8191_rows_and_columns"
LEVELS = "BlackLevel_must_fit_12_bits_and_gains_16"
RATIO = "Numerator_must_be_at_least_Denominator_and_Denominator_at_least_1"
REFUSED = {
    "CameraFormat=10": "Format_is_a_number_of_camera_format_e",
    "CameraPhase=4": "Phase_is_0_to_3",
    "CameraNumerator=3": RATIO,
    "CameraDenominator=0": Refused(RATIO, {}),
    "CameraPictureColumns=8192": SIZES,
    "CameraPictureRows=-1": SIZES,
    "CameraWindowX=8192": SIZES,
    "CameraWindowY=-1": SIZES,
    "CameraBlackLevel=4096": LEVELS,
    "CameraRedGain=65536": LEVELS,
    "CameraGreenGain=-1": LEVELS,
    "CameraBlueGain=65536": LEVELS,
}
