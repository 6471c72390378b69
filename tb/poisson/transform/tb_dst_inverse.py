# SPDX-License-Identifier: Apache-2.0
"""dst_inverse against its model: the tests that both sine transforms share."""

from tb.poisson.transform.dst_bench import bursts, limits, many_bursts, reset_in_mid_burst

__all__ = ["bursts", "limits", "many_bursts", "reset_in_mid_burst"]
