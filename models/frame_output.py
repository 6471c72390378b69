# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/frame_output.sv: frames of words in, the beats of good frames out."""

from __future__ import annotations

import numpy as np


def frame_output(frames: np.ndarray, bad: np.ndarray) -> np.ndarray:
    """Beats that leave.

    Parameters
    ----------
    frames : int64 array (frames, rows, columns)
    bad : bool array (frames,)
        True: the frame does not leave.

    Returns
    -------
    int64 array (beats, 3): data, last (of a row), user (first of a frame)
    """
    good = frames[~np.asarray(bad, dtype=bool)]
    last, user = np.zeros_like(good), np.zeros_like(good)
    last[:, :, -1] = 1
    user[:, 0, 0] = 1
    return np.stack((good, last, user), axis=-1).reshape(-1, 3)
