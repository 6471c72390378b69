# SPDX-License-Identifier: Apache-2.0
"""The generator of tactile_depth.core: a configuration as a core of FuseSoC.

Its parameters are those of `make wrap`, NAME and the variables that choose a configuration and a camera. The core holds
the module tactile_depth_<NAME>, or tactile_sensor_<NAME> with a camera, which a design instantiates, and its tables in
a folder <NAME>. It needs numpy, scipy, Pillow and yaml.
"""

import sys
import warnings
from pathlib import Path

NAME = "tables of tactile_depth"
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "models")]  # FuseSoC runs it by its path

try:
    import yaml

    from commands.common import run_request, variables
    from commands.hardware import wrapped
    from tactile_depth.base.errors import InputError
    from tactile_depth.chip.rom_files import table_files
except ImportError as error:
    sys.exit(f"{NAME}: {error} ({sys.executable}): run `make setup`, put {ROOT}/.venv/bin on PATH")

PATHS = ("CALIBRATION", "REFERENCE", "ZERO", "CONFIG")  # relative ones count from the folder of the core that calls it


def generate(description: Path, folder: Path) -> None:
    """Write the module, its tables and a core that holds both into a folder. Raises InputError."""
    wanted = yaml.safe_load(description.read_text())
    values = dict(wanted.get("parameters") or {})
    module, root = str(values.pop("NAME", "")), Path(wanted.get("files_root", "")).resolve()
    wrapped.check_name(module)
    for key, value in values.items():
        if key not in wrapped.CHOICES:
            raise InputError(f"{key}: unknown variable: accepted are NAME, {', '.join(wrapped.CHOICES)}")
        if value is None:
            raise InputError(f"{key}: it has no value: omit it")
        beside = root / str(value)
        if key in PATHS and beside.exists():
            values[key] = beside
        elif key in PATHS and beside.suffix:  # names of calibrations and scenes have none
            raise InputError(f"{key}={value}: there is no such file: relative paths count from {root}")
    words = [f"{key}={value}" for key, value in values.items()]
    request = run_request.parse(words, wrapped.CHOICES, wrapped.PRESET, frames="")
    (path,) = wrapped.write(request, folder, module, f"{module}/").modules
    tables = table_files(folder)
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
    warnings.showwarning = variables.show_warning(NAME)
    try:
        generate(Path(sys.argv[1]), Path.cwd())
    except InputError as error:
        print(f"{NAME}: {error.text(variables.named)}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
