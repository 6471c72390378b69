# SPDX-License-Identifier: Apache-2.0
"""A filter that the suite gives a testbench must match a test."""

from commands.common import simulator as simulation

NAMES = ["tb_x.one_frame", "tb_x.stalls/offers=none/accepts=random"]


def test_a_filter_names_its_alternatives_that_match_no_test() -> None:
    assert simulation.unmatched("one_frame|stalls/(offers=none|x)/accepts=random$", NAMES) == []
    assert simulation.unmatched("one_frame|stalls/offers=random|^(?!.*(one|stalls))", NAMES) == [
        "stalls/offers=random",
        "^(?!.*(one|stalls))",
    ]
