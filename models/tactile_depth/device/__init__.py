# SPDX-License-Identifier: Apache-2.0
"""Devices on a host: depth frames in mm, registers and captures over a serial line or from a simulator."""
