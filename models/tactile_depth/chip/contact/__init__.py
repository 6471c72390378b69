# SPDX-License-Identifier: Apache-2.0
"""Models of the threshold comparator and of the contact records."""
