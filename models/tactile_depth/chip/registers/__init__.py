# SPDX-License-Identifier: Apache-2.0
"""Model of the AXI4-Lite registers, and their map."""
