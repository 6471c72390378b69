# SPDX-License-Identifier: Apache-2.0
"""Header of a SystemVerilog module: its imports, parameters and ports, each of which has a direction of its own."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from commands.common.repository import code


@dataclass(frozen=True)
class Port:
    side: str  # input or output
    type: str  # such as logic signed [Width-1:0]
    name: str


@dataclass(frozen=True)
class Header:
    """Header of a module.

    `text` is as in the file; `imports` are the packages; `parameters` are name to declaration, such as parameter int
    Width = 8, local ones too.
    """

    text: str
    imports: tuple[str, ...]
    parameters: dict[str, str]
    ports: tuple[Port, ...]

    def of(self, side: str) -> list[Port]:
        """Return the ports of a direction."""
        return [port for port in self.ports if port.side == side]


def matched(pattern: str, text: str) -> re.Match[str]:
    """Return the first match of a pattern. Raises ValueError: there is none."""
    if found := re.search(pattern, text, re.S | re.M):
        return found
    raise ValueError(f"no {pattern} in {text}")


def entries(text: str) -> list[str]:
    """Return what stands between the commas of a list; those inside brackets separate nothing."""
    depth, parts = 0, [""]
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def sentence(file: Path) -> str:
    """Return the first sentence of the comment at the top of a file, behind the name of its module."""
    return re.sub(r"\n// ?", " ", matched(rf"^// {file.stem}: (.*?)\.\s", file.read_text())[1])


def port(text: str) -> Port:
    """Return the port that a declaration such as `output logic [3:0] data = 4'd1` makes."""
    side, words, name = matched(r"^(input|output) (?:wire )?(.*?) ?(\w+)(?: =.*)?$", text).groups()
    return Port(side, f"logic {words}".rstrip() if re.match(r"\[|signed|$", words) else words, name)


@cache
def read(file: Path) -> Header:
    """Return the header of the module that has the name of its file."""
    text = matched(rf"^module {file.stem}\b.*?^\);\n", file.read_text())[0]
    imports, parameters, ports = matched(r"^module \w+ (.*?)(?:#\((.*)\) )?\((.*)\);$", code(text)).groups()
    return Header(
        text,
        tuple(re.findall(r"(\w+)::", imports)),
        {matched(r"(\w+) =", each)[1]: each for each in entries(parameters or "")},
        tuple(port(each) for each in entries(ports)),
    )
