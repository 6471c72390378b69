# SPDX-License-Identifier: Apache-2.0
"""The packet protocol between device and host: docs/link.md."""
