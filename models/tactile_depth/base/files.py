# SPDX-License-Identifier: Apache-2.0
"""Writes files so that a folder holds all of them or, after a failure or a signal, its earlier files.

Files of others stay. `replace` keeps in each folder the digests of the files that it wrote there, in `RECORD`, and
refuses to write in place of any other file, or of one that was changed since. Below a folder with a `CACHEDIR.TAG`
(https://bford.info/cachedir), such as build/ of a clone, everything is made and may be replaced; no record is kept.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import secrets
import shutil
import tempfile
import threading
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from tactile_depth.base import interruption
from tactile_depth.base.errors import Argument, InputError

# Failures of the machine; all others are due to the path.
OF_THE_MACHINE = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EMFILE, errno.ENFILE, errno.ENOMEM)
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
SHORT_WRITE = " requested and "  # of numpy, whose error has no number: "4096 requested and 512 written"
RECORD = ".tactile-depth.json"  # digests of the files that were written into its folder, by name
CACHE_TAG = "CACHEDIR.TAG"
CACHE_SIGNATURE = "Signature: 8a477f597d28d172789f06886806bc55"  # first line of such a file


@contextmanager
def workspace(
    folder: Path,
    files: Iterable[str] = (),
    path: str = "",
    keep: type[BaseException] | tuple[type[BaseException], ...] = (),
    *,
    guarded: bool = True,
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
    guarded : bool
        Refuse files of others, as `replace` does.

    Raises
    ------
    InputError
        It is no folder, it cannot be written, or one of `files` is a folder or a file of others.
    OSError
        The machine failed, with a full disk for example.
    """
    missing = [part for part in (folder, *folder.parents) if not os.path.lexists(part)]
    work = Path.cwd() / folder / f".work-{secrets.token_hex(8)}"
    stays = False
    try:
        _create(folder, work, tuple(files), path, guarded)
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


def _create(folder: Path, work: Path, names: Iterable[str], path: str, guarded: bool) -> None:
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
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                os.lstat(folder / name)  # refuses a name that no file can have
        with locked(folder):
            _refuse(folder, names, path, guarded)
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


def make(folder: Path, files: Iterable[str] = (), *, guarded: bool = True) -> None:
    """Make a folder in which `files` can be written; raise what `workspace` raises."""
    with workspace(folder, files, guarded=guarded):
        pass
    folder.mkdir(parents=True, exist_ok=True)


def own_files(folder: Path, names: Iterable[str]) -> set[str]:
    """Return those of the names under which `folder` has a file as it was written, by the record there."""
    there = [name for name in names if (folder / name).is_file()]
    if _is_cache(folder):
        return set(there)
    record = _record(folder)
    return {name for name in there if record.get(name) == _digest(folder / name)}


def recorded(folder: Path) -> set[str]:
    """Return the names of the files that `replace` wrote into a folder, by the record there."""
    return set(_record(folder))


def _is_cache(folder: Path) -> bool:
    place = folder.resolve()
    return any((each / CACHE_TAG).is_file() for each in (place, *place.parents))


def _record(folder: Path) -> dict[str, str]:
    try:
        digests = json.loads((folder / RECORD).read_text())
    except (OSError, ValueError):
        return {}
    return digests if isinstance(digests, dict) else {}


def _digest(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while part := file.read(1 << 20):
            digest.update(part)
    return digest.hexdigest()


def _refuse(folder: Path, names: Iterable[str], path: str = "", guarded: bool = True) -> None:
    """Raise InputError if one of the names, to be written, is that of a folder or, if guarded, of a file of others."""
    given, there = Argument("folder", path or folder), [name for name in names if os.path.lexists(folder / name)]
    own = own_files(folder, there) if guarded else set(there)
    for name in there:
        if (folder / name).is_dir():
            problem = f" cannot be written ({name}{'' if path else ' in it'} is a folder)"
            raise InputError(given, problem, remedy="remove it or give another")
        if name not in own:
            problem = f": {name} is there and was not written by an earlier run, or was changed since"
            raise InputError(given, problem, remedy="move it away or give another name")


def replace(
    work: Path, names: Iterable[str], folder: Path, obsolete: Iterable[str] = (), *, guarded: bool = True
) -> None:
    """Move files from `work`, which lies inside `folder`, to `folder`, and remove `obsolete` files there.

    When a move fails, or a signal comes, the files that were there before come back. Folders stay, and so do files
    that an earlier run did not write, or that were changed since. Another process that replaces files there waits.

    Parameters
    ----------
    guarded : bool
        Refuse to replace files of others, and record what is written. False where the user names the very file.

    Raises
    ------
    InputError
        A folder, or a file of others, has the name of a file.
    OSError
    """
    with locked(folder):
        _replace(work, list(names), folder, obsolete, guarded)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Let others who change files of a folder wait, on systems that can; who holds it may enter again."""
    try:
        import fcntl
    except ImportError:  # Windows
        fcntl = None  # type: ignore[assignment]
    held: set[Path] = vars(_HELD).setdefault("folders", set())
    place = folder.resolve()
    if fcntl is None or place in held:
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):  # a file system without locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        held.add(place)
        yield
    finally:
        held.discard(place)
        os.close(descriptor)


_HELD = threading.local()  # folders that this thread has locked


def _replace(work: Path, fresh: list[str], folder: Path, obsolete: Iterable[str], guarded: bool) -> None:
    _refuse(folder, fresh, guarded=guarded)
    obsolete = own_files(folder, obsolete)
    if guarded and not _is_cache(folder):
        record = {name: digest for name, digest in _record(folder).items() if name not in obsolete}
        record |= {name: _digest(work / name) for name in fresh}
        (work / RECORD).write_text(json.dumps(record, indent=1) + "\n")
        fresh.append(RECORD)
    if len(fresh) == 1 and not obsolete:
        os.replace(work / fresh[0], folder / fresh[0])  # at no time is there no file
        return
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
        with locked(folder):
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
