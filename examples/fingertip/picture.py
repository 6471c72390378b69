# SPDX-License-Identifier: Apache-2.0
"""Files for tb_fingertip.sv: pixels.hex, a picture of the grid, and deepest.hex, its deepest code in the model."""

from pathlib import Path

import tactile_depth as td
from tactile_depth.sensor.scenes import render

ROWS, COLUMNS = 8, 16  # of the module that `make wrap` or fingertip.core writes, as is all that the pipeline gets

pipeline = td.Pipeline(td.load("synthetic"), grid=(ROWS, COLUMNS), boundary="dirichlet", zero_offset=False)
picture = render("ball", ROWS, COLUMNS).frames[0]
deepest = pipeline(picture).codes.max()

words = [f"{red << 16 | blue << 8 | green:06x}\n" for red, green, blue in picture.reshape(-1, 3).tolist()]
Path("pixels.hex").write_text("".join(words))
Path("deepest.hex").write_text(f"{deepest:06x}\n")
print(f"the deepest code is {deepest}: {deepest * pipeline.depth_lsb_mm:.3f} mm")
