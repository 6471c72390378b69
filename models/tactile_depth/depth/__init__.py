# SPDX-License-Identifier: Apache-2.0
"""Depth in millimetres and contacts, from pictures."""
