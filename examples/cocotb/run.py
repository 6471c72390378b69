# SPDX-License-Identifier: Apache-2.0
"""Build the pipeline for a small grid and run depth_map.py on a simulator: `run.py verilator` or `run.py icarus`."""

import json
import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "models"), str(HERE)]

from commands.common import repository, simulator, wrapper  # noqa: E402
from tactile_depth.chip.configuration import Configuration  # noqa: E402
from tactile_depth.chip.tactile_depth import top_parameters, write_roms  # noqa: E402
from tactile_depth.sensor.synthetic import synthetic  # noqa: E402

CHOICES: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal", "bits_per_channel": 2}


def main() -> None:
    name = sys.argv[1] if len(sys.argv) > 1 else "verilator"
    config = Configuration(**CHOICES)
    folder = ROOT / "build" / "examples" / name
    module = wrapper.write(folder, "example", top_parameters(config))  # the module that a design would instantiate
    write_roms(folder, synthetic(config.bits_per_channel), config)
    simulator.build(name, module.stem, [*repository.sources(), module], {}, folder, log=folder / "build.log")
    environment = {"CONFIGURATION": json.dumps(CHOICES), "PYTHONPATH": f"{ROOT / 'models'}:{HERE}"}
    tests, failed = simulator.run(
        module.stem,
        "depth_map",
        folder,
        folder,
        simulator=name,
        seed=1,
        environment=environment,
        log=folder / "run.log",
    )
    print(f"{name}: {tests - failed} of {tests} tests passed, see {folder.relative_to(ROOT) / 'run.log'}")
    sys.exit(bool(failed) or not tests)


if __name__ == "__main__":
    main()
