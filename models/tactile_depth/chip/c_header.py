# SPDX-License-Identifier: Apache-2.0
"""C header with the tables of a calibration, the function that loads them over the registers, and the registers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import resources
from types import MappingProxyType

import numpy as np

from tactile_depth.chip import registers
from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.camera.camera_registers import WINDOW, CameraRegisters, camera_registers_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.frame_marks import slope_limit
from tactile_depth.chip.registers.axil_registers import Build
from tactile_depth.chip.registers.event_registers import SELF_TEST
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS, MAP, REGISTERS, TABLES, WORD
from tactile_depth.chip.registers.table_banks import COMMIT
from tactile_depth.chip.registers.table_signatures import table_signatures
from tactile_depth.chip.self_test import built_in
from tactile_depth.chip.table_entries import ONE_WORD, table_entries
from tactile_depth.chip.tactile_depth import top_parameters

FILE = "tactile_depth_tables.h"
PREFIX = "TACTILE_DEPTH_"
SHOWN = ("ID", "GRID", "FORMAT", "DEVICE", "DEPTH_UNIT", "SLOPE_UNIT", "ARITHMETIC")
"""Registers that a device of the configuration shows; of DEVICE all fields but the lanes."""
WORDS_OF_LINE = 8
NO_THRESHOLDS: Mapping[str, int] = MappingProxyType({})
ABOUT = """\
/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of a calibration for a device of tactile_depth, and tactile_depth_load, which loads them over its registers.

   Generated: do not edit. It needs C99 or C++, and no other header than stdint.h. Two functions that you write make its
   accesses to registers. A program with several calibrations includes each in a source file of its own. */
"""


def c_header(
    calibration: Calibration,
    config: Configuration,
    zero: np.ndarray | None = None,
    gains: np.ndarray | None = None,
    thresholds: Mapping[str, int] = NO_THRESHOLDS,
    camera: CameraConfiguration | None = None,
) -> str:
    """Return the text of `FILE`.

    Parameters
    ----------
    zero, gains
        See `table_entries`.
    thresholds : mapping
        Depth code of each register of a threshold, by the name of the register.
    camera : CameraConfiguration, optional
        Camera of the device, if it is a `tactile_sensor`.
    """
    tables = table_entries(calibration, config, zero, gains)
    loader = resources.files(registers).joinpath("load_tables.h").read_text().partition("\n")[2]
    sections = (
        "#ifndef TACTILE_DEPTH_TABLES_H\n#define TACTILE_DEPTH_TABLES_H\n\n#include <stdint.h>\n",
        _units(calibration, config),
        _device(calibration, config),
        _window(camera),
        _thresholds(thresholds),
        _self_test(built_in(calibration, config, zero, gains)),
        _registers(),
        _tables(tables),
        loader,
        "#endif\n",
    )
    return ABOUT + "\n".join(filter(None, sections))


def define(name: str, value: object) -> str:
    """Return the definition of a macro."""
    return f"#define {PREFIX}{name} {value}\n"


def word(value: int) -> str:
    """Return the lower 32 bits of a whole number as C writes them."""
    return f"0x{value & WORD:08x}u"


def _units(calibration: Calibration, config: Configuration) -> str:
    """Return the name of the calibration, the grid and the units."""
    name = re.sub(r"[^\w .,()+-]", "_", calibration.name, flags=re.ASCII)
    pitch_mm = calibration.pixel_pitch_mm
    return (
        "/* A depth in mm is its code * TACTILE_DEPTH_DEPTH_LSB_MM, a slope its code * TACTILE_DEPTH_GRADIENT_LSB.\n"
        "   The pitch is the height of a pixel. Its width is TACTILE_DEPTH_PIXEL_ASPECT times that, and so are the\n"
        "   slopes along a row. */\n"
        + define("CALIBRATION", f'"{name}"')
        + define("ROWS", config.rows)
        + define("COLUMNS", config.columns)
        + define("PIXEL_PITCH_MM", repr(float(pitch_mm)))
        + define("PIXEL_ASPECT", repr(float(calibration.pixel_aspect)))
        + define("DEPTH_LSB_MM", repr(float(config.depth_lsb_px * pitch_mm)))
        + define("GRADIENT_LSB", repr(float(config.gradient_lsb)))
    )


def _device(calibration: Calibration, config: Configuration) -> str:
    """Return the words of the registers of a device that fits."""
    build = Build(top_parameters(config, calibration.pixel_pitch_mm))
    device = REGISTERS["DEVICE"]
    mask = device.mask() & ~device.field("lanes").mask
    words = {"ID": REGISTERS["ID"].reset or 0, **build.description, "PITCH": build.parameters["PitchNm"]}
    words["SLOPE_LIMIT"] = slope_limit(calibration, config)
    words["DEVICE"] &= mask
    return (
        "/* Words that a device that fits shows; the words that are written to PITCH and SLOPE_LIMIT. */\n"
        + "".join(define(name, word(words[name])) for name in (*SHOWN, "PITCH", "SLOPE_LIMIT"))
        + define("DEVICE_MASK", word(mask))
    )


def _window(camera: CameraConfiguration | None) -> str:
    """Return words and addresses of the registers of the window that the pitch is for."""
    if camera is None:
        return ""
    words = CameraRegisters(camera_registers_parameters(camera)).values
    text = "/* Words of the camera's registers that a device that fits shows, as after a reset; their addresses. */\n"
    for name in WINDOW:
        text += define(name, word(words[name])) + define(f"{name}_ADDRESS", f"0x{CAMERA_REGISTERS[name].offset:02x}u")
    return text


def _thresholds(thresholds: Mapping[str, int]) -> str:
    """Return the values of the registers of thresholds."""
    if not thresholds:
        return ""
    listed = "".join(define(name, word(code)) for name, code in thresholds.items())
    return "/* Values for the registers of these names, which tactile_depth_load does not write. */\n" + listed


def _self_test(signature: int) -> str:
    """Return the word of a device that computes right."""
    text = "/* What SELF_TEST shows with these tables, light gains of 1 and DARK_LEVEL 0, as after a reset. */\n"
    return text + define(SELF_TEST, word(signature))


def _registers() -> str:
    """Return the byte address of each register, and the bits of its fields, unless the register is one number."""
    text = "/* Byte address of each register, and the bits of each field. */\n"
    for register in MAP:
        text += define(f"{register.name}_ADDRESS", f"0x{register.offset:02x}u")
        for field in register.fields:
            if field.name != "value":
                text += define(f"{register.name}_{field.name.upper()}", word(field.mask))
    return text


def _tables(tables: Mapping[str, np.ndarray]) -> str:
    """Return the arrays of the tables, and the array that lists them."""
    bits = {name: COMMIT.pack(**{name: 1}) for name in tables}
    macros = "".join(define(f"{name.upper()}_TABLE", word(bit)) for name, bit in bits.items())
    macros += define("ALL_TABLES", word(sum(bits.values()))) + define("TABLES", len(tables))
    signatures = table_signatures(tables)
    listed = "".join(
        f"  {{{REGISTERS['TABLE_SELECT'].pack(select=TABLES[name])}u, {word(bits[name])}, {len(entries)}u, "
        f"{1 if name in ONE_WORD else 2}u, {word(signatures[name])}, tactile_depth_{name}}},\n"
        for name, entries in tables.items()
    )
    return (
        f"/* Bits of the tables in TABLE_COMMIT. */\n{macros}\n"
        + "\n".join(_array(name, entries) for name, entries in tables.items())
        + """
struct tactile_depth_table {
  uint32_t select;         /* number of the table, for TABLE_SELECT */
  uint32_t commit;         /* its bit of TABLE_COMMIT */
  uint32_t entries;        /* TABLE_SIZE */
  uint32_t words_of_entry; /* 1: TABLE_LOW alone; 2: TABLE_HIGH, then TABLE_LOW */
  uint32_t signature;      /* TABLE_SIGNATURE */
  const uint32_t *words;
};

static const struct tactile_depth_table tactile_depth_tables[TACTILE_DEPTH_TABLES] = {
"""
        + listed
        + "};\n"
    )


def _array(name: str, entries: np.ndarray) -> str:
    """Return the array of the words of a table, in the order in which they are written."""
    order = "TABLE_LOW of each entry" if name in ONE_WORD else "TABLE_HIGH and TABLE_LOW of each entry"
    words = (entries[:, :1] if name in ONE_WORD else entries[:, ::-1]).ravel().tolist()
    lines = "".join(
        f"  {', '.join(map(word, words[start : start + WORDS_OF_LINE]))},\n"
        for start in range(0, len(words), WORDS_OF_LINE)
    )
    return f"/* {order}. */\nstatic const uint32_t tactile_depth_{name}[{len(words)}] = {{\n{lines}}};\n"
