# SPDX-License-Identifier: Apache-2.0
"""td_node_map: RTL against the model; nodes side by side, latency and entries."""

import numpy as np
import pytest

from tactile_depth.chip.common.td_node_map import entries_per_node, latency, side, table_entries


@pytest.mark.parametrize(
    ("lanes", "block_log2", "nodes", "cycles"),
    [
        *((1, 1, 1, 10), (1, 3, 1, 10), (2, 3, 1, 11), (4, 3, 1, 12), (8, 3, 1, 12), (16, 3, 2, 12), (2, 1, 1, 10)),
        (32, 5, 1, 14),
    ],
)
def test_nodes_and_latency(lanes: int, block_log2: int, nodes: int, cycles: int) -> None:
    assert (side(lanes, block_log2), latency(lanes, block_log2)) == (nodes, cycles)


def test_entries_are_the_channels_of_each_node() -> None:
    nodes = np.array([[[10, 11, 12], [20, 21, 22]]])
    assert table_entries(nodes) == {0: 10, 1: 11, 2: 12, 4: 20, 5: 21, 6: 22}
    assert table_entries(nodes[..., :1]) == {0: 10, 1: 20}
    assert [entries_per_node(channels) for channels in (1, 2, 3)] == [1, 2, 4]
