# SPDX-License-Identifier: Apache-2.0
"""Ball presses that tests of calibrations share and none changes."""

from pathlib import Path

import pytest

from tactile_depth.calibrate.presses import GridPresses
from tests.ball_presses import read, write_folder


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of all drawn presses."""
    return write_folder(tmp_path_factory.mktemp("ball") / "presses")


@pytest.fixture(scope="session")
def presses(folder: Path) -> GridPresses:
    return read(folder)
