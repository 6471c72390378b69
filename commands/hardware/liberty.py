# SPDX-License-Identifier: Apache-2.0
"""Reads from a Liberty file: cells with their functions, areas, capacitances, energies and slews.

Syntax: Liberty User Guide (Synopsys, open source since 2000), with table look-up models: scalars and tables over one or
two axes. OpenSTA reads the delays. `truth` evaluates Boolean functions; no text of the file is executed.
"""

from __future__ import annotations

import ast
import operator
import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import prod
from pathlib import Path

from tactile_depth.base.errors import InputError

LARGEST_GATE = 6  # inputs
NOISE = re.compile(r"/\*.*?\*/|//[^\n]*|\\\s*\n", re.DOTALL)
LIST_ITEM = re.compile(r'"[^"]*"|[^\s,"]+')
STATEMENT = re.compile(
    r"""(?P<name>[^\s{}();:,"]+)\s*(?:\((?P<list>(?:"[^"]*"|[^)"])*)\)\s*(?P<brace>\{)?|:\s*(?P<value>"[^"]*"|[^;}]*))"""
    r"[\s;]*|\}[\s;]*"
)
UNIT = re.compile(r"([\d.eE+-]*?)\s*([munpfk]?)([A-Za-z]+)$")
PREFIX = {"": 1.0, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15}
PIN = r"[A-Za-z_][\w\[\]]*"
# Liberty's operators as those of Python; exclusive or binds tighter than and.
SPELLED = {"+": "|", "|": "|", "*": "&", "&": "&", "^": "+", "!": "~", "'": ".inverse", "(": "(", ")": ")"}
OPERATORS = {ast.BitOr: operator.or_, ast.BitAnd: operator.and_, ast.Add: operator.xor}


def pins_of(function: str) -> list[str]:
    """Return the names in a Boolean function, sorted."""
    return sorted(set(re.findall(PIN, function)))


def truth(function: str, inputs: Sequence[str]) -> int:
    """Return the truth table of a Liberty function: bit i is its value when the inputs, first lowest, spell i.

    ! before an operand or ' after it is not; a space is and. The function becomes an expression of Python, which has
    operators that bind in the same order, and is evaluated from its syntax tree.
    Raises InputError: the text is no Boolean function of `inputs`, or they are too many.
    """
    wrong = InputError(f"LIB: {function} is no Boolean function of up to {LARGEST_GATE} pins: {', '.join(inputs)}")
    rows = 1 << len(inputs)
    ones = (1 << rows) - 1
    tokens = re.findall(rf"{PIN}|\S", function)
    if len(inputs) > LARGEST_GATE or not {*pins_of(function)} <= {*inputs}:
        raise wrong
    tables = [sum(1 << i for i in range(rows) if i >> k & 1) for k in range(len(inputs))]
    names = {name: f"v{k}" for k, name in enumerate((*inputs, "0", "1"))}
    values = dict(zip(names.values(), (*tables, 0, ones), strict=True))
    spelled = " ".join(names.get(token) or SPELLED.get(token, "?") for token in tokens)
    spelled = re.sub(r"(?<=[\w)]) (?=[v(~])", " & ", spelled)

    def value(node: ast.AST) -> int:
        match node:
            case ast.Name(id=name):
                return values[name]
            case ast.Attribute(value=inner) | ast.UnaryOp(operand=inner):
                return value(inner) ^ ones
            case ast.BinOp(left=left, op=sign, right=right):
                return OPERATORS[type(sign)](value(left), value(right))
        raise wrong

    try:
        return value(ast.parse(spelled, mode="eval").body)
    except (SyntaxError, KeyError):
        raise wrong from None


@dataclass
class Group:
    """A group of a Liberty file: `kind (names) { attributes, groups }`."""

    kind: str
    names: list[str]
    attributes: dict[str, str] = field(default_factory=dict)
    lists: dict[str, list[str]] = field(default_factory=dict)  # attributes with brackets
    groups: list[Group] = field(default_factory=list)

    def all(self, kind: str) -> Iterator[Group]:
        """Return the groups of a kind directly inside this one."""
        return (group for group in self.groups if group.kind == kind)

    def number(self, name: str) -> float:
        """Return an attribute as a number; 0 where it is missing."""
        return float(self.attributes.get(name, 0.0))


def groups_of(text: str) -> Group:
    """Return the library group of a Liberty text. Raises ValueError."""
    text = NOISE.sub(" ", text).strip()
    open_groups = [Group("", [])]
    at = 0
    while at < len(text):
        match = STATEMENT.match(text, at)
        if match is None:
            raise ValueError(f"{text[at : at + 40].split()[0]} stands where an attribute or a group must")
        at = match.end()
        name, listed, brace, value = match.group("name", "list", "brace", "value")
        if name is None:
            open_groups.pop()
            if not open_groups:
                raise ValueError("a } too many")
        elif value is not None:
            open_groups[-1].attributes[name] = value.strip().strip('"')
        else:
            values = [item.strip('"') for item in LIST_ITEM.findall(listed)]
            if brace:
                group = Group(name, values)
                open_groups[-1].groups.append(group)
                open_groups.append(group)
            else:
                open_groups[-1].lists[name] = values
    if len(open_groups) > 1:
        raise ValueError(f"the group {open_groups[-1].kind} is not closed")
    libraries = list(open_groups[0].all("library"))
    if len(libraries) != 1:
        raise ValueError("it holds no library group")
    return libraries[0]


@dataclass(frozen=True)
class Table:
    """Values over none, one or two axes: linear between the points, extrapolated beyond them."""

    axes: tuple[tuple[str, tuple[float, ...]], ...]  # "load" or "slew" and its points, first the axis of rows
    values: tuple[float, ...]

    def at(self, *, load: float, slew: float) -> float:
        """Return the value at a load and a slew, in units of the library."""
        values = list(self.values)
        for axis, points in reversed(self.axes):  # the last axis runs fastest
            value = load if axis == "load" else slew
            count = len(points)
            if count == 1:
                continue
            i = min(max(bisect_right(points, value) - 1, 0), count - 2)
            share = (value - points[i]) / (points[i + 1] - points[i])
            values = [a + share * (b - a) for a, b in zip(values[i::count], values[i + 1 :: count], strict=True)]
        return values[0]


def mean(tables: Sequence[Table], *, load: float, slew: float) -> float:
    """Return the mean of tables at a load and a slew; 0 without tables."""
    return sum(table.at(load=load, slew=slew) for table in tables) / len(tables) if tables else 0.0


@dataclass
class Pin:
    """A pin of a cell; `slews` are those of its transitions.

    `energy` holds the tables of a rise and of a fall under every condition, by the pin that causes it; "" for the pin
    itself.
    """

    direction: str
    capacitance: float
    function: str
    energy: dict[str, list[Table]] = field(default_factory=dict)
    slews: list[Table] = field(default_factory=list)


@dataclass
class Cell:
    """A cell; `leakage` is in units of the library, `flip_flop` the group `ff` of a flip-flop."""

    name: str
    area: float
    leakage: float
    pins: dict[str, Pin]
    flip_flop: Group | None

    def __post_init__(self) -> None:
        self.inputs = [name for name, pin in self.pins.items() if pin.direction == "input"]
        self.outputs = [name for name, pin in self.pins.items() if pin.direction == "output"]


def functions(cell: Cell) -> dict[str, tuple[list[str], int]]:
    """Return the inputs and the truth table of each output; of a flip-flop those of its value after the edge."""
    texts = {name: cell.pins[name].function for name in cell.outputs}
    if cell.flip_flop is None:
        return {name: (pins_of(text), truth(text, pins_of(text))) for name, text in texts.items()}
    following = cell.flip_flop.attributes["next_state"]
    inputs = pins_of(following)
    tables = [truth(following, inputs), truth(f"!({following})", inputs)]
    held = cell.flip_flop.names  # the state and its inverse
    inverted = {name: not truth(text, held) >> 0b01 & 1 for name, text in texts.items()}
    return {name: (inputs, tables[inverted[name]]) for name in cell.outputs}


@dataclass
class Library:
    """Cells with units: capacitances in `farad`, energies in `farad` times V squared, leakage in `watt`."""

    name: str
    voltage: float
    cells: dict[str, Cell]
    farad: float
    watt: float

    def inverter(self) -> Cell:
        """Return the smallest inverter: typical load and slew are measured with it."""
        inverters = [
            cell
            for cell in self.cells.values()
            if len(cell.inputs) == len(cell.outputs) == 1
            and cell.pins[cell.outputs[0]].function
            and functions(cell) == {cell.outputs[0]: (cell.inputs, 0b01)}
        ]
        if not inverters:
            raise InputError("it holds no inverter")
        return min(inverters, key=lambda cell: (cell.area, cell.name))


def _table(group: Group, templates: dict[str, Group]) -> Table:
    """Return the table of a group, which may take its axes from a template."""
    template = templates.get(group.names[0] if group.names else "", Group("", []))
    axes = []
    for index in "123":
        variable = template.attributes.get(f"variable_{index}")
        points = group.lists.get(f"index_{index}") or template.lists.get(f"index_{index}")
        if variable and points:
            axes.append(("slew" if "transition" in variable else "load", _numbers(points)))
    values = _numbers(group.lists["values"])
    size = prod(len(points) for _, points in axes)
    if size != len(values) or len(axes) > 2:
        raise ValueError(f"a table {group.kind} holds {len(values)} values for {size} points")
    return Table(tuple(axes), values)


def _numbers(values: list[str]) -> tuple[float, ...]:
    return tuple(float(number) for number in " ".join(values).replace(",", " ").split())


def _cell(group: Group, templates: dict[str, Group]) -> Cell:
    pins: dict[str, Pin] = {}
    for pin in group.all("pin"):
        direction, function = (pin.attributes.get(name, "") for name in ("direction", "function"))
        pins |= dict.fromkeys(pin.names, result := Pin(direction, pin.number("capacitance"), function))
        for power in pin.all("internal_power"):
            tables = [_table(table, templates) for table in power.groups if table.kind.endswith("power")]
            if tables:
                result.energy.setdefault(power.attributes.get("related_pin", ""), []).extend(tables)
        for timing in pin.all("timing"):
            slews = [table for table in timing.groups if table.kind.endswith("_transition")]
            result.slews += [_table(table, templates) for table in slews]
    flip_flop = next(group.all("ff"), None)
    return Cell(group.names[0], group.number("area"), group.number("cell_leakage_power"), pins, flip_flop)


def _unit(text: str) -> float:
    if match := UNIT.match(text.strip()):
        return float(match[1] or 1) * PREFIX[match[2]]
    raise ValueError(f"{text} is no unit")


def read(path: Path) -> Library:
    """Return the library of a file. Raises InputError if it lacks a voltage, a flip-flop or an inverter."""
    try:
        library = groups_of(path.read_text(encoding="latin-1"))
        templates = {group.names[0]: group for group in library.groups if group.kind.endswith("_template")}
        amount, unit = library.lists.get("capacitive_load_unit", ["1", "pf"])
        result = Library(
            library.names[0],
            library.number("nom_voltage"),
            {group.names[0]: _cell(group, templates) for group in library.all("cell")},
            float(amount) * PREFIX[unit.lower()[0]],
            _unit(library.attributes.get("leakage_power_unit", "1nW")),
        )
        if result.voltage <= 0 or library.attributes.get("voltage_unit", "1V") != "1V":
            raise ValueError("nom_voltage is missing or not in V")
        if not any(cell.flip_flop for cell in result.cells.values()):
            raise ValueError(f"no flip-flop among its {len(result.cells)} cells")
        result.inverter()
    except (OSError, ValueError, KeyError, IndexError) as error:
        raise InputError(f"LIB={path}: no Liberty file that can be used ({error}): give another .lib") from error
    return result
