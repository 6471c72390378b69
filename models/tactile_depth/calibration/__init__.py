# SPDX-License-Identifier: Apache-2.0
"""Models of the flat field, the zero offset and their captures."""
