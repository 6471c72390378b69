# SPDX-License-Identifier: Apache-2.0
"""Models of the cores from the depth of the solver to whole frames less the zero offset."""
