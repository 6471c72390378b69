# SPDX-License-Identifier: Apache-2.0
"""Models of the divergence and of the two solvers."""
