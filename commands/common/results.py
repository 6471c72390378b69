# SPDX-License-Identifier: Apache-2.0
"""The folder of results that OUT names: refused in one line when it cannot be used, filled as a whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tactile_depth.errors import InputError

# Failures of the machine; all others are due to the path.
OF_THE_MACHINE = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EMFILE, errno.ENFILE, errno.ENOMEM)


def make(out: Path, files: Iterable[str] = ()) -> list[Path]:
    """Make the folder `out` and check that `files` can be written there.

    Returns
    -------
    folders that were missing, innermost first

    Raises
    ------
    InputError
        It is no folder, it cannot be written, or one of `files` is a folder.
    OSError
        The machine failed, with a full disk for example.
    """
    try:
        if out.is_symlink() and not out.exists():
            raise InputError(f"OUT={out} is a link to {os.readlink(out)}, which does not exist: give a folder")
        if out.exists() and not out.is_dir():
            raise InputError(f"OUT={out} is a file: give a folder")
        missing = [folder for folder in (out, *out.parents) if not folder.exists()]
        out.mkdir(parents=True, exist_ok=True)
        for name in files:
            if (out / name).is_dir():
                raise InputError(f"OUT={out} cannot be written ({name} in it is a folder): remove it or give another")
        with tempfile.TemporaryFile(dir=out):
            return missing
    except InputError:
        raise
    except (OSError, ValueError) as error:
        if isinstance(error, OSError) and error.errno in OF_THE_MACHINE:
            raise
        reason = error.strerror if isinstance(error, OSError) else "a character that no path can hold"
        raise InputError(f"OUT={out} cannot be written ({reason}): give a folder that can") from error


@contextmanager
def workspace(out: Path, files: Iterable[str] = ()) -> Iterator[Path]:
    """Make `out` and yield an empty folder inside it, which is removed at the end, however that comes about.

    Folders that were missing are removed too when they stay empty.

    Raises
    ------
    InputError, OSError
        As `make` does.
    """
    missing = make(out, files)
    work = None
    try:
        work = Path(tempfile.mkdtemp(prefix=".work-", dir=out)).resolve()
        yield work
    finally:
        if work is not None:
            shutil.rmtree(work, ignore_errors=True)
        for folder in missing:
            with contextlib.suppress(OSError):
                folder.rmdir()


def replace(work: Path, names: Iterable[str], out: Path, obsolete: Iterable[str] = ()) -> None:
    """Move files from `work`, a folder inside `out`, to `out`, and remove `obsolete` ones there: all of it or nothing.

    When a move fails, or a signal comes, the files that were there before come back.

    Raises
    ------
    OSError
    """
    fresh = list(names)
    earlier = Path(tempfile.mkdtemp(prefix="earlier-", dir=work))
    moves = [(out / name, earlier / name) for name in {*fresh, *obsolete} if os.path.lexists(out / name)]
    moves += [(work / name, out / name) for name in fresh]
    done: list[tuple[Path, Path]] = []
    try:
        for move in moves:
            done.append(move)
            os.replace(*move)
    except BaseException:
        for source, target in reversed(done):
            if not os.path.lexists(source):
                os.rename(target, source)
        raise
