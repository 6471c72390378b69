# SPDX-License-Identifier: Apache-2.0
"""Description for a package index: README.md with absolute links. Everything else is in pyproject.toml."""

import re
from pathlib import Path

from setuptools import setup

ROOT = Path(__file__).parent
(ADDRESS,) = re.findall(r'^Repository = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)


def absolute(link: re.Match[str]) -> str:
    """Return a link or a picture with the address of its file in the repository."""
    return f"{link[1]}({ADDRESS}/{'raw' if link[1].startswith('!') else 'blob'}/main/{link[2]})"


setup(
    long_description=re.sub(r"(!?\[[^]]*\])\((?!https?:)([^)]+)\)", absolute, (ROOT / "README.md").read_text()),
    long_description_content_type="text/markdown",
)
