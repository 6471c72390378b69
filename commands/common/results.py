# SPDX-License-Identifier: Apache-2.0
"""Result files of a command: documents as JSON, and a folder that gets all of its files or none."""

import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tactile_depth.base import files


def save(path: Path, document: Any) -> None:
    """Write a document as JSON."""
    path.write_text(json.dumps(document, indent=1) + "\n")


@contextmanager
def written(out: Path, names: Sequence[str]) -> Iterator[Path]:
    """Yield an empty folder for files of these names, move them into `out` at the end, and print where they are.

    Raises InputError or OSError, as `files.workspace` does.
    """
    with files.workspace(out, names) as work:
        yield work
        files.replace(work, names, out)
    print(f"results: {os.path.relpath(out)}")
