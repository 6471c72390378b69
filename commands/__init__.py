# SPDX-License-Identifier: Apache-2.0
"""Commands behind the make targets."""
