# SPDX-License-Identifier: Apache-2.0
"""Declarations of a dataclass beside the type of a field, in `Annotated`."""

from collections.abc import Mapping
from functools import cache
from typing import Any, get_type_hints


@cache
def declared(kind: type, of: type) -> Mapping[str, Any]:
    """Return the extras of the class `of` that a dataclass declares, by field, in their order."""
    hints = get_type_hints(kind, include_extras=True).items()
    return {name: each for name, hint in hints for each in getattr(hint, "__metadata__", ()) if isinstance(each, of)}
