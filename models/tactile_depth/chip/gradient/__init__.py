# SPDX-License-Identifier: Apache-2.0
"""Models of the cores from colour to slope."""
