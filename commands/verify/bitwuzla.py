# SPDX-License-Identifier: Apache-2.0
"""Program for yosys-smtbmc around the solver bitwuzla: SMT-LIB on standard input, answers on standard output.

The wheel contains a library but no program. Each command goes to the solver as soon as it is complete, because
yosys-smtbmc waits for the answer before it sends more.
"""

import sys
from collections.abc import Iterator
from typing import TextIO

import bitwuzla


def commands(stream: TextIO) -> Iterator[str]:
    """Yield the S-expressions of the top level; strings, quoted symbols and comments may hold parentheses."""
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
