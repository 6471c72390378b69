# SPDX-License-Identifier: Apache-2.0
"""Records of tests for the table of `make regress`."""

import json
import os
from pathlib import Path
from typing import Any


def record(**figures: Any) -> None:
    """Append a line to the file that RECORDS names, if it is set."""
    if "RECORDS" in os.environ:
        with Path(os.environ["RECORDS"]).open("a") as file:
            file.write(json.dumps(figures) + "\n")
