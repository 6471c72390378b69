# SPDX-License-Identifier: Apache-2.0
"""Compare depth of one wheel in several Pythons, each with the oldest and the newest numpy that has a wheel for it.

    python .ci/pythons.py dist/*.whl python3.10 python3.11 python3.12 python3.13

Codes must be equal, heights within 1e-9 mm; the exit status is 1 if they are not. It takes a minute for each Python.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

OLDEST = {  # the oldest that pyproject.toml allows and that have wheels
    "3.10": ("numpy==1.24.0", "scipy==1.10.0", "Pillow==10.1.0"),
    "3.11": ("numpy==1.24.0", "scipy==1.10.0", "Pillow==10.1.0"),
    "3.12": ("numpy==1.26.0", "scipy==1.11.2", "Pillow==10.1.0"),
    "3.13": ("numpy==2.1.0", "scipy==1.14.1", "Pillow==11.0.0"),
}
TOLERANCE_MM = 1e-9
DEPTH = """
import hashlib, json, platform, sys
import numpy, scipy
import tactile_depth as td

digest, heights = hashlib.sha256(), []
for name in td.samples():
    sample = td.sample(name)
    for arithmetic in ("chip", "float"):
        result = td.Pipeline(sample.sensor, reference=sample.reference, arithmetic=arithmetic)(sample.image)
        if arithmetic == "chip":
            digest.update(numpy.ascontiguousarray(result.codes, dtype="<i8").tobytes())
        heights += result.height_mm.ravel()[::7].tolist()
with open(sys.argv[1], "w") as file:
    json.dump({"codes": digest.hexdigest(), "heights": heights}, file)
print(f"Python {platform.python_version()}, numpy {numpy.__version__}, scipy {scipy.__version__}", end=": ")
print(f"{len(td.samples())} pictures, tactile-depth {td.__version__}")
"""


def depth(python: str, wheel: str, pins: tuple[str, ...], folder: Path) -> dict:
    """Return codes, as a digest, and heights of a wheel in a new environment of a Python."""
    own = folder / "environment" / "bin" / "python"
    subprocess.run([python, "-m", "venv", "--clear", own.parent.parent], check=True)
    install = [own, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary=:all:"]
    subprocess.run([*install, wheel, *pins], check=True)
    subprocess.run([own, "-I", "-c", DEPTH, folder / "depth.json"], check=True)
    return json.loads((folder / "depth.json").read_text())


def main(wheel: str, *pythons: str) -> int:
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for python in pythons:
            ask = "import sys; print('%d.%d' % sys.version_info[:2])"
            version = subprocess.run([python, "-c", ask], check=True, capture_output=True, text=True).stdout.strip()
            results += [depth(python, wheel, pins, Path(folder)) for pins in (OLDEST[version], ())]
    first = results[0]["heights"]
    codes = len({result["codes"] for result in results})
    error = max(abs(a - b) for result in results for a, b in zip(result["heights"], first, strict=True))
    print(f"{len(results)} environments: {codes} set(s) of codes, heights differ by at most {error:.1e} mm")
    return int(codes > 1 or error > TOLERANCE_MM)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
