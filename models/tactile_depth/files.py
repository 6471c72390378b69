# SPDX-License-Identifier: Apache-2.0
"""Writes files so that a folder holds all of them or, after a failure, its earlier files."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tactile_depth.errors import InputError


@contextmanager
def new_files(folder: Path, index: str, key: str = "tables") -> Iterator[Path]:
    """Provide an empty folder to write into; move its files into `folder` if the block ends without an error.

    Parameters
    ----------
    index : str
        Name of a JSON file that lists, under `key`, the files of an earlier run. Files that are not written again are
        removed, so that a folder never mixes two runs.
    key : str
        Key of the list in the JSON file.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    unfinished = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=folder))
        yield unfinished
        written = {path.name for path in unfinished.iterdir()}
        for name in _earlier(folder / index, key) - written:
            (folder / name).unlink(missing_ok=True)
        for name in sorted(written):
            os.replace(unfinished / name, folder / name)
    except OSError as error:
        raise InputError(f"{folder} cannot be written ({error.strerror}): give a folder that can") from error
    finally:
        if unfinished is not None:
            shutil.rmtree(unfinished, ignore_errors=True)


def _earlier(index: Path, key: str) -> set[str]:
    try:
        names = json.loads(index.read_text())[key]
    except (OSError, ValueError, KeyError, TypeError):
        return set()
    return {name for name in names if isinstance(name, str) and name == Path(name).name}
