# SPDX-License-Identifier: Apache-2.0
"""Hooks of mkdocs.yml: links from pages into the repository, anchors as GitHub has them, and the page of the API."""

import ast
import re
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
BRANCH = "main"
LINK = re.compile(r"(\]\()(\.\./[^)\s#]+)(#[^)\s]*)?(\))")
API = "api.md"
WORKER = "assets/iframe-worker.js"  # by this name the theme knows it, and takes none from elsewhere
API_HEAD = """# Reference of the Python API

[python.md](python.md) explains what is used together. Here is each public name of the package, from its docstring.

"""


def slug(heading: str, separator: str) -> str:
    """Return the anchor of a heading as GitHub makes it, so that a link works in both places."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", separator)


def public_names(package: Path) -> list[str]:
    """Return the names of `__all__` of a package, without importing it."""
    for statement in ast.parse(package.read_text()).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "__all__":
            names: list[str] = ast.literal_eval(statement.value)
            return names
    raise ValueError(f"{package} has no __all__")


def in_repository(page: Path, link: str, repository: str) -> str:
    """Return the address of what a link of a page names, if it is outside docs/; otherwise the link."""
    path = (page.parent / link).resolve()
    if path.is_relative_to(ROOT / "docs") or not path.exists():
        return link
    kind = "tree" if path.is_dir() else "blob"
    return f"{repository}/{kind}/{BRANCH}/{path.relative_to(ROOT)}"


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    config.mdx_configs.setdefault("toc", {})["slugify"] = slug
    config.theme.static_templates.discard("404.html")  # only a server shows it
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    names = public_names(ROOT / "models" / "tactile_depth" / "__init__.py")
    text = API_HEAD + "\n".join(f"::: tactile_depth.{name}\n" for name in names)
    files.append(File.generated(config, API, content=text))
    files.append(File.generated(config, WORKER, abs_src_path=str(Path(__file__).with_name("site_worker.js"))))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    if page.file.abs_src_path is None:
        return markdown
    file, repository = Path(page.file.abs_src_path), config.extra["repository"]

    def absolute(found: re.Match[str]) -> Any:
        return f"{found[1]}{in_repository(file, found[2], repository)}{found[3] or ''}{found[4]}"

    return LINK.sub(absolute, markdown)
