# SPDX-License-Identifier: Apache-2.0
"""The solver bitwuzla as yosys-smtbmc calls it: SMT-LIB on standard input, answers on standard output.

The wheel brings a library and no program. Commands are handed over one by one, as they are complete, because an answer
decides what is asked next.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import TextIO

import bitwuzla


def commands(stream: TextIO) -> Iterator[str]:
    """S-expressions of the top level. Strings and quoted symbols may hold parentheses, comments end with the line."""
    text, depth, quote = "", 0, ""
    for line in stream:
        for place, character in enumerate(line):
            if quote:
                quote = "" if character == quote else quote
            elif character in '"|':
                quote = character
            elif character == ";":
                line = line[:place] + "\n"
                break
            else:
                depth += (character == "(") - (character == ")")
        text += line
        if depth == 0 and not quote and text.strip():
            yield text
            text = ""


def main() -> None:
    options = bitwuzla.Options()
    options.set(bitwuzla.Option.PRODUCE_MODELS, True)
    parser = bitwuzla.Parser(bitwuzla.TermManager(), options)
    for command in commands(sys.stdin):
        if command.strip() == "(exit)":
            break
        parser.parse(command, parse_file=False)
        sys.stdout.flush()


if __name__ == "__main__":
    main()
