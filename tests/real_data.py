# SPDX-License-Identifier: Apache-2.0
"""Real presses: `gelslam/` in the folder that TACTILE_DATA names, or in ../shared/data."""

import os
from pathlib import Path

import pytest

from commands.common.repository import ROOT

FOLDER = Path(os.environ.get("TACTILE_DATA") or ROOT.parent / "shared" / "data")
PRESENT = (FOLDER / "gelslam" / "presses.csv").is_file()
needs_real_data = pytest.mark.skipif(not PRESENT, reason="TACTILE_DATA names no folder with gelslam/")
