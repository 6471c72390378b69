# SPDX-License-Identifier: Apache-2.0
"""Proofs of all cores, an item for each proof and mode: `make formal` runs them, and no other run collects them."""

from collections.abc import Callable

import pytest

from commands.verify import formal
from formal.entries import Cone, Proof
from tb.settings import RUN

RUNS = [
    pytest.param(proof, mode, id=formal.item(proof, mode))
    for proof in formal.selected(",".join(RUN.cores))
    for mode in formal.modes(proof)
]


@pytest.mark.formal
@pytest.mark.timeout(2 * formal.TIMEOUT)
@pytest.mark.parametrize(("proof", "mode"), RUNS)
def test_proof(proof: Proof | Cone, mode: str, record_property: Callable[[str, object], None]) -> None:
    outcome = formal.run(proof, mode)
    record_property("status", outcome.status)
    record_property("cpu_seconds", outcome.seconds)
    assert outcome.status == "PASS", f"see {formal.BUILD.relative_to(formal.ROOT) / proof.name}"
