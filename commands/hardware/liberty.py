# SPDX-License-Identifier: Apache-2.0
"""Reads what the ASIC flow needs of a Liberty file: cells, functions, areas, capacitances, tables of energy and slew.

Syntax: Liberty User Guide (Synopsys, open source since 2000). Of what it allows, this takes table look-up models:
scalars, tables over one axis and two. Delays are OpenSTA's business and are not read.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from tactile_depth.errors import InputError

LARGEST = 400_000_000  # characters
TOKEN = re.compile(r'"[^"]*"|[{}();:,]|[^\s{}();:,"]+')
NOISE = re.compile(r"/\*.*?\*/|//[^\n]*|\\\s*\n", re.DOTALL)
UNIT = re.compile(r"([\d.eE+-]*?)\s*([munpfk]?)([A-Za-z]+)$")
PREFIX = {"": 1.0, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15}


@dataclass
class Group:
    """A group of a Liberty file: `kind (names) { attributes, groups }`."""

    kind: str
    names: list[str]
    attributes: dict[str, str] = field(default_factory=dict)
    lists: dict[str, list[str]] = field(default_factory=dict)  # attributes in brackets
    groups: list[Group] = field(default_factory=list)

    def all(self, kind: str) -> Iterator[Group]:
        return (group for group in self.groups if group.kind == kind)

    def number(self, name: str, default: float = 0.0) -> float:
        return float(self.attributes.get(name, default))


def groups_of(text: str) -> Group:
    """The library group of a Liberty text.

    Raises
    ------
    ValueError
    """
    tokens = TOKEN.findall(NOISE.sub(" ", text))
    root = Group("", [])
    open_groups = [root]
    at, end = 0, len(tokens)
    while at < end:
        word = tokens[at]
        following = tokens[at + 1] if at + 1 < end else ""
        if word == "}":
            if len(open_groups) == 1:
                raise ValueError("a } too many")
            open_groups.pop()
            at += 1
        elif following == ":":
            stop = at + 2
            while stop < end and tokens[stop] not in (";", "}"):
                stop += 1
            open_groups[-1].attributes[word] = " ".join(token.strip('"') for token in tokens[at + 2 : stop])
            at = stop
        elif following == "(":
            stop = tokens.index(")", at)
            values = [token.strip('"') for token in tokens[at + 2 : stop] if token != ","]
            at = stop + 1
            if at < end and tokens[at] == "{":
                group = Group(word, values)
                open_groups[-1].groups.append(group)
                open_groups.append(group)
                at += 1
            else:
                open_groups[-1].lists[word] = values
        elif word == ";":
            at += 1
        else:
            raise ValueError(f"{word[:40]} stands where an attribute or a group must")
    if len(open_groups) > 1:
        raise ValueError(f"the group {open_groups[-1].kind} is not closed")
    libraries = list(root.all("library"))
    if len(libraries) != 1:
        raise ValueError("it holds no library group")
    return libraries[0]


def numbers(values: list[str]) -> list[float]:
    return [float(number) for number in " ".join(values).replace(",", " ").split()]


@dataclass(frozen=True)
class Table:
    """Values over none, one or two axes; between them it is linear, beyond them it goes on so."""

    axes: tuple[str, ...]  # "load" or "slew", first the axis of rows
    points: tuple[tuple[float, ...], ...]
    values: tuple[float, ...]

    def at(self, *, load: float, slew: float) -> float:
        values = list(self.values)
        for axis, points in reversed(list(zip(self.axes, self.points, strict=True))):  # the last axis runs fastest
            value = load if axis == "load" else slew
            count = len(points)
            if count == 1:
                continue
            i = min(max(bisect_right(points, value) - 1, 0), count - 2)
            share = (value - points[i]) / (points[i + 1] - points[i])
            values = [a + share * (b - a) for a, b in zip(values[i::count], values[i + 1 :: count], strict=True)]
        return values[0]


def table_of(group: Group, templates: dict[str, Group]) -> Table:
    template = templates.get(group.names[0]) if group.names else None
    axes, points = [], []
    for index in ("1", "2", "3"):
        variable = template.attributes.get(f"variable_{index}") if template else None
        given = group.lists.get(f"index_{index}") or (template.lists.get(f"index_{index}") if template else None)
        if variable and given:
            axes.append("slew" if "transition" in variable else "load")
            points.append(tuple(numbers(given)))
    values = tuple(numbers(group.lists["values"]))
    size = 1
    for axis in points:
        size *= len(axis)
    if size != len(values) or len(axes) > 2:
        raise ValueError(f"a table {group.kind} holds {len(values)} values for {size} points")
    return Table(tuple(axes), tuple(points), values)


@dataclass(frozen=True)
class Arc:
    """Energy of a transition, by cause.

    Attributes
    ----------
    related : str
        The pin that causes it; "" for what an input pin itself takes.
    when : str
        Condition, a Boolean expression of pins; "" for always.
    rise, fall : Table or None
    """

    related: str
    when: str
    rise: Table | None
    fall: Table | None

    def energy(self, *, load: float, slew: float) -> float:
        """Mean of a rise and a fall, in units of the library."""
        tables = [table for table in (self.rise, self.fall) if table]
        return sum(table.at(load=load, slew=slew) for table in tables) / len(tables)


@dataclass
class Pin:
    direction: str
    capacitance: float
    function: str
    clock: bool
    energy: list[Arc]
    slews: list[Table]  # of its transitions
    related: list[str]  # pins from which a delay leads to it


@dataclass
class Cell:
    name: str
    area: float
    leakage: float  # in units of the library
    pins: dict[str, Pin]
    flip_flop: Group | None
    taken: bool  # whether a netlist of this flow may use it

    @property
    def inputs(self) -> list[str]:
        return [name for name, pin in self.pins.items() if pin.direction == "input"]

    @property
    def outputs(self) -> list[str]:
        return [name for name, pin in self.pins.items() if pin.direction == "output"]


@dataclass
class Library:
    """Cells with units: capacitances in `farad`, energies in `joule`, leakage in `watt`, slews in `second`.

    An energy in Liberty has the unit of the load capacitance times V squared.
    """

    name: str
    voltage: float
    temperature: float
    cells: dict[str, Cell]
    farad: float
    joule: float
    watt: float
    second: float

    def inverter(self) -> Cell:
        """The smallest inverter: the gate that load and slew are measured by.

        Raises
        ------
        InputError
        """
        found = [
            cell
            for cell in self.cells.values()
            if len(cell.inputs) == len(cell.outputs) == 1
            and re.sub(r"[\s()]", "", cell.pins[cell.outputs[0]].function)
            in (f"!{cell.inputs[0]}", f"{cell.inputs[0]}'")
        ]
        if not found:
            raise InputError(f"LIB: the library {self.name} holds no inverter")
        return min(found, key=lambda cell: (cell.area, cell.name))


def _cell(group: Group, templates: dict[str, Group]) -> Cell:
    pins = {}
    for pin in group.all("pin"):
        energy, slews, related = [], [], []
        for power in pin.all("internal_power"):
            tables = {table.kind: table_of(table, templates) for table in power.groups}
            both = tables.get("power")
            arc = Arc(
                power.attributes.get("related_pin", ""),
                power.attributes.get("when", ""),
                tables.get("rise_power", both),
                tables.get("fall_power", both),
            )
            if arc.rise or arc.fall:
                energy.append(arc)
        for timing in pin.all("timing"):
            found = [table for table in timing.groups if table.kind in ("rise_transition", "fall_transition")]
            if found:
                slews += [table_of(table, templates) for table in found]
                related += timing.attributes.get("related_pin", "").split()
        for name in pin.names:
            pins[name] = Pin(
                pin.attributes.get("direction", ""),
                pin.number("capacitance"),
                pin.attributes.get("function", ""),
                pin.attributes.get("clock", "") == "true",
                energy,
                slews,
                sorted(set(related)),
            )
    taken = group.attributes.get("dont_use", "").lower() != "true" and not any(
        pin.attributes.get("three_state") for pin in group.all("pin")
    )
    flip_flop = next(group.all("ff"), None)
    return Cell(
        group.names[0], group.number("area"), group.number("cell_leakage_power"), pins, flip_flop, taken
    )  # fmt: skip


def unit_of(text: str) -> float:
    """1pF to 1e-12."""
    match = UNIT.match(text.strip())
    if match is None:
        raise ValueError(f"{text} is no unit")
    return float(match[1] or 1) * PREFIX[match[2]]


def read(path: Path) -> Library:
    """A library from its file.

    Raises
    ------
    InputError
        It cannot be read, is no Liberty, or holds no flip-flop with one clock.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise ValueError("it is too large")
        library = groups_of(path.read_text(encoding="latin-1"))
        templates = {
            group.names[0]: group
            for group in library.groups
            if group.kind in ("lu_table_template", "power_lut_template")
        }
        amount, unit = library.lists.get("capacitive_load_unit", ["1", "pf"])
        farad = float(amount) * PREFIX[unit.lower()[0]]
        voltage = library.number("nom_voltage")
        read_cells = {group.names[0]: _cell(group, templates) for group in library.all("cell")}
        result = Library(
            library.names[0],
            voltage,
            library.number("nom_temperature"),
            read_cells,
            farad,
            farad * unit_of(library.attributes.get("voltage_unit", "1V")) ** 2,
            unit_of(library.attributes.get("leakage_power_unit", "1nW")),
            unit_of(library.attributes.get("time_unit", "1ns")),
        )
    except OSError as error:
        raise InputError(f"LIB={path}: cannot be read ({error.strerror}): give a Liberty file (.lib)") from error
    except (ValueError, KeyError, IndexError) as error:
        raise InputError(
            f"LIB={path}: no Liberty file that can be read ({error}): give a .lib of typical tables"
        ) from error
    if voltage <= 0:
        raise InputError(f"LIB={path}: nom_voltage is missing: power cannot be computed without it")
    if not any(cell.flip_flop and cell.taken for cell in read_cells.values()):
        raise InputError(f"LIB={path}: no flip-flop among its {len(read_cells)} cells: the design has thousands")
    return result


# Boolean expressions.


def boolean(text: str) -> str:
    """A Liberty expression as one of Verilog.

    Liberty: ! before or ' after is not, & or * or a space is and, + or | is or, ^ is exclusive or.

    Raises
    ------
    ValueError
    """
    tokens = re.findall(r"[A-Za-z_][\w\[\]]*|[01]|[!'()&*+|^]", text)
    at = 0

    def peek() -> str:
        return tokens[at] if at < len(tokens) else ""

    def primary() -> str:
        nonlocal at
        token = peek()
        at += 1
        if token == "!":
            value = f"~{primary()}"
        elif token == "(":
            value = f"({either()})"
            if peek() != ")":
                raise ValueError(f"{text}: a ) is missing")
            at += 1
        elif re.match(r"[A-Za-z_01]", token):
            value = f"1'b{token}" if token in "01" else token
        else:
            raise ValueError(f"{text}: no Boolean expression")
        while peek() == "'":
            value = f"~{value}"
            at += 1
        return value

    def exclusive() -> str:  # binds tighter than and in Liberty
        nonlocal at
        value = primary()
        while peek() == "^":
            at += 1
            value = f"({value} ^ {primary()})"
        return value

    def both() -> str:
        nonlocal at
        value = exclusive()
        while peek() and peek() not in "+|)":
            if peek() in "&*":
                at += 1
            value = f"({value} & {exclusive()})"
        return value

    def either() -> str:
        nonlocal at
        value = both()
        while peek() and peek() in "+|":
            at += 1
            value = f"({value} | {both()})"
        return value

    result = either()
    if at != len(tokens):
        raise ValueError(f"{text}: no Boolean expression")
    return result
