# SPDX-License-Identifier: Apache-2.0
"""What a dataclass declares beside the type of a field, in `Annotated`."""

from collections.abc import Mapping
from functools import cache
from typing import TypeVar, get_type_hints

Extra = TypeVar("Extra")


@cache
def declared(kind: type, of: type[Extra]) -> Mapping[str, Extra]:
    """Return the extras of the class `of` that a dataclass declares, by field, in their order."""
    hints = get_type_hints(kind, include_extras=True)
    stated = {name: getattr(hint, "__metadata__", ()) for name, hint in hints.items()}
    return {name: each for name, extras in stated.items() for each in extras if isinstance(each, of)}
