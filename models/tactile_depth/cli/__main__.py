# SPDX-License-Identifier: Apache-2.0
"""`python -m tactile_depth.cli`: the command `tactile-depth` where it is not on the path."""

import sys

from tactile_depth.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
