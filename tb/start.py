# SPDX-License-Identifier: Apache-2.0
"""Start of a simulation: leaves out imports that take longer than the tests of most cores."""

import importlib
import os
import sys
from types import ModuleType, SimpleNamespace
from typing import Any

from pygpi import entry

ENTRY = {"PYGPI_USERS": "tb.start:begin"}
PYTEST = {  # what cocotb imports of it
    "pytest": ("raises", "skip", "xfail"),
    "_pytest.assertion": ("install_importhook",),
    "_pytest.config": ("Config",),
}


class AtFirstUse(ModuleType):
    """Module that is imported when something asks for a name in it."""

    def __getattr__(self, name: str) -> Any:
        if sys.modules[self.__name__] is self:
            del sys.modules[self.__name__]
            vars(self).update(vars(importlib.import_module(self.__name__)))
        return getattr(sys.modules[self.__name__], name)


def begin() -> None:
    """Start cocotb without pytest, which it asks only about failures of kinds that no bench uses; numpy waits."""
    for module, names in PYTEST.items():
        sys.modules[module] = ModuleType(module)
        for name in names:
            setattr(sys.modules[module], name, SimpleNamespace(Exception=type(name, (BaseException,), {})))
    sys.modules["numpy"] = AtFirstUse("numpy")
    for variable in ENTRY:
        del os.environ[variable]
    entry.load_entry()
