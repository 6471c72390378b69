# SPDX-License-Identifier: Apache-2.0
"""Package as users get it: the archive of sources, and its wheel, which gives the codes of the RTL."""

import email
import fcntl
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import textwrap
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomllib
from PIL import Image

import tactile_depth as td
from commands.common.repository import ROOT
from commands.run import bench
from tactile_depth.base.files import RECORD
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.chip.resampling import resampling
from tactile_depth.chip.rom_files import CRCS
from tactile_depth.chip.tactile_depth import hdl_parameters, top_parameters
from tactile_depth.pictures.frames import read_picture
from tests import real_data
from tests.drawn_light import no_contact

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
BESIDE_THE_PACKAGE = ("CHANGELOG.md", "CITATION.cff", "LICENSE", "PKG-INFO", "README.md", "pyproject.toml", "setup.py")
UNREACHABLE = ("NewConnectionError", "ConnectTimeoutError", "ReadTimeoutError", "NameResolutionError", "ProxyError")
DRAWN = """
    sample = td.sample("ball")
    sensor, reference, image = sample.sensor, sample.reference, sample.image
    """
REAL = """
    sensor, reference, image = td.load("gelsight-mini"), "background.png", "press.png"
    """
QUICK_START = """
    import numpy as np
    import tactile_depth as td
    {pictures}
    pipeline = td.Pipeline(sensor, reference)
    result = pipeline(image)
    assert (result.depth_mm == result.codes * pipeline.depth_lsb_mm).all()
    np.save("codes.npy", result.codes)
    np.save("gains.npy", result.light_gains)
    pipeline.hardware("hardware")
    """


def without_sources() -> dict[Any, Any]:
    """Return the environment of a user, without the modules of the repository on the path."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Return one folder for all workers, with a lock around objects that are made once."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "wheel"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


@pytest.fixture(scope="module")
def archive(folder: Path) -> Any:
    """Build the archive of sources from a copy of the repository, without what git ignores and without git."""
    if not list(folder.glob("*.tar.gz")):
        sources = folder / "sources"
        command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
        for name in {*listed.split("\0")} - {""}:
            if (ROOT / name).exists():
                (sources / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, sources / name)
        build = f"from setuptools import build_meta; build_meta.build_sdist({str(folder)!r})"
        subprocess.run([sys.executable, "-c", build], cwd=sources, check=True, capture_output=True)
    (path,) = folder.glob("*.tar.gz")
    return path


@pytest.fixture(scope="module")
def wheel(folder: Path, archive: Path) -> Any:
    """Build the wheel from the archive of sources."""
    if not list(folder.glob("*.whl")):
        shutil.unpack_archive(archive, folder / "unpacked")
        (sources,) = (folder / "unpacked").iterdir()
        build = f"from setuptools import build_meta; build_meta.build_wheel({str(folder)!r})"
        subprocess.run([sys.executable, "-c", build], cwd=sources, check=True, capture_output=True)
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def environment(folder: Path, wheel: Any) -> Any:
    """Return an environment with the wheel and its dependencies, from the default registry of pip."""
    python = folder / "environment" / "bin" / "python"
    complete = folder / "complete"
    if not complete.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", python.parent.parent], check=True)
        pip = [sys.executable, "-m", "pip", "--python", python, "--disable-pip-version-check"]
        install = [*pip, "install", "--no-compile", wheel]
        ended = subprocess.run(install, capture_output=True, text=True, env=without_sources())
        output = ended.stdout + ended.stderr
        if ended.returncode and any(reason in output for reason in UNREACHABLE):
            pytest.skip(f"a registry with numpy, scipy and Pillow is missing for pip: {output.splitlines()[-1]}")
        assert ended.returncode == 0, output
        complete.touch()
    return python


@pytest.fixture(scope="module")
def pictures(folder: Path) -> Any:
    """Return a folder with background.png and press.png of a GelSight Mini; real pictures if TACTILE_DATA is set."""
    place = folder / "pictures"
    if not place.exists():
        place.mkdir()
        if real_data.PRESENT:
            data = real_data.FOLDER / "gelslam"
            shutil.copy(data / "background.png", place)
            shutil.copy(data / "9.500mm" / "12.png", place / "press.png")
        else:
            for name in ("background.png", "press.png"):
                Image.fromarray(no_contact(td.load("gelsight-mini"))).save(place / name)
    return place


def run(python: Any, cwd: Any, *arguments: Any) -> Any:
    ended = subprocess.run([python, *arguments], cwd=cwd, env=without_sources(), capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert not ended.stderr
    return ended.stdout


def examples() -> Iterator[Any]:
    """Return the code in the docstring of the package and in the README."""
    (block,) = re.findall(r"(?:^    .*\n|^\n)*^    result\..*\n", td.__doc__, re.MULTILINE)
    yield pytest.param(textwrap.dedent(block), id="docstring")
    for page in ("README.md", "docs/python.md", "docs/integrate.md"):
        for index, block in enumerate(re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.M | re.S)):
            yield pytest.param(block, id=f"{page}-{index}")


def public_pages() -> list[Path]:
    """Return the pages and examples whose imports of the package are public."""
    kinds = ("*.md", "*.py", "*.ipynb")
    folders = [ROOT / "docs", ROOT / "examples"]
    return [ROOT / "README.md", *(file for kind in kinds for folder in folders for file in folder.rglob(kind))]


def metadata(wheel: Path) -> Any:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        return email.message_from_bytes(archive.read(name))


def test_the_metadata_say_what_a_user_must_know(wheel: Path) -> None:
    fields = metadata(wheel)
    assert fields["Version"] == VERSION
    assert fields["Requires-Python"] == ">=3.10"
    assert fields["License-Expression"] == "Apache-2.0"
    assert fields["Author"] and fields["Keywords"] and fields.get_all("Classifier")  # noqa: PT018
    assert fields.get_all("Provides-Extra") == ["fast", "fit", "plot", "live", "serial"]
    required = [line for line in fields.get_all("Requires-Dist") if "extra ==" not in line]
    assert [re.match(r"\w+", line)[0] for line in required] == ["numpy", "scipy", "Pillow"]  # type: ignore[index]


def test_every_link_of_the_description_leads_to_a_file(wheel: Path) -> None:
    """Check README.md as a package index shows it: all links are absolute, and those into the repository exist."""
    fields = metadata(wheel)
    urls = dict(line.split(", ") for line in fields.get_all("Project-URL"))
    address = urls["Repository"]
    assert fields["Description-Content-Type"] == "text/markdown"
    links = [*re.findall(r"\]\(([^)\s]+)\)", fields.get_payload()), *urls.values()]
    assert [link for link in links if not link.startswith("https://")] == []
    inside = [link.partition("#")[0] for link in links if link.startswith(f"{address}/") and link != urls["Issues"]]
    files = [re.sub("^/(blob|raw)/main/", "", link.removeprefix(address)) for link in inside]
    files = [re.sub(r"^/actions/workflows/(\w+\.yml)(/badge\.svg)?$", r".github/workflows/\1", file) for file in files]
    assert len(files) > 10
    assert [file for file in files if not (ROOT / file).is_file()] == []
    other = [
        line for line in fields.get_payload().split() if "tactile-depth/tactile-depth" in line and address not in line
    ]
    assert other == []


def test_the_archive_holds_the_package_and_no_tests(archive: Path) -> None:
    with tarfile.open(archive) as file:
        names = {member.name.partition("/")[2] for member in file.getmembers() if member.isfile()}
    package = [path.relative_to(ROOT).as_posix() for path in package_files()]
    made = {name for name in names if "egg-info/" in name} | {"setup.cfg"}
    public = [path.relative_to(ROOT).as_posix() for path in public_pages()]
    assert {*BESIDE_THE_PACKAGE, *package, *public} <= names - made
    assert {name.partition("/")[0] for name in names - made} == {*BESIDE_THE_PACKAGE, "docs", "examples", "models"}


def left_out(wheel: Path) -> dict[str, Path]:
    """Return the modules of the package that a wheel does not hold, by name."""
    files = {file.relative_to(ROOT / "models"): file for file in (ROOT / "models").rglob("*.py")}
    with zipfile.ZipFile(wheel) as archive:
        held = archive.namelist()
    out = {path: file for path, file in files.items() if path.as_posix() not in held}
    return {".".join(path.with_suffix("").parts): file for path, file in out.items()}


def names(text: str, module: str) -> bool:
    """Return True if a text names a module by its path, or imports it from its package."""
    package, _, name = module.rpartition(".")
    imports = rf"from {package} import (\(\s*)?(\w+( as \w+)?,\s*)*{name}\b"
    return name in text and re.search(rf"\b{module}\b|{imports}".replace(".", r"\."), text) is not None


def package_files() -> list[Path]:
    package = ROOT / "models" / "tactile_depth"
    kinds = ("*.py", "*.npz", "*.json", "*.h")
    return [*(path for kind in kinds for path in package.rglob(kind)), package / "py.typed"]


def test_the_wheel_holds_what_public_starts_import_and_the_data(wheel: Any) -> None:
    """Check what is left out and what is held by what names it: a module of the wheel, a page or an example."""
    out = left_out(wheel)
    assert out
    with zipfile.ZipFile(wheel) as archive:
        held = {name for name in archive.namelist() if ".dist-info/" not in name}
    files = {path.relative_to(ROOT / "models").as_posix() for path in package_files()}
    assert held == files - {path.relative_to(ROOT / "models").as_posix() for path in out.values()}
    texts = {name: (ROOT / "models" / name).read_text() for name in held if name.endswith(".py")}
    texts |= {str(page): page.read_text() for page in public_pages()}
    assert [module for module in out if any(names(text, module) for text in texts.values())] == []
    modules = {name: name.removesuffix(".py").replace("/", ".") for name in held if name.endswith(".py")}
    unnamed = [
        module
        for file, module in modules.items()
        if not any(names(text, module) for name, text in texts.items() if name != file)
    ]
    assert [module for module in unnamed if not module.endswith(("__init__", "__main__"))] == []


def test_what_pages_and_examples_import_is_in_the_wheel(environment: Any, tmp_path: Path) -> None:
    imports = r"^ *\"?((?:from tactile_depth(?:\.\w+)* )?import [^\\\n#]*)"
    lines = {line for page in public_pages() for line in re.findall(imports, page.read_text(), re.MULTILINE)}
    script = "\n".join(sorted(line for line in lines if "tactile_depth" in line))
    assert script.count("\n") > 6
    run(environment, tmp_path, "-c", script)


def test_the_version_is_that_of_pyproject(environment: Any, tmp_path: Path) -> None:
    script = "import sys, tactile_depth as td; print(td.__version__, 'numpy' in sys.modules)"
    assert run(environment, tmp_path, "-c", script).split() == [VERSION, "False"]
    assert run(environment.parent / "tactile-depth", tmp_path, "--version").split() == ["tactile-depth", VERSION]


def test_nothing_beyond_the_declared_is_imported(environment: Any, pictures: Any) -> None:
    script = """
        import sys
        import tactile_depth as td
        import tactile_depth.cli.main
        td.Pipeline(td.sample().sensor, td.sample().reference)
        print(td.__file__, *{name.split(".")[0] for name in sys.modules})
        """
    path, *modules = run(environment, pictures, "-c", textwrap.dedent(script)).split()
    assert Path(path).is_relative_to(environment.parent.parent)
    assert not {"matplotlib", "skimage", "cv2", "rerun", "serial", "commands"} & set(modules)


@pytest.mark.parametrize("block", list(examples()))
def test_the_examples_run_as_printed(environment: Any, pictures: Any, block: Any, tmp_path: Path) -> None:
    for picture in pictures.iterdir():
        shutil.copy(picture, tmp_path)
    run(environment, tmp_path, "-c", block.replace('crop="none"', 'crop="gs_sdk"'))  # as these pictures are cropped


def test_the_command_writes_its_files(environment: Any, pictures: Any, tmp_path: Path) -> None:
    command = environment.parent / "tactile-depth"
    options = ["--reference", pictures / "background.png", "--out", tmp_path]
    printed = run(command, tmp_path, "depth", pictures / "press.png", *options)
    assert printed.startswith("calibration: gelsight-mini: the reference looks like it")
    assert {path.name for path in tmp_path.iterdir()} == {
        RECORD, "depth_mm.npy", "depth_um.png", "depth.ply", "overview.png", "report.json"
    }  # fmt: skip


@pytest.mark.parametrize(
    "picture",
    [
        pytest.param(DRAWN, id="drawn", marks=pytest.mark.regress),
        pytest.param(REAL, id="real", marks=real_data.needs_real_data),
    ],
)
def test_the_rtl_has_the_codes_of_the_wheel(
    environment: Any, pictures: Any, tmp_path: Path, picture: np.ndarray
) -> None:
    for file in pictures.iterdir():
        shutil.copy(file, tmp_path)
    run(environment, tmp_path, "-c", textwrap.dedent(QUICK_START.format(pictures=picture)))
    codes = np.load(tmp_path / "codes.npy")
    gains = np.rint(np.load(tmp_path / "gains.npy") / LIGHT_GAIN.lsb).astype(int)
    if picture == REAL:
        sensor, names = td.load("gelsight-mini"), ("background.png", "press.png")
        reference, image = (read_picture(pictures / name) for name in names)
    else:
        drawn = td.sample("ball")
        sensor, reference, image = drawn.sensor, drawn.reference, drawn.image
    pipeline = td.Pipeline(sensor, reference)
    rows, columns = pipeline.grid
    frame = np.rint(resampling(image.shape[:2], pipeline.grid).average(image)).astype(np.uint8)
    sensor = replace(pipeline.sensor, reference=pipeline.sensor.reference[0])  # type: ignore[index]
    work = tmp_path / "rtl"
    work.mkdir()
    played = bench.play(
        "verilator",
        pipeline.config,
        sensor,
        bench.frame_entries(frame[None]),
        work,
        clocks=10 * rows * columns,
        total_frames=1,
        registers=dict(zip(GAINS, gains.tolist(), strict=True)),
        zero=pipeline._zero,
    )
    np.testing.assert_array_equal(played.codes.reshape(rows, columns)[::-1], codes)  # the bottom row leaves first
    described = json.loads((tmp_path / "hardware" / "parameters.json").read_text())
    crc = zlib.crc32((tmp_path / "hardware" / CRCS).read_bytes())
    assert described["fields"] == top_parameters(pipeline.config, pipeline.pixel_pitch_mm, tables_crc=crc)
    assert described["parameters"] == hdl_parameters(pipeline.config, pipeline.pixel_pitch_mm, tables_crc=crc)
    for name in described["tables"]:
        assert (tmp_path / "hardware" / name).read_text() == (work / name).read_text()
