# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/camera/camera_registers.sv: the results of reads, and the effects of writes and events.

The model does not count cycles. In one cycle a read sees the registers first, then the
write takes effect, then the events of the cycle before. This order makes setting win over clearing.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from tactile_depth.chip.camera.camera_front_end import OF_RESET, reset_parameters
from tactile_depth.chip.camera.camera_window import FAULTS
from tactile_depth.chip.camera.pixel_format import pixel_format_parameters
from tactile_depth.chip.camera_configuration import FORMATS, CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_MAP, CAMERA_REGISTERS, WORD
from tactile_depth.chip.registers.setting_registers import SettingRegisters

STATUS, CONTROL = CAMERA_REGISTERS["CAMERA_STATUS"], CAMERA_REGISTERS["CAMERA_CONTROL"]
ARRIVED = CAMERA_REGISTERS["CAMERA_ARRIVED"]
COUNTERS = ("CAMERA_DROPPED", "CAMERA_LOST")
WINDOW = ("CAMERA_PICTURE", "CAMERA_WINDOW", "CAMERA_WINDOW_SIZE")
"""Registers of the part of a picture that the grid shows."""
NUMBERS = ("black_level", "red_gain", "green_gain", "blue_gain")
"""Settings that are registers of their own."""


def camera_registers_parameters(camera: CameraConfiguration) -> dict[str, int]:
    """Parameters of hdl/camera/camera_registers.sv."""
    return {
        **reset_parameters(camera),
        "WindowColumns": camera.crop[2],
        "WindowRows": camera.crop[3],
        **pixel_format_parameters(camera),
    }


@dataclass(frozen=True)
class Setup:
    """Outputs of camera_setup."""

    done: bool = False
    failed: bool = False
    entry: int = 0
    found: int = 0


@dataclass(frozen=True)
class Levels:
    """Outputs of camera_front_end that are shown as they are, by the members of `camera_levels_t`."""

    hunting: int = 0
    waiting: int = 0
    arrived_columns: int = 0
    arrived_rows: int = 0


@dataclass
class CameraRegisters:
    """State of the registers of one build.

    Attributes
    ----------
    parameters : mapping
        See `camera_registers_parameters`.
    values : dict
        Register name to word, as a read returns it, without what `Setup` and `Levels` show.
    """

    parameters: Mapping[str, int]
    values: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        p, named = self.parameters, CAMERA_REGISTERS
        window = named["CAMERA_WINDOW_SIZE"].pack(columns=p["WindowColumns"], rows=p["WindowRows"])
        bits = tuple(FORMATS.values())[p["Format"]].bits
        form = named["CAMERA_FORMAT"].pack(pixel_format=p["Format"], phase=p["Phase"], bits=bits)
        self.values.update(dict.fromkeys(named, 0) | {"CAMERA_WINDOW_SIZE": window, "CAMERA_FORMAT": form})
        resets = {
            "CAMERA_PICTURE": named["CAMERA_PICTURE"].pack(columns=p["PictureColumns"], rows=p["PictureRows"]),
            "CAMERA_WINDOW": named["CAMERA_WINDOW"].pack(x=p["WindowX"], y=p["WindowY"]),
            **{f"CAMERA_{name.upper()}": p[OF_RESET[name]] for name in NUMBERS},
        }
        self._settings = SettingRegisters(resets, self.values, CAMERA_MAP)
        self._arrived: tuple[frozenset[str], int] = (frozenset(), 0)

    def reset(self) -> None:
        """Set every register to its reset value."""
        self._settings.reset()
        self.values.update(dict.fromkeys((STATUS.name, *COUNTERS), 0))
        self._arrived = frozenset(), 0

    @property
    def settings(self) -> dict[str, int]:
        """Return the settings of camera_front_end, by the members of `camera_settings_t`."""
        picture = CAMERA_REGISTERS["CAMERA_PICTURE"].unpack(self.values["CAMERA_PICTURE"])
        window = CAMERA_REGISTERS["CAMERA_WINDOW"].unpack(self.values["CAMERA_WINDOW"])
        return {
            **picture,
            "window_x": window["x"],
            "window_y": window["y"],
            **{name: self.values[f"CAMERA_{name.upper()}"] for name in NUMBERS},
        }

    def read(self, name: str, setup: Setup = Setup(), levels: Levels = Levels()) -> int:
        """Return the word of a register."""
        waits = {"hunting": levels.hunting, "waiting": levels.waiting}
        shown = {
            STATUS.name: STATUS.pack(setup_done=int(setup.done), setup_failed=int(setup.failed), **waits),
            ARRIVED.name: ARRIVED.pack(columns=levels.arrived_columns, rows=levels.arrived_rows),
            "CAMERA_SETUP": CAMERA_REGISTERS["CAMERA_SETUP"].pack(entry=setup.entry, found=setup.found),
        }
        return self.values[name] | shown.get(name, 0)

    def write(self, name: str, ones: int, mask: int) -> None:
        """Take a write: its data, 0 in bytes without strobe, and a mask of the bytes with strobe."""
        self._settings.write(name, ones, mask)
        if name == STATUS.name:
            self.values[name] &= ~ones
        if name == CONTROL.name and CONTROL.unpack(ones)["clear_counters"]:
            self.values.update(dict.fromkeys(COUNTERS, 0))

    def clock(self, faults: Collection[str], frames_lost: int) -> None:
        """Take the events of one cycle, after the write of that cycle. The registers see them one cycle later.

        Parameters
        ----------
        faults : collection of str, of `camera_window.FAULTS`
        frames_lost : int
            Frames that dvp_receive gave up.
        """
        values, (arrived, lost) = self.values, self._arrived
        bits = {fault: int(fault in arrived) for fault in FAULTS}
        values[STATUS.name] |= STATUS.pack(**bits, lost=int(lost > 0))
        for name, more in zip(COUNTERS, (int(bool(arrived)), lost), strict=True):
            values[name] = min(values[name] + more, WORD)
        self._arrived = frozenset(faults), frames_lost
