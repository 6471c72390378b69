# SPDX-License-Identifier: Apache-2.0
"""HTML page of make report: the first section is open, the others fold; sections have text, pictures and tables."""

import base64
import html
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from commands.common.repository import ROOT
from commands.common.tabular import Table

BUILD = ROOT / "build"
CODE = re.compile(r"`([^`]+)`")  # in a text
DOCUMENTS = {"synth": "resources.json", "fpga": "fpga.json", "asic": "asic.json"}  # by flow

LOOKS: dict[str, dict[str, Any]] = {
    "spectral": {"color": "#08306b", "marker": "o", "linestyle": "-"},
    "tridiagonal": {"color": "#e6550d", "marker": "s", "linestyle": "--"},
}

PUBLISHED_LOOK: dict[str, Any] = {"color": "black", "marker": "*", "markersize": 13, "linestyle": "none"}
PUBLISHED_LOOK["label"] = "published"


@dataclass(frozen=True)
class Section:
    """Section of the page: a picture, tables, or both; `alternative` is the picture in words."""

    name: str
    title: str
    text: str
    command: str
    tables: Sequence[Table] = ()
    picture: Path | None = None
    alternative: str = ""

    def _image(self) -> str:
        if self.picture is None:
            return ""
        code = base64.b64encode(self.picture.read_bytes()).decode()
        words = html.escape(self.alternative or self.title, quote=True)
        return f"<img alt='{words}' src='data:image/png;base64,{code}'>"

    def _tables(self) -> str:
        return "".join(table.html() for table in self.tables)

    def _text(self) -> str:
        words = CODE.sub(r"<code>\1</code>", html.escape(self.text))
        return f"<p>{words}</p>"

    def _command(self) -> str:
        return f"<p class='command'><code>{html.escape(self.command)}</code></p>"

    def html(self) -> str:
        """Return the section, which opens when its title is clicked."""
        body = f"{self._text()}<div class='scroll' tabindex='0'>{self._image()}</div>{self._tables()}{self._command()}"
        title = f"<summary><h2>{html.escape(self.title)}</h2></summary>"
        return f"<details id='{self.name}'>{title}{body}</details>"

    def first(self) -> str:
        """Return the section as the first screen: open, tables beside the picture where there is room."""
        beside = f"<div class='beside'><div>{self._tables()}</div><div>{self._image()}</div></div>"
        title = f"<h2>{html.escape(self.title)}</h2>"
        return f"<section id='{self.name}'>{title}{beside}{self._text()}{self._command()}</section>"


def saved(figure: Figure, folder: Path, name: str) -> Path:
    """Save a figure as PNG; return its path."""
    path = folder / f"{name}.png"
    figure.savefig(path, dpi=110)
    return path


def results(flow: str) -> list[dict[str, Any]]:
    """Return the documents that a flow left in build/, for any configuration, the latest last."""
    paths = sorted(BUILD.glob(f"{flow}/*/{DOCUMENTS[flow]}"), key=lambda path: path.stat().st_mtime)
    return [json.loads(path.read_text()) for path in paths]


STYLE = """
body { font: 16px/1.45 system-ui, sans-serif; max-width: 80rem; margin: 0 auto; padding: 0.5rem 1rem 3rem; }
body { color: #111; } h1 { font-size: 1.5rem; margin: 0.4rem 0; } h2 { font-size: 1.2rem; margin: 0.4rem 0; }
h3 { font-size: 1rem; margin: 1rem 0 0; }
img { max-width: 100%; height: auto; } p { overflow-wrap: anywhere; max-width: 60rem; }
.scroll { overflow-x: auto; margin: 0.5rem 0 1rem; } table { border-collapse: collapse; font-size: 0.85rem; }
th, td { border: 1px solid #999; padding: 0.2rem 0.5rem; text-align: left; vertical-align: top; }
th { background: #eee; }
.command { color: #444; } code { font-size: 0.85rem; }
details { border-top: 1px solid #ccc; padding: 0.3rem 0; } summary { cursor: pointer; padding: 0.2rem 0; }
summary h2 { display: inline; font-size: 1.05rem; }
.beside > div { min-width: 0; }
.beside th:first-child, .beside td:first-child { position: sticky; left: 0; min-width: 6.5rem; }
.beside td:first-child { background: #fff; }
@media (max-width: 61.99rem) {
 .beside table { font-size: 0.78rem; } .beside td + td { min-width: 6.2rem; }
 details img { max-width: none; width: 44rem; }
}
@media (min-width: 62rem) {
 .beside { display: grid; grid-template-columns: minmax(0, 1.45fr) minmax(0, 1fr); gap: 1rem; align-items: start; }
}
"""


def page(sections: Sequence[Section], left_out: str = "") -> str:
    """Return the page: the first section is the first screen, the others fold; `left_out` is a last sentence."""
    first, *others = sections
    end = f"<p>{html.escape(left_out)}</p>" if left_out else ""
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>tactile-depth: report</title>"
        f"<meta name='viewport' content='width=device-width, initial-scale=1'><style>{STYLE}</style></head><body>"
        f"<h1>tactile-depth: what it achieves</h1>{first.first()}"
        f"{''.join(section.html() for section in others)}{end}</body></html>"
    )
