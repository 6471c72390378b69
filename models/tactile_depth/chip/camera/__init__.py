# SPDX-License-Identifier: Apache-2.0
"""Models of the cores between a camera's wire and `s_axis`."""
