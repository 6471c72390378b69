# SPDX-License-Identifier: Apache-2.0
"""The generator of tactile_depth.core: a configuration as a core of FuseSoC.

Its parameters are NAME and the variables of `make sim` that choose a configuration; commands/common/run_request.py
names them. The core holds the module tactile_depth_<NAME>, which a design instantiates, and its tables in a folder
<NAME>.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "models")]  # FuseSoC runs it by its path

try:
    import yaml

    from commands.common import run_request, variables, wrapper
    from commands.common.zero_offset import untouched
    from commands.hardware import synthesis
    from tactile_depth.base.errors import InputError
    from tactile_depth.chip.tactile_depth import top_parameters, write_roms
    from tactile_depth.depth.twin import Twin
except ImportError as error:
    sys.exit(f"tables of tactile_depth: {error} ({sys.executable}): run `make setup`, put {ROOT}/.venv/bin on PATH")


def generate(description: Path, folder: Path) -> None:
    """Write the module, its tables and a core that holds both into a folder. Raises InputError."""
    wanted = yaml.safe_load(description.read_text())
    values = dict(wanted.get("parameters") or {})
    module = str(values.pop("NAME", ""))
    if not wrapper.NAME.fullmatch(module):
        raise InputError(f"NAME={module}: {wrapper.NAMES}")
    for key in values:
        if key not in run_request.CONFIGURING:
            raise InputError(f"{key}: unknown variable: accepted are NAME, {', '.join(run_request.CONFIGURING)}")
    request = run_request.parse([f"{key}={value}" for key, value in values.items()], preset="sensor", frames="")
    frames, calibration, config = synthesis.design(request)
    write_roms(folder, calibration, config, Twin(calibration, config, untouched(request, frames)).zero)
    tables = [rom.name for rom in sorted(folder.glob("*.hex"))]
    path = wrapper.write(folder, module, top_parameters(config, calibration.pixel_pitch_mm), f"{module}/")
    core = {
        "name": wanted["vlnv"],
        "filesets": {
            "tables": {"files": [{name: {"copyto": f"{module}/{name}"}} for name in tables], "file_type": "user"},
            "module": {"files": [path.name], "file_type": "systemVerilogSource"},
        },
        "targets": {"default": {"filesets": ["tables", "module"]}},
    }
    name = wanted["vlnv"].split(":")[2]
    (folder / f"{name}.core").write_text("CAPI=2:\n" + yaml.safe_dump(core, sort_keys=False))


def main() -> None:
    """Run the generator with the arguments that FuseSoC gives."""
    try:
        generate(Path(sys.argv[1]), Path.cwd())
    except InputError as error:
        print(f"tables of tactile_depth: {error.text(variables.named)}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
