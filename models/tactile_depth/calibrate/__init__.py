# SPDX-License-Identifier: Apache-2.0
"""Calibrations from presses of balls."""
