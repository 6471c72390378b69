# SPDX-License-Identifier: Apache-2.0
"""The form of all SystemVerilog: licence, length, no net without a declaration, one module in a file of its name."""

import re

from commands.common import repository
from commands.verify.protocol import BODY

FOLDERS = ("hdl", "formal", "tb", "boards", "examples")
FILES = sorted(path for folder in FOLDERS for path in (repository.ROOT / folder).rglob("*.sv"))
# Without header (commands/verify/proof_module.py, protocol.py).
PROOFS = [path for path in FILES if path.name.startswith("fv_")]
BODIES = [*PROOFS, *(path for path in FILES if path.name.startswith("protocol_") and path.parent.name != "protocols")]
LONGEST_CORE, LONGEST_TOP = 250, 150  # lines, without those that refuse parameters


def begins_and_ends(text: str) -> bool:
    """Return True if the directive holds from the header on to the last line, which leaves files behind it alone."""
    begins = re.match(
        r"// SPDX-License-Identifier: Apache-2.0\n(//.*\n)*\n(`timescale .*\n\n)?`default_nettype none\n", text
    )
    return begins is not None and text.endswith("\n`default_nettype wire\n")


def test_a_net_needs_a_declaration_in_every_file() -> None:
    assert [path.name for path in FILES if path not in BODIES and not begins_and_ends(path.read_text())] == []


def test_a_proof_repeats_no_header() -> None:
    for path in BODIES:
        text = BODY.sub("", path.read_text())
        assert re.match(r"// SPDX-License-Identifier: Apache-2.0\n(//.*\n)+\n", text), path.name
        assert not re.search(r"^\s*(`default_nettype|module|endmodule|output)\b", text, re.MULTILINE), path.name


def test_a_file_is_one_module_of_at_most_so_many_lines() -> None:
    for path in repository.sources():
        text = path.read_text()
        assert re.findall(r"^(?:module|package) (\w+)", text, re.MULTILINE) == [path.stem]
        lines = text.partition("  // Refused.\n")[0].splitlines()
        assert len(lines) <= (LONGEST_TOP if path.stem == "tactile_depth" else LONGEST_CORE), path.name


def test_the_top_has_one_clock() -> None:
    """Look at the edges in all sources below the top."""
    text = " ".join(repository.code(path.read_text()) for path in repository.sources("tactile_depth"))
    assert {*re.findall(r"(?:posedge|negedge) (\w+)", text)} == {"clk"}


def test_the_link_holds_no_depth_back() -> None:
    """Find no ready of the depth and of the records that the pipeline sends to the link."""
    ports = repository.code((repository.HDL / "link" / "link_unit.sv").read_text())
    assert "s_axis_tvalid" in ports and "s_event_tvalid" in ports  # noqa: PT018
    assert not re.search(r"\bs_(?:axis|event)_tready\b", ports)
