# SPDX-License-Identifier: Apache-2.0
"""Writes files so that a folder holds all of them or, after a failure or a signal, its earlier files."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import secrets
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from tactile_depth.base import interruption
from tactile_depth.base.errors import Argument, InputError

# Failures of the machine; all others are due to the path.
OF_THE_MACHINE = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EMFILE, errno.ENFILE, errno.ENOMEM)
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
SHORT_WRITE = " requested and "  # of numpy, whose error has no number: "4096 requested and 512 written"


@contextmanager
def workspace(
    folder: Path,
    files: Iterable[str] = (),
    path: str = "",
    keep: type[BaseException] | tuple[type[BaseException], ...] = (),
) -> Iterator[Path]:
    """Make a folder and yield an empty one inside it, which is removed at the end, however that comes about.

    Folders that were missing are removed too when they stay empty. All have their names before they exist, so that a
    signal at any time leaves none behind.

    Parameters
    ----------
    files : names of str
        Files that are to be written into `folder`.
    path : str
        Path that errors name, if the user gave another one than that of the folder.
    keep
        Exceptions after which the folders stay, unless a signal caused them.

    Raises
    ------
    InputError
        It is no folder, it cannot be written, or one of `files` is a folder.
    OSError
        The machine failed, with a full disk for example.
    """
    missing = [part for part in (folder, *folder.parents) if not os.path.lexists(part)]
    work = Path.cwd() / folder / f".work-{secrets.token_hex(8)}"
    stays = False
    try:
        _create(folder, work, tuple(files), path)
        yield work.resolve()
    except keep:
        stays = interruption.received() is None
        raise
    finally:
        if not stays:
            try:
                _remove(work, missing)
            finally:  # a signal may have cut the first time short, and rmtree ignores some exceptions of its handler
                _remove(work, missing)


def _create(folder: Path, work: Path, names: Iterable[str], path: str) -> None:
    """Make a folder and `work` inside it, as `workspace` says."""
    given = Argument("folder", path or str(folder))
    try:
        for part in (folder, *folder.parents):
            if part.is_symlink() and not part.exists():
                link = "" if str(part) == given.value else f": {part}"
                missing = f"{link} is a link to {os.readlink(part)}, which does not exist"
                raise InputError(given, missing, remedy="give a folder")
        if folder.exists() and not folder.is_dir():
            raise InputError(given, f"{f': {folder}' if path else ''} is a file", remedy="give a folder")
        folder.mkdir(parents=True, exist_ok=True)
        refuse_folders(folder, names, path)
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                os.lstat(folder / name)  # refuses a name that no file can have
        work.mkdir(mode=0o700)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        if isinstance(error, OSError) and error.errno in OF_THE_MACHINE:
            raise
        reason = error.strerror if isinstance(error, OSError) else "a character that no path can hold"
        raise InputError(given, f" cannot be written ({reason})", remedy="give a folder that can") from error


def _remove(work: Path, empty: Iterable[Path]) -> None:
    """Remove a folder with all that it holds, and others if they are empty."""
    with contextlib.suppress(OSError, ValueError):
        shutil.rmtree(work, ignore_errors=True)
    for folder in empty:
        with contextlib.suppress(OSError, ValueError):
            folder.rmdir()


def temporary(inside: Path | None = None) -> AbstractContextManager[Path]:
    """Provide an empty folder as `workspace` does, by default where the system has its temporary files."""
    return workspace(inside or Path(tempfile.gettempdir()))


def check(folder: Path, files: Iterable[str] = ()) -> None:
    """Raise what `workspace` raises, and leave no folder behind."""
    with workspace(folder, files):
        pass


def make(folder: Path, files: Iterable[str] = ()) -> None:
    """Make a folder in which `files` can be written; raise what `workspace` raises."""
    check(folder, files)
    folder.mkdir(parents=True, exist_ok=True)


def refuse_folders(folder: Path, files: Iterable[str], path: str = "") -> None:
    """Raise InputError if one of `files`, which are to be written, is a folder there: replacing it would lose it."""
    for name in files:
        if (folder / name).is_dir():
            problem = f" cannot be written ({name}{'' if path else ' in it'} is a folder)"
            raise InputError(Argument("folder", path or folder), problem, remedy="remove it or give another")


def replace(work: Path, names: Iterable[str], folder: Path, obsolete: Iterable[str] = ()) -> None:
    """Move files from `work`, which lies inside `folder`, to `folder`, and remove `obsolete` files there.

    When a move fails, or a signal comes, the files that were there before come back. Folders stay.

    Raises
    ------
    InputError
        A folder has the name of a file.
    OSError
    """
    fresh = list(names)
    refuse_folders(folder, fresh)
    obsolete = [name for name in obsolete if not (folder / name).is_dir()]
    earlier = Path(tempfile.mkdtemp(prefix="earlier-", dir=work))
    moves = [(folder / name, earlier / name) for name in {*fresh, *obsolete} if os.path.lexists(folder / name)]
    moves += [(work / name, folder / name) for name in fresh]
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


@contextmanager
def new_files(folder: Path, index: str, key: str = "tables") -> Iterator[Path]:
    """Provide an empty folder to write into; move its files into `folder` if the block ends without an error.

    Parameters
    ----------
    index, key : str
        As of `listed`. Files of an earlier run that are not written again are removed, so that a folder never mixes
        two runs.

    Raises
    ------
    InputError, OSError
        As `workspace` does.
    """
    with workspace(folder, (index,)) as work:
        yield work
        written = {path.name for path in work.iterdir()}
        replace(work, sorted(written), folder, listed(folder / index, key) - written)


def listed(index: Path, key: str) -> set[str]:
    """Return the names of files beside a JSON file that it lists under a key; none if it is missing or damaged."""
    try:
        names = json.loads(index.read_text())[key]
    except (OSError, ValueError, LookupError, TypeError):
        return set()
    if not isinstance(names, list):
        return set()
    return {name for name in names if isinstance(name, str) and name == Path(name).name}


def cause(error: OSError) -> str:
    """Return what failed: the file and the reason, and for a full disk what helps."""
    reason, file = error.strerror or str(error) or type(error).__name__, error.filename
    if SHORT_WRITE in reason:
        reason, file = "a file could not be written to its end", None
    elif error.errno not in FULL:
        return ": ".join(str(part) for part in (file, reason) if part)
    return ": ".join(str(part) for part in (file, reason, "free disk space, or give a folder on another disk") if part)
