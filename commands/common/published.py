# SPDX-License-Identifier: Apache-2.0
"""Figures of the published pipeline, with which results are compared.

Source: Z. Zhu, R. Zhang, R. Hu, C. Xiao, "Near-sensor Computing for Rapid Visuotactile Perception", ShanghaiTech
University. The pipeline runs on an XCZU7EV at 166 MHz with 24-bit words. Keys of grids are N of N x N pixels.
"""

from typing import Any

CLOCK_MHZ = 166.0
FIRST_DEPTH_CYCLES = {64: 9421, 128: 35107, 256: 135448}  # after the first pixel
FRAMES_PER_SECOND = {128: 10_106}  # measured

# Resources of the XCZU7EV, as far as they are published for each grid.
RESOURCES: dict[int, dict[str, int]] = {
    64: {"DSP48E2": 82, "LUT": 12_280, "UltraRAM": 8},
    128: {"UltraRAM": 32},
    256: {"DSP48E2": 108, "LUT": 21_413, "UltraRAM": 64, "BRAM36": 176},
}

# RMS difference from double precision in % of the peak depth, over 15 contacts after a fitted scale and offset.
RMS_PERCENT, WORST_RMS_PERCENT = 0.17, 0.26

# Contact to command and contact to motion in ms, mean and standard deviation; range of contact to motion.
REFLEX: dict[str, dict[str, Any]] = {
    "near": {"trials": 50, "command": (10.2, 3.2), "motion": (28.3, 4.9), "range": (16.7, 37.5)},
    "host": {"trials": 81, "command": (148.6, 28.3), "motion": (169.9, 27.8), "range": (108.3, 260.4)},
}

# NanGate FreePDK45, typical corner, memories as single-port SRAM by CACTI and bsg_fakeram.
ASIC_AREA_MM2, ASIC_POWER_MW = 5.10, 324.0
