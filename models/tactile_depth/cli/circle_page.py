# SPDX-License-Identifier: Apache-2.0
"""A page, whole in one file, on which a user corrects the circles of presses with the mouse and saves their table."""

from __future__ import annotations

import base64
import io
import json

import numpy as np
from PIL import Image

from tactile_depth.calibrate.press_folder import HEAD, table_rows
from tactile_depth.calibrate.press_pictures import PressPictures
from tactile_depth.calibrate.presses import GridPresses
from tactile_depth.cli.overview import change_of

MOST_COLUMNS = 640  # of a picture in the page
PAGE = """<!doctype html><meta charset="utf-8"><title>Circles of presses</title>
<style>
body { font: 16px sans-serif; margin: 24px } figure { display: inline-block; margin: 8px }
canvas { width: 480px; cursor: crosshair }
</style>
<p>Drag from the centre of a contact to its edge to draw its circle; a click removes it, and the circle is searched for
again. Delete the line of a press in the table to leave it out.</p>
<p><button>Save the table</button> Then give it to <code>tactile-depth calibrate PRESSES --circles FILE.csv</code>.</p>
<script>
const [columns, rows, aspect, head, presses] = DATA;
for (const press of presses) {
  const figure = document.body.appendChild(document.createElement("figure"));
  const canvas = figure.appendChild(document.createElement("canvas"));
  figure.appendChild(document.createElement("figcaption")).textContent = press.cells[0];
  [canvas.width, canvas.height] = [columns, rows];
  const picture = new Image(), pen = canvas.getContext("2d");
  const draw = () => {
    pen.drawImage(picture, 0, 0, columns, rows);
    const [x, y, radius] = press.cells.slice(2, 5).map(Number);
    if (!radius) return;
    pen.lineWidth = columns / 240;
    pen.beginPath();
    pen.ellipse(x + 0.5, y + 0.5, radius / aspect, radius, 0, 0, 7);
    pen.stroke();
  };
  picture.onload = draw;
  picture.src = "data:image/jpeg;base64," + press.picture;
  const at = ({offsetX: x, offsetY: y}) =>
    [x * columns / canvas.clientWidth - 0.5, y * rows / canvas.clientHeight - 0.5];
  let centre = null;
  const follow = event => {
    if (!centre) return;
    const [x, y] = at(event);
    const radius = Math.hypot((x - centre[0]) * aspect, y - centre[1]);
    const circle = radius < 2 ? ["", "", ""] : [...centre, radius].map(number => number.toFixed(2));
    press.cells.splice(2, 3, ...circle);
    draw();
  };
  canvas.onpointerdown = event => { centre = at(event); canvas.setPointerCapture(event.pointerId); follow(event); };
  canvas.onpointermove = follow;
  canvas.onpointerup = event => { follow(event); centre = null; };
}
document.querySelector("button").onclick = () => {
  const quoted = cell => /[",]/.test(cell) ? '"' + cell.replaceAll('"', '""') + '"' : cell;
  const lines = [head, ...presses.map(press => press.cells)].map(cells => cells.map(quoted).join(","));
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([lines.join("\\n") + "\\n"], {type: "text/csv"}));
  link.download = "circles.csv";
  link.click();
};
</script>
"""


def circle_page(pictures: PressPictures, presses: GridPresses) -> str:
    """Return the page, HTML, with the change of each press against the background."""
    rows, columns = pictures.background.shape[:2]
    shown = []
    for press, cells in zip(pictures.presses, table_rows(pictures.presses, presses.circles), strict=True):
        if (change := change_of(pictures, press)) is not None:
            shown.append({"cells": cells, "picture": _jpeg(change)})
    data = json.dumps([columns, rows, presses.aspect, HEAD, shown]).replace("<", "\\u003c")
    return PAGE.replace("DATA", data, 1)


def _jpeg(pixels: np.ndarray) -> str:
    picture, file = Image.fromarray(pixels), io.BytesIO()
    picture.thumbnail((MOST_COLUMNS, MOST_COLUMNS))
    picture.save(file, "JPEG")
    return base64.b64encode(file.getvalue()).decode()
