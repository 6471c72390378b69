# SPDX-License-Identifier: Apache-2.0
"""Video of a ball that is pressed in and rolled, with the reference and calibration that `tactile-depth live` needs.

    python tests/press_video.py FOLDER [FRAMES]

writes press.avi (320 x 240, lossless, 300 frames by default), background.png and sensor.npz; OpenCV writes the video:

    tactile-depth live FOLDER/press.avi --reference FOLDER/background.png --calibration FOLDER/sensor.npz
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import tactile_depth as td
from tactile_depth.sensor.samples import CAMERA
from tactile_depth.sensor.scenes import Press, render

DRAWN = 24  # different frames, which repeat
DEEPEST_MM, CIRCLE_MM = 1.4, 3.0


def press_frames(drawn: Any = DRAWN) -> Any:
    """Return the frames of one cycle of the motion, uint8 (drawn, 240, 320, 3), RGB."""
    frames = []
    for index in range(drawn):
        turn = 2 * math.pi * index / drawn
        position = (CIRCLE_MM * math.cos(turn), CIRCLE_MM * math.sin(turn))
        depth_mm = DEEPEST_MM * (0.55 - 0.45 * math.cos(turn))
        frames.append(render("ball", CAMERA.rows, CAMERA.columns, index, Press(depth_mm, position)).frames[0])
    return np.stack(frames)


def write_sensor(folder: Path) -> None:
    """Write background.png and sensor.npz of the sample."""
    sample = td.sample("ball")
    Image.fromarray(sample.reference).save(folder / "background.png")
    sample.sensor.save(folder / "sensor.npz")


def write_inputs(folder: Path, frames: int) -> Path:
    """Write background.png, sensor.npz and a folder of pictures, presses; return the folder."""
    write_sensor(folder)
    (folder / "presses").mkdir()
    for index, image in enumerate(press_frames(frames)):
        Image.fromarray(image).save(folder / "presses" / f"{index}.png")
    return folder


def write_video(path: Path, frames: Any, count: int) -> None:
    """Write `count` frames without loss; the motion repeats."""
    import cv2

    video = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"FFV1"), 30, (CAMERA.columns, CAMERA.rows))
    assert video.isOpened(), "this OpenCV writes no FFV1"
    for index in range(count):
        video.write(cv2.cvtColor(frames[index % len(frames)], cv2.COLOR_RGB2BGR))
    video.release()


if __name__ == "__main__":
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    write_sensor(out)
    write_video(out / "press.avi", press_frames(), int(sys.argv[2]) if len(sys.argv) > 2 else 300)
