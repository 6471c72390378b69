# SPDX-License-Identifier: Apache-2.0
"""Pictures as users have them: arrays, PIL images, paths, and sequences of these."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from tactile_depth.base.errors import Argument, InputError, Part
from tactile_depth.pictures.frames import read_pictures

RGB = "RGB"  # mode of a PIL image
SHAPES = "uint8 (rows, columns, 3), RGB, or (frames, rows, columns, 3)"


class HasArray(Protocol):
    """Object that numpy takes as an array."""

    def __array__(self) -> Any: ...


class HasInterface(Protocol):
    """Object that numpy takes as an array, such as a PIL image."""

    @property
    def __array_interface__(self) -> dict[str, Any]: ...


def is_array(value: object) -> bool:
    """Return True if numpy takes an object as an array, or would if its file were whole."""
    return hasattr(type(value), "__array__") or hasattr(type(value), "__array_interface__")


def array_of(given: object, name: Part) -> np.ndarray:
    """Return what numpy takes as an array; refuse a PIL image whose channels are not red, green and blue."""
    mode = RGB if isinstance(given, np.ndarray) else getattr(given, "mode", RGB)  # a memory map has one of its own
    if isinstance(mode, str) and mode != RGB:
        raise InputError(name, f": a PIL image of mode {mode}", accepted=RGB, remedy='give it after .convert("RGB")')
    if isinstance(given, np.ma.MaskedArray):
        raise InputError(name, ": a masked array, whose mask would be lost", remedy="give it after .filled(..)")
    if getattr(given, "n_frames", 1) != 1:
        raise InputError(name, ": a PIL image of several frames", remedy="give each by itself")
    try:
        return np.asarray(given)
    except Exception as error:  # PIL raises many kinds of errors for a damaged or closed file
        raise InputError(name, f": not a readable picture ({error})", remedy="give an intact one") from error


ROTATIONS = (0, 90, 180, 270)  # degrees, counter-clockwise


def rotated(pictures: np.ndarray, degrees: int) -> np.ndarray:
    """Return pictures (.., rows, columns, 3), rotated counter-clockwise by one of `ROTATIONS`."""
    return np.ascontiguousarray(np.rot90(pictures, degrees // 90, axes=(-3, -2)))


Picture = np.ndarray | HasArray | HasInterface | str | Path
Pictures = Picture | Sequence[Picture]


def pictures_of(given: Pictures, name: Part) -> tuple[Iterator[tuple[Part, np.ndarray]], bool]:
    """Return pictures, uint8 (rows, columns, 3), each with its name in errors, and True for a single picture.

    Those of a folder are read one by one when the iterator reaches them.
    """
    if isinstance(given, str | Path):
        labels, read = read_pictures(given)
        single = Path(given).is_file() and labels == (Path(given).name,)
        named = (
            (str(given) if single else f"{given}: {each}", image) for each, image in zip(labels, read, strict=True)
        )
        return named, single
    if is_array(given):
        array = array_of(given, name)
        if array.dtype != np.uint8 or array.ndim not in (3, 4) or array.shape[-1] != 3 or not array.size:
            raise InputError(name, f" are {array.dtype} {array.shape}", accepted=SHAPES)
        if array.ndim == 3:
            return iter([(name, array)]), True
        return ((_item(name, index), picture) for index, picture in enumerate(array)), False
    if not isinstance(given, Sequence):
        remedy = "give them to `stream`" if isinstance(given, Iterable) and str(name) == "pictures" else ""
        accepted = "a uint8 array or a path, or a sequence of them"
        raise InputError(name, f" are {type(given).__name__}", accepted=accepted, remedy=remedy)
    if not given:
        raise InputError(name, " are empty", accepted="one picture or more")
    return _of_sequence(given, name), False


def each_of(given: Pictures | Iterable[Any]) -> Iterator[Any]:
    """Give the pictures of a stream one by one, those of a folder by their paths: each is read in its turn."""
    if isinstance(given, str | Path):
        labels, pictures = read_pictures(given)
        return (Path(given, label) for label in labels) if Path(given).is_dir() else iter(pictures)
    if is_array(given) and np.ndim(np.asarray(given)) != 4:
        return iter([given])
    try:
        return iter(given)  # type: ignore[arg-type]
    except TypeError:
        accepted = "a path, or an iterable of pictures"
        remedy = "give its frames by a generator, in RGB"
        raise InputError("pictures", f" are a {type(given).__name__}", accepted=accepted, remedy=remedy) from None


def _item(name: Part, index: int) -> Part:
    return Argument(f"{name.name}[{index}]") if isinstance(name, Argument) else f"{name}[{index}]"


def _of_sequence(given: Sequence[Picture], name: Part) -> Iterator[tuple[Part, np.ndarray]]:
    for index, one in enumerate(given):
        item = _item(name, index)
        pictures, single = pictures_of(one, item)
        if not single:
            raise InputError(item, " are several pictures", accepted="one picture, uint8 (rows, columns, 3) or a path")
        yield from pictures
