# SPDX-License-Identifier: Apache-2.0
"""Base of every room: errors, files, interruption, comparison by value."""
