# SPDX-License-Identifier: Apache-2.0
"""Register lists of cameras for hdl/camera/camera_setup.sv: raw Bayer pixels of 8 bits, everything automatic off.

A calibration holds for one response of the camera. So exposure and gains are fixed, and white balance, gamma,
denoising, edge enhancement, defect correction and lens correction are off. All other registers keep the values of a
reset.

These lists are drafts. None has been tried on a camera, and only the fields of the OV7725 were compared with a second
source. Check each value against the data sheet before use.

Sources, by OmniVision: OV7670/OV7171 data sheet, version 1.4, 2006, table 5; OV7725 data sheet, version 1.1, 2007,
table 6; OV5640 product specification, version 2.03, 2011, section 7.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tactile_depth.base.errors import Argument, within
from tactile_depth.chip.camera.camera_setup import Entry, Kind
from tactile_depth.chip.rom_files import write_words

FILE = "camera.hex"
WORD_BITS = 26


@dataclass(frozen=True)
class Camera:
    """A camera, and the list that brings it up.

    Attributes
    ----------
    name : str
    address_bytes, device_id : int
        Of its SCCB: bytes of a register's address; first byte of a write.
    picture : tuple of int
        Rows and columns that it sends.
    bayer : str
        Colours of its first two rows, as in `BAYER` of `make sim`.
    frames_per_s : float
        At an XCLK of 24 MHz.
    entries : sequence of Entry
    """

    name: str
    address_bytes: int
    device_id: int
    picture: tuple[int, int]
    bayer: str
    frames_per_s: float
    entries: Sequence[Entry]


def writes(registers: Mapping[int, int]) -> list[Entry]:
    """Return writes of data to addresses, in their order."""
    return [Entry(Kind.WRITE, *register) for register in registers.items()]


def pins(power_down: bool, reset_n: bool, milliseconds: int) -> Entry:
    return Entry(Kind.PINS, 2 * power_down + reset_n, milliseconds)


def _power_up(product: Sequence[tuple[int, int]], reset: tuple[int, int]) -> list[Entry]:
    """Return the pins' sequence, the check of the product ID, and the reset of all registers."""
    return [
        pins(True, False, 10),
        pins(False, False, 10),
        pins(False, True, 20),
        *(Entry(Kind.CHECK, address, value) for address, value in product),
        Entry(Kind.PLAIN_WRITE, *reset),
        pins(False, True, 10),
    ]


def ov7670(exposure_lines: int = 256) -> Camera:
    """Return the OV7670: VGA, 30 frames/s. Exposure in lines, of 510 in a frame."""
    within(Argument("exposure_lines", exposure_lines), 1, 510)
    registers = {
        0x3A: 0x0D,  # TSLB: the window follows the resolution
        0x12: 0x01,  # COM7: VGA, raw Bayer
        0x11: 0x80,  # CLKRC: input clock / 1
        0x6B: 0x0A,  # DBLV: PLL bypassed
        0x0C: 0x00,  # COM3: no scaling
        0x3E: 0x00,  # COM14: pixel clock not divided
        0x15: 0x00,  # COM10: PCLK runs between rows; HREF, VSYNC high; data at the rising edge
        0x13: 0x00,  # COM8: AGC, AWB, AEC and banding filter off
        0x3B: 0x00,  # COM11: no night mode
        0x3D: 0x18,  # COM13: gamma off, no adjustment of saturation
        0x41: 0x00,  # COM16: gains of white balance, automatic edges and denoising off
        0x3F: 0x00,  # EDGE: no edge enhancement
        0x4C: 0x00,  # DNSTH: no denoising
        0x66: 0x00,  # LCC5: lens correction off
        0x00: 0x00,  # GAIN: 1
        0x03: 0x03,  # VREF: the upper bits of the gain 0; the window's lowest as after a reset
        0x07: exposure_lines >> 10,  # AECHH
        0x10: exposure_lines >> 2 & 0xFF,  # AECH
        0x04: exposure_lines & 3,  # COM1: the lowest two
    }
    entries = [*_power_up([(0x0A, 0x76), (0x0B, 0x73)], (0x12, 0x80)), *writes(registers)]
    return Camera("ov7670", 1, 0x42, (480, 640), "bggr", 30.0, entries)


def ov7725(exposure_lines: int = 256) -> Camera:
    """Return the OV7725: VGA, 60 frames/s. Exposure in lines, of 510 in a frame."""
    within(Argument("exposure_lines", exposure_lines), 1, 510)
    registers = {
        0x0D: 0x41,  # COM4: PLL x 4
        0x11: 0x81,  # CLKRC: / (2 (1 + 1)), so 24 MHz from 24 MHz
        0x12: 0x13,  # COM7: VGA, raw of the sensor
        0x67: 0x02,  # DSP_Ctrl4: 8 bits raw
        0x0C: 0x00,  # COM3: not mirrored, nothing exchanged
        0x15: 0x00,  # COM10: PCLK runs between rows; HREF, VSYNC high; data at the rising edge
        0x13: 0x00,  # COM8: AGC, AWB, AEC and banding filter off
        0x0E: 0x01,  # COM5: the frame rate stays
        0x63: 0x00,  # AWB_Ctrl0: gains of white balance off
        0x64: 0x00,  # DSP_Ctrl1: gamma, matrix, interpolation, defect correction off
        0xAC: 0x00,  # DSPAuto: no automatic thresholds
        0x8E: 0x00,  # DNSTh: no denoising
        0x8F: 0x00,  # EDGE0: no edge enhancement
        0x46: 0x00,  # LC_CTR: lens correction off
        0x00: 0x00,  # GAIN: 1
        0x08: exposure_lines >> 8,  # AECH
        0x10: exposure_lines & 0xFF,  # AEC
    }
    entries = [*_power_up([(0x0A, 0x77), (0x0B, 0x21)], (0x12, 0x80)), *writes(registers)]
    return Camera("ov7725", 1, 0x42, (480, 640), "bggr", 60.0, entries)


OV5640_LINE, OV5640_LINES = 1896, 984  # pixel clocks of a line, lines of a frame


def ov5640(exposure_lines: int = 480) -> Camera:
    """Return the OV5640: 1280 x 960, 2 x 2 pixels of the whole array in one, 30 frames/s. Exposure in lines, of 984."""
    within(Argument("exposure_lines", exposure_lines), 1, OV5640_LINES - 4)
    words = {
        0x3800: 0,  # first column
        0x3802: 4,  # first row
        0x3804: 2623,  # last column
        0x3806: 1947,  # last row
        0x3808: 1280,
        0x380A: 960,
        0x380C: OV5640_LINE,
        0x380E: OV5640_LINES,
        0x3810: 16,  # columns left out on the left
        0x3812: 6,  # rows left out at the top
        0x3400: 0x400,  # AWB gains of red, green, blue: 1
        0x3402: 0x400,
        0x3404: 0x400,
        0x3501: 16 * exposure_lines & 0xFFFF,  # in 1/16 lines
        0x350A: 0x010,  # gain: 1
    }
    registers = {
        0x3103: 0x03,  # system clock from the PLL
        0x3017: 0x7F,  # VSYNC, HREF, PCLK, D[9:6] are outputs
        0x3018: 0xFC,  # D[5:0]
        0x300E: 0x58,  # MIPI off
        0x3034: 0x18,  # PLL: bits 8, so / 2
        0x3035: 0x31,  # / 3
        0x3036: 0x54,  # x 84
        0x3037: 0x03,  # / 3 in front, / 1 behind
        0x3108: 0x11,  # PCLK and SCLK / 2: 56 MHz from 24 MHz
        **{address + byte: word >> 8 * (1 - byte) & 0xFF for address, word in words.items() for byte in (0, 1)},
        0x3814: 0x31,  # every second column
        0x3815: 0x31,  # every second row
        0x3820: 0x41,  # not flipped, rows binned
        0x3821: 0x01,  # not mirrored, columns binned
        0x3503: 0x07,  # exposure, gain and length of a frame by hand
        0x3500: 16 * exposure_lines >> 16,
        0x3406: 0x01,  # white balance by hand
        0x5000: 0x00,  # lens correction, gamma, defect correction, interpolation off
        0x5001: 0x00,  # special effects, scaling, matrix, white balance off
        0x501F: 0x03,  # raw
        0x4300: 0x00,  # raw, rows of B G and G R in turn
        0x4740: 0x22,  # HREF high, data at the rising edge of PCLK, which runs between rows
        0x3008: 0x02,  # awake
    }
    asleep = {0x3008: 0x42}  # while registers are written
    entries = [*_power_up([(0x300A, 0x56), (0x300B, 0x40)], (0x3008, 0x82)), *writes(asleep), *writes(registers)]
    return Camera("ov5640", 2, 0x78, (960, 1280), "bggr", 30.0, entries)


CAMERAS = {"ov7670": ov7670, "ov7725": ov7725, "ov5640": ov5640}


def setup_parameters(camera: Camera) -> dict[str, int]:
    """Parameters of hdl/camera/camera_setup.sv that follow from a camera."""
    return {"Entries": len(camera.entries), "AddressBytes": camera.address_bytes, "DeviceId": camera.device_id}


def write_list(folder: Path, entries: Sequence[Entry]) -> None:
    """Write the file that camera_setup reads into a folder."""
    write_words(folder / FILE, [entry.word for entry in entries], WORD_BITS)
