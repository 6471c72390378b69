# SPDX-License-Identifier: Apache-2.0
"""Models of the cores that every unit uses."""
