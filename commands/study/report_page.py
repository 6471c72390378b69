# SPDX-License-Identifier: Apache-2.0
"""HTML page of make report: sections of a picture and tables, with text and command."""

import base64
import html
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from commands.common.repository import ROOT
from commands.common.tabular import Table

BUILD = ROOT / "build"
DOCUMENTS = {"synth": "resources.json", "fpga": "fpga.json", "asic": "asic.json"}  # by flow

LOOKS: dict[str, dict[str, Any]] = {
    "spectral": {"color": "#08306b", "marker": "o", "linestyle": "-"},
    "tridiagonal": {"color": "#e6550d", "marker": "s", "linestyle": "--"},
}

PUBLISHED_LOOK: dict[str, Any] = {"color": "black", "marker": "*", "markersize": 13, "linestyle": "none"}
PUBLISHED_LOOK["label"] = "published"


@dataclass(frozen=True)
class Section:
    """Section of the page: a picture, tables, or both."""

    name: str
    title: str
    text: str
    command: str
    tables: Sequence[Table] = ()
    picture: Path | None = None

    def html(self) -> str:
        image = ""
        if self.picture is not None:
            code = base64.b64encode(self.picture.read_bytes()).decode()
            image = f"<img alt='{self.picture.stem}' src='data:image/png;base64,{code}'>"
        return (
            f"<section id='{self.name}'><h2>{html.escape(self.title)}</h2><p>{html.escape(self.text)}</p>{image}"
            f"{''.join(table.html() for table in self.tables)}"
            f"<p class='command'><code>{html.escape(self.command)}</code></p></section>"
        )


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
body { font: 16px/1.5 system-ui, sans-serif; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; color: #111; }
img { max-width: 100%; } table { border-collapse: collapse; font-size: 0.85rem; margin: 1rem 0; }
th, td { border: 1px solid #999; padding: 0.25rem 0.6rem; text-align: left; } th { background: #eee; }
.command { color: #444; } code { font-size: 0.85rem; } nav a { margin-right: 1rem; }
"""


def page(sections: Sequence[Section]) -> str:
    links = "".join(f"<a href='#{section.name}'>{html.escape(section.title)}</a>" for section in sections)
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>tactile-depth: report</title>"
        f"<style>{STYLE}</style></head><body><h1>tactile-depth: what it achieves</h1><nav>{links}</nav>"
        f"{''.join(section.html() for section in sections)}</body></html>"
    )
