# SPDX-License-Identifier: Apache-2.0
"""Error of depth maps against double precision. No scale or offset is fitted."""

import numpy as np

SMALLEST_PEAK_PX = 0.1  # the error in % of the peak is not defined below this peak


def errors(depth_px: np.ndarray, reference_px: np.ndarray) -> dict[str, list[float | None]]:
    """Return the RMS and the largest error of each frame (frames, rows, columns), in % of the reference's peak.

    The error of a frame whose peak is below SMALLEST_PEAK_PX is None.
    """
    error = depth_px - reference_px
    peak = np.abs(reference_px).max(axis=(1, 2))
    rms = np.sqrt((error**2).mean(axis=(1, 2)))
    largest = np.abs(error).max(axis=(1, 2))
    percent = [
        [float(100 * v / p) if p >= SMALLEST_PEAK_PX else None for v, p in zip(values, peak, strict=True)]
        for values in (rms, largest)
    ]
    return {"rms_percent_of_peak": percent[0], "max_percent_of_peak": percent[1]}
