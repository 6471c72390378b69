# SPDX-License-Identifier: Apache-2.0
"""The map of the AXI4-Lite registers: the one place where it is written down.

`python -m models.register_map` writes from it hdl/register_map_pkg.sv, which hdl/axil_registers.sv is
built on, and docs/registers.md. Software and testbenches take offsets and fields from `REGISTERS`; what the
registers do is modelled in models/axil_registers.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

ADDRESS_WIDTH = 7  # bits of a byte address
WORD_BITS = 32
ACCESSES = {
    "ro": "read-only",
    "rw": "read and written",
    "w1c": "read; a written 1 clears the bit, a written 0 leaves it",
    "wo": "written only",
}


@dataclass(frozen=True)
class Field:
    """Bits `high` to `low` of a register; `access` is one of `ACCESSES`."""

    name: str
    low: int
    high: int
    access: str
    description: str

    @property
    def width(self) -> int:
        return self.high - self.low + 1

    @property
    def mask(self) -> int:
        """Ones at the field's bits of the register."""
        return (1 << self.high + 1) - (1 << self.low)

    @property
    def bits(self) -> str:
        return str(self.low) if self.width == 1 else f"{self.high}:{self.low}"


@dataclass(frozen=True)
class Register:
    """One 32-bit register.

    Attributes
    ----------
    name : str
        In capitals.
    offset : int
        Byte offset, a multiple of 4.
    access : str
        One of `ACCESSES`: what the register as a whole takes. Writing a read-only register and reading a
        write-only one are errors on the bus; a field's access only says what its bits do.
    reset : int or None
        Value after reset; None: given by the parameters of the build, or by its inputs.
    description : str
    signed : bool
        The word is a two's-complement number.
    fields : tuple of Field
        Empty where the register is one word.
    """

    name: str
    offset: int
    access: str
    reset: int | None
    description: str
    signed: bool = False
    fields: tuple[Field, ...] = ()

    def field(self, name: str) -> Field:
        """The field of that name; KeyError names those there are."""
        for field in self.fields:
            if field.name == name:
                return field
        raise KeyError(f"{self.name} has no field {name}: it has {', '.join(f.name for f in self.fields)}")

    def unpack(self, word: int) -> dict[str, int]:
        """Field name to value, unsigned, for a word that was read."""
        return {field.name: (word & field.mask) >> field.low for field in self.fields}

    def pack(self, **values: int) -> int:
        """The word with these fields, all others zero.

        Raises
        ------
        ValueError
            A value does not fit its field.
        """
        word = 0
        for name, value in values.items():
            field = self.field(name)
            if not 0 <= value < 1 << field.width:
                raise ValueError(f"{self.name}.{name}={value} does not fit: accepted are 0 to {(1 << field.width) - 1}")
            word |= value << field.low
        return word


def _sticky(name: str, bit: int, description: str) -> Field:
    return Field(name, bit, bit, "w1c", description)


MAP = (
    Register("ID", 0x00, "ro", int.from_bytes(b"TDEP", "big"), "`TDEP` in ASCII, T in the top byte."),
    Register(
        "GRID",
        0x04,
        "ro",
        None,
        "The grid of the build.",
        fields=(
            Field("rows", 0, 15, "ro", "Rows of a frame."),
            Field("columns", 16, 31, "ro", "Pixels of a row."),
        ),
    ),
    Register(
        "FORMAT",
        0x08,
        "ro",
        None,
        "The fixed-point formats of the build.",
        fields=(
            Field("data_width", 0, 7, "ro", "Bits of a depth code."),
            Field("gradient_width", 8, 15, "ro", "Bits of a slope code of the gradient table."),
            Field(
                "gradient_fraction",
                16,
                23,
                "ro",
                "Its fraction bits: slope = code / 2^gradient_fraction (tridiagonal: code * gradient_lsb of the "
                "run's report).",
            ),
            Field("bits_per_channel", 24, 31, "ro", "Top bits of each colour that index the gradient table."),
        ),
    ),
    Register(
        "CONTROL",
        0x0C,
        "rw",
        0,
        "What the pipeline shall do.",
        fields=(
            Field("hold_contact", 0, 0, "rw", "`contact` stays high once raised, until this bit is cleared."),
            Field(
                "clear_counters",
                1,
                1,
                "wo",
                "A written 1 clears FRAMES_IN, FRAMES_OUT, FRAMES_DROPPED and SATURATIONS; what they count "
                "in that same clock is kept. Reads 0.",
            ),
        ),
    ),
    Register(
        "STATUS",
        0x10,
        "w1c",
        0,
        "What happened since its bit was last cleared (an event in the clock of its clearing wins), and what "
        "is the case now.",
        fields=(
            _sticky("row_short", 0, "A row ended early; its frame was dropped."),
            _sticky("row_long", 1, "A row did not end where it should; its frame was dropped."),
            _sticky("start_missing", 2, "Pixels came without a start of frame."),
            _sticky("start_early", 3, "A frame started inside another, which was dropped."),
            _sticky("timeout", 4, "A frame was given up after TIMEOUT clocks without a pixel."),
            _sticky("saturation", 5, "A value was clipped: SATURATIONS says how many."),
            _sticky(
                "out_of_step",
                6,
                "Depth was not where it was due, as after an upset: a frame was dropped, or has wrong codes.",
            ),
            Field("busy", 8, 8, "ro", "A frame is in flight."),
            Field("contact", 9, 9, "ro", "The output `contact`."),
        ),
    ),
    Register(
        "THRESHOLD",
        0x14,
        "rw",
        0x7FFF_FFFF,
        "Depth code above which `contact` is raised. After reset the largest there is, so nothing raises it.",
        signed=True,
    ),
    Register(
        "TIMEOUT",
        0x18,
        "rw",
        0,
        "Clocks without a pixel inside a frame after which the frame is given up; 0: it is waited for.",
    ),
    Register("FRAMES_IN", 0x1C, "ro", 0, "Whole, good frames that came in."),
    Register("FRAMES_OUT", 0x20, "ro", 0, "Depth frames that went out."),
    Register("FRAMES_DROPPED", 0x24, "ro", 0, "Malformed frames that were dropped."),
    Register("SATURATIONS", 0x28, "ro", 0, "Values clipped, in all frames and all nodes."),
    Register(
        "FIRST_DEPTH_LATENCY",
        0x2C,
        "ro",
        0,
        "Clocks from the first pixel to the first depth value, of the last frame that put one out.",
    ),
    Register(
        "TABLE_INDEX",
        0x30,
        "rw",
        0,
        "Bin of the gradient table that TABLE_GY writes next: the top bits of red, green and blue, red "
        "uppermost. Each write moves it on by one, from the last bin to the first. Holds 3 * "
        "bits_per_channel bits; the others read 0.",
    ),
    Register(
        "TABLE_GX",
        0x34,
        "rw",
        0,
        "Slope code dz/dx for the writes to come. Holds gradient_width bits and reads back sign-extended.",
        signed=True,
    ),
    Register(
        "TABLE_GY",
        0x38,
        "wo",
        None,
        "Slope code dz/dy, gradient_width bits: writes it with TABLE_GX to the bin TABLE_INDEX. Taken only "
        "with all four bytes strobed and while STATUS.busy is 0; otherwise SLVERR and nothing changes.",
        signed=True,
    ),
)

REGISTERS = {register.name: register for register in MAP}


def _camel(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def package() -> str:
    """Text of hdl/register_map_pkg.sv."""
    offsets, resets, bits = [], [], []
    for register in MAP:
        name = _camel(register.name)
        offsets.append(f"localparam int {name}Offset = 32'h{register.offset:02x};")
        if register.reset:
            resets.append(f"localparam int {name}Reset = 32'h{register.reset:08x};")
        for field in register.fields:
            position = "Bit" if field.width == 1 else "Lsb"
            bits.append(f"localparam int {name}{_camel(field.name)}{position} = {field.low};")
    sections = {
        "Byte offsets.": [f"localparam int AddressWidth = {ADDRESS_WIDTH};", *offsets],
        "Values after reset that are not zero.": resets,
        "Bits: number of a flag, lowest of a wider field.": bits,
    }
    body = "\n\n".join("\n".join(f"  {line}" for line in (f"// {title}", *lines)) for title, lines in sections.items())
    return (
        "// SPDX-License-Identifier: Apache-2.0\n"
        "// register_map_pkg: offsets, reset values and bits of the AXI4-Lite registers.\n"
        "//\n"
        "// Written by `python -m models.register_map` from models/register_map.py: change it there.\n\n"
        f"package register_map_pkg;\n\n{body}\n\nendpackage\n"
    )


BUS = """\
32-bit registers on AXI4-Lite (`s_axil_*`), read and written by hdl/axil_registers.sv.

- The two lowest address bits are ignored: byte strobes say which bytes of the register are written, the
  others keep their value (where a 1 clears or triggers, a byte without strobe counts as 0).
- SLVERR, and nothing changes: an offset that is not listed, a write to a read-only register, a read of a
  write-only one (data 0), and a write to TABLE_GY that cannot be taken.
- Write address and write data may come in either order. One write and one read are in flight at a time; a
  response is held until it is taken.
- Counters stay at 4,294,967,295 rather than wrap.
- Bits not listed read 0; writing them does nothing.

To write the gradient table: wait for STATUS.busy = 0, set TABLE_INDEX to 0, then write TABLE_GX and TABLE_GY
for each bin in turn.
"""


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def document() -> str:
    """Text of docs/registers.md."""
    lines = [
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "<!-- Written by `python -m models.register_map` from models/register_map.py: change it there. -->",
        "# Registers",
        "",
        BUS,
        _row("offset", "name", "access", "reset", "what"),
        _row("---", "---", "---", "---", "---"),
    ]
    for register in MAP:
        reset = "-" if register.reset is None else f"0x{register.reset:08X}" if register.reset else "0"
        what = ("Signed. " if register.signed else "") + register.description
        lines.append(_row(f"0x{register.offset:02X}", register.name, register.access, reset, what))
    lines += ["", "; ".join(f"{access}: {meaning}" for access, meaning in ACCESSES.items()) + "."]
    for register in MAP:
        if register.fields:
            lines += ["", f"## {register.name} (0x{register.offset:02X})", ""]
            lines += [_row("bits", "field", "access", "what"), _row("---", "---", "---", "---")]
            lines += [_row(f.bits, f.name, f.access, f.description) for f in register.fields]
    return "\n".join(lines) + "\n"


def generated() -> dict[Path, str]:
    """Every file that is written from the map, and its text."""
    return {ROOT / "hdl/register_map_pkg.sv": package(), ROOT / "docs/registers.md": document()}


if __name__ == "__main__":
    for path, text in generated().items():
        path.write_text(text)
        print(f"wrote {path.relative_to(ROOT)}")
