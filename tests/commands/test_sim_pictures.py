# SPDX-License-Identifier: Apache-2.0
"""Pictures of a sensor that `make sim` refuses or warns of, as the package does."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from skimage import io  # type: ignore[attr-defined]

from tactile_depth.sensor.built_in import load
from tests.drawn_light import no_contact

Edit = Callable[[np.ndarray], np.ndarray]
WRONG: dict[str, tuple[Edit, str]] = {
    "BGR": (lambda picture: picture[..., ::-1], "red and blue are exchanged"),
    "rotated": (lambda picture: picture[::-1, ::-1], "rotated by 180 degrees"),
    "overexposed": (lambda picture: np.minimum(picture * 2.5, 255).astype(np.uint8), "are clipped"),
    "black": (np.zeros_like, "it is black"),
}


def _words(folder: Path, **edited: Edit) -> list[str]:
    """Write a picture of a sensor without contact and a press; return the variables, and those of edited presses."""
    rest = no_contact(load("gelsight-mini"))
    press = rest.copy()
    press[100:140, 140:180] = np.clip(press[100:140, 140:180] + np.array((30, 0, -30)), 0, 255)
    pictures = {"REFERENCE": rest, "FRAMES": press, **{name: edit(press) for name, edit in edited.items()}}
    for name, picture in pictures.items():
        io.imsave(folder / f"{name}.png", picture, check_contrast=False)
    words = [f"{name}={folder / name}.png" for name in pictures]
    return ["PRESET=sensor", "ROWS=24", "COLS=32", "SIM=icarus", "CALIBRATION=gelsight-mini", *words]


@pytest.mark.parametrize("kind", WRONG)
def test_a_picture_that_gives_no_right_depth_is_refused(tmp_path: Path, refused: Any, kind: str) -> None:
    edit, problem = WRONG[kind]
    line = refused("sim", *_words(tmp_path, FRAMES=edit), f"OUT={tmp_path / 'out'}")
    assert problem in line
    assert "FRAMES.png" in line
    assert not (tmp_path / "out").exists()


def test_a_black_zero_offset_is_refused(tmp_path: Path, refused: Any) -> None:
    assert "ZERO.png: it is black" in refused("sim", *_words(tmp_path, ZERO=np.zeros_like), f"OUT={tmp_path / 'out'}")


def test_a_press_in_the_zero_offset_is_warned_of_and_reported(tmp_path: Path, run_command: Any) -> None:
    ended = run_command("sim", *_words(tmp_path, ZERO=lambda picture: picture), f"OUT={tmp_path / 'out'}")
    assert ended.status == 0
    begin = f"make sim: warning: ZERO={tmp_path / 'ZERO.png'}: differences of"
    assert len([line for line in ended.errors if line.startswith(begin)]) == 1
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert [f"make sim: warning: {line}" for line in report["warnings"]] == ended.errors


def test_warnings_of_a_camera_are_shown_once(tmp_path: Path, run_command: Any) -> None:
    words = _words(tmp_path, ZERO=lambda picture: picture)
    ended = run_command("sim", *words, "CAMERA=rgb565", f"OUT={tmp_path / 'out'}")
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert [f"make sim: warning: {line}" for line in report["warnings"]] == ended.errors
    assert len(set(ended.errors)) == len(ended.errors)
