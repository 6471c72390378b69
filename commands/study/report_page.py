# SPDX-License-Identifier: Apache-2.0
"""HTML page of make report: figures with text and command, tables, style."""

import base64
import html
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

from commands.common.repository import ROOT

matplotlib.use("Agg")
from matplotlib import pyplot as plt

DOCUMENTS = {"synth": "resources.json", "fpga": "fpga.json", "asic": "asic.json"}  # by flow

LOOKS: dict[str, dict[str, Any]] = {
    "spectral": {"color": "#08306b", "marker": "o", "linestyle": "-"},
    "tridiagonal": {"color": "#e6550d", "marker": "s", "linestyle": "--"},
}

PUBLISHED_LOOK: dict[str, Any] = {"color": "black", "marker": "*", "markersize": 13, "linestyle": "none"}
PUBLISHED_LOOK["label"] = "published"


@dataclass(frozen=True)
class Figure:
    """Picture or table of the page."""

    name: str
    title: str
    text: str
    command: str
    content: str  # HTML

    def section(self) -> str:
        return (
            f"<section id='{self.name}'><h2>{html.escape(self.title)}</h2><p>{html.escape(self.text)}</p>"
            f"{self.content}<p class='command'><code>{html.escape(self.command)}</code></p></section>"
        )


def picture(figure: Any, folder: Path, name: str) -> str:
    """Save a figure as PNG; return the HTML that shows it."""
    path = folder / f"{name}.png"
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return shown(path)


def shown(path: Path) -> str:
    """Return HTML that shows a PNG."""
    return f"<img alt='{path.stem}' src='data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}'>"


def results(flow: str, build: Path = ROOT / "build") -> list[dict[str, Any]]:
    """Return the documents that a flow left below a folder, for any configuration, the latest last."""
    paths = sorted(build.glob(f"{flow}/*/{DOCUMENTS[flow]}"), key=lambda path: path.stat().st_mtime)
    return [json.loads(path.read_text()) for path in paths]


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def line(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    return f"<table>{line(head, 'th')}{''.join(line(row, 'td') for row in rows)}</table>"


def titled(tables: Sequence[tuple[str, Sequence[str], Sequence[Sequence[str]]]]) -> str:
    return "".join(f"<h3>{html.escape(title)}</h3>{table(head, rows)}" for title, head, rows in tables)


STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; color: #111; }
img { max-width: 100%; } table { border-collapse: collapse; font-size: 0.85rem; margin: 1rem 0; }
th, td { border: 1px solid #999; padding: 0.25rem 0.6rem; text-align: left; } th { background: #eee; }
.command { color: #444; } code { font-size: 0.85rem; } nav a { margin-right: 1rem; }
"""


def page(figures: Sequence[Figure]) -> str:
    links = "".join(f"<a href='#{figure.name}'>{html.escape(figure.title)}</a>" for figure in figures)
    sections = "".join(figure.section() for figure in figures)
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>tactile-depth: report</title>"
        f"<style>{STYLE}</style></head><body><h1>tactile-depth: what it achieves</h1><nav>{links}</nav>{sections}"
        "</body></html>"
    )
