# SPDX-License-Identifier: Apache-2.0
"""Sensors: their calibrations, and drawn scenes."""
