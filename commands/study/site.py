# SPDX-License-Identifier: Apache-2.0
"""`make site`: write the pages of docs/ and a reference of the Python API as HTML into build/site.

mkdocs.yml has the order of the pages; site_pages.py has what mkdocs does not: links into the repository.
"""

import os
import subprocess
import sys
from pathlib import Path

from commands.common.repository import ROOT
from commands.common.variables import Mismatch

SITE = ROOT / "build" / "site"


def build(folder: Path) -> None:
    """Write the site into a folder. Raises Mismatch: a page, a link or an anchor is missing."""
    words = ("-m", "mkdocs", "build", "--strict", "--site-dir", str(folder))
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}  # a notice of the theme about itself
    run = subprocess.run(
        [sys.executable, *words], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    if run.returncode:
        lines = run.stderr.splitlines()
        findings = [line.partition("-")[2].strip() for line in lines if line.startswith(("WARNING", "ERROR"))]
        raise Mismatch("; ".join(findings or lines[-1:]))


def main() -> None:
    build(SITE)
    print(f"open {SITE.relative_to(ROOT) / 'index.html'}")
