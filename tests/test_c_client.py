# SPDX-License-Identifier: Apache-2.0
"""examples/link_client.c: it loads a device over a line and writes the heights that the package computes."""

import ctypes
import itertools
import json
import pickle
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import tactile_depth as td
from commands.common.repository import ROOT
from commands.common.simulator import check
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.framing import LONGEST_BODY, cobs_decode, to_line
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.registers.table_banks import COMMIT
from tests.device.cable import Cable, setup_of
from tests.device.model_device import ModelDevice
from tests.test_c_header import compiled, tool

SOURCE, HEADER = ROOT / "examples" / "link_client.c", ROOT / "examples" / "tactile_depth_link.h"
FLAGS = ("-std=c99", "-Wall", "-Werror")
GRID = (24, 32)
STATUS = link.Status(0, *GRID, 24, True, False, link.DepthFormat.WORDS, 8, 0, 0, 0)
LIMIT_S = 60
OF_BUILD = "or take this build's tables"
HARMS = {"flipped": "a bit of the device had flipped", "residual": "the depth does not fit its slopes"}
STILL, MOST_PICTURES = 4, 20  # of the program
LIBRARY = """
#define _DEFAULT_SOURCE
#include "tactile_depth_link.h"
size_t line_of(const uint8_t *body, size_t length, uint8_t *line);
size_t line_of(const uint8_t *body, size_t length, uint8_t *line) { return link_to_line(body, length, line); }
size_t decoded(const uint8_t *piece, size_t length, uint8_t *out);
size_t decoded(const uint8_t *piece, size_t length, uint8_t *out) { return link_cobs_decode(piece, length, out); }
"""


@dataclass(frozen=True)
class Client:
    """The program with the tables of a pipeline.

    Attributes
    ----------
    folder : Path
        Files of `Pipeline.hardware`, the program, and a press on the grid.
    """

    folder: Path
    pipeline: td.Pipeline

    def command(self, port: str, *heights: str) -> list[str]:
        return [str(self.folder / "link_client"), port, str(self.folder / "picture.rgb"), *heights]

    def run(self, port: str, *heights: str) -> subprocess.CompletedProcess:
        command = self.command(port, *heights)
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=LIMIT_S)

    def run_with(self, device: Sequence[str], *heights: str) -> subprocess.CompletedProcess:
        """Run the program with a process as its device: the output of each is the input of the other."""
        pipe = subprocess.PIPE
        with subprocess.Popen(device, cwd=ROOT, stdin=pipe, stdout=pipe) as served:
            command = self.command("-", *heights)
            client = subprocess.Popen(command, stdin=served.stdout, stdout=served.stdin, stderr=pipe, text=True)
            for end in (served.stdin, served.stdout):
                assert end is not None
                end.close()
            _, text = client.communicate(timeout=10 * LIMIT_S)
        return subprocess.CompletedProcess(command, client.returncode, "", text)

    def show(self, image: np.ndarray) -> None:
        """Let the program send a picture."""
        frames, _ = self.pipeline.reader.pictures(image, "the picture")
        _, picture = next(frames)
        (self.folder / "picture.rgb").write_bytes(picture.tobytes())

    def expected(self, image: np.ndarray | None = None) -> td.Result:
        """Return the depth of a picture, by default the press, in a stream that repeats it until the light settles."""
        image = td.sample("ball").image if image is None else image
        stream = self.pipeline.new_stream()
        for _ in range(MOST_PICTURES):
            before = np.zeros(3) if stream.light is None else stream.light.gains
            result = self.pipeline(image, stream)
            if stream.light is None or np.abs(stream.light.gains - before).max() <= STILL:
                break
        return result


def client_of(folder: Path, **choices: object) -> Client:
    ball = td.sample("ball")
    pipeline = td.Pipeline(ball.sensor, ball.reference, **({"grid": GRID} | choices))  # type: ignore[arg-type]
    pipeline.hardware(folder)
    compiled(tool("gcc"), *FLAGS, f"-I{folder}", SOURCE, "-o", folder / "link_client")
    client = Client(folder, pipeline)
    client.show(ball.image)
    return client


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Client:
    return client_of(tmp_path_factory.mktemp("client"))


@pytest.fixture
def plug(tmp_path: Path) -> Iterator[Callable[..., Cable]]:
    """Return a function that plugs a device which fits a pipeline into a serial port."""
    cables: list[Cable] = []

    def plug(pipeline: td.Pipeline | None, **wanted: object) -> Cable:
        setup = None if pipeline is None else setup_of(pipeline, **wanted)
        cables.append(Cable(tmp_path / f"port{len(cables)}", setup))
        return cables[-1]

    yield plug
    for cable in cables:
        cable.unplug()


def assert_heights(client: Client, written: Path) -> None:
    """Compare a file of heights with those of the package; equal heights are equal codes."""
    expected = client.expected()
    heights = np.fromfile(written, np.float32).reshape(expected.codes.shape)
    np.testing.assert_array_equal(heights, expected.height_mm.astype(np.float32))
    codes = (heights.astype(np.float64) + expected.untouched_mm) / expected.depth_lsb_mm
    np.testing.assert_array_equal(np.rint(codes), expected.codes)


@pytest.mark.parametrize(
    "choices",
    [
        {},
        {"grid": (32, 32), "solver": "spectral", "data_width": 16, "light_gains": False},
        {"model": "lut", "data_width": 18, "zero_offset": False, "light_gains": False},
    ],
    ids=["tridiagonal-24", "spectral-16", "lut-18"],
)
def test_heights_over_a_serial_port(tmp_path: Path, plug: Callable[..., Cable], choices: dict[str, object]) -> None:
    client = client_of(tmp_path, **choices)
    cable = plug(client.pipeline)
    ran = client.run(str(cable.path), str(tmp_path / "heights.f32"))
    assert ran.returncode == 0, ran.stderr
    assert_heights(client, tmp_path / "heights.f32")


def test_the_peak_is_printed(client: Client, plug: Callable[..., Cable]) -> None:
    ran = client.run(str(plug(client.pipeline).path))
    heights = client.expected().height_mm
    row, column = np.unravel_index(heights.argmax(), GRID)
    sent, peak = ran.stderr.splitlines()
    assert re.fullmatch(r"picture sent \d times, light gains( 1\.00\d\d){3}", sent)
    assert peak == f"peak {heights.max():.4f} mm in row {row}, column {column}"


def test_each_run_gives_the_height_of_a_pipeline_in_other_light(tmp_path: Path, plug: Callable[..., Cable]) -> None:
    """Measured on drawn and real presses: within 0.13 %."""
    client, ball = client_of(tmp_path, model="quadratic"), td.sample("ball")
    cable = plug(client.pipeline)
    for light in (0.9, 1.0, 1.05, 1.1, 1.2):
        image = np.clip(np.rint(light * ball.image), 0, 255).astype(np.uint8)
        client.show(image)
        texts = []
        for run in range(3):
            ran = client.run(str(cable.path), str(tmp_path / f"heights{run}.f32"))
            assert ran.returncode == 0, ran.stderr
            texts.append(ran.stderr)
            assert (tmp_path / f"heights{run}.f32").read_bytes() == (tmp_path / "heights0.f32").read_bytes()
        assert texts == texts[:1] * 3
        assert "uncertain" not in texts[0]
        heights = np.fromfile(tmp_path / "heights0.f32", np.float32)
        np.testing.assert_array_equal(heights.reshape(GRID), client.expected(image).height_mm.astype(np.float32))
        right = client.pipeline(image).height_mm.max()
        assert abs(heights.max() / right - 1) < 0.002


@pytest.mark.parametrize(
    ("light", "choices", "text"),
    [
        ((0.4, 0.4, 0.4), {}, "the light is beyond the light gains, 0 dark pixels, "),
        ((1.0, 1.0, 1.0), {"depth_range_mm": 0.5}, "values were clipped, 0 dark pixels, "),
    ],
    ids=["dim", "deep"],
)
def test_what_is_uncertain_is_printed(
    light: tuple[float, ...], choices: dict[str, object], text: str, tmp_path: Path, plug: Callable[..., Cable]
) -> None:
    client = client_of(tmp_path, model="quadratic", **choices)
    client.show(np.rint(td.sample("ball").image * light).astype(np.uint8))
    ran = client.run(str(plug(client.pipeline).path))
    assert re.search(f"\nheights are uncertain: .*{text}", ran.stderr), ran.stderr


def test_heights_of_a_process_on_standard_input_and_output(client: Client, tmp_path: Path) -> None:
    file = tmp_path / "setup"
    file.write_bytes(pickle.dumps(setup_of(client.pipeline)))
    device = [sys.executable, "-m", "tests.device.model_device", str(file)]
    ran = client.run_with(device, str(tmp_path / "heights.f32"))
    assert ran.returncode == 0, ran.stderr
    assert_heights(client, tmp_path / "heights.f32")


@pytest.mark.regress
def test_heights_of_the_rtl(client: Client, tmp_path: Path) -> None:
    check("verilator")
    device = [sys.executable, "-m", "commands.run.device_sim", str(client.folder)]
    ran = client.run_with(device, str(tmp_path / "heights.f32"))
    assert ran.returncode == 0, ran.stderr
    assert_heights(client, tmp_path / "heights.f32")


@pytest.mark.parametrize("damage", ["drop", "flip", "double"])
def test_a_line_that_damages_packets(plug: Callable[..., Cable], tmp_path: Path, damage: str) -> None:
    client = client_of(tmp_path, light_gains=False)  # with them a picture that is sent again has another depth
    cable = plug(client.pipeline, damage={damage: 0.03})
    ran = client.run(str(cable.path), str(tmp_path / "heights.f32"))
    assert ran.returncode == 0, ran.stderr
    assert_heights(client, tmp_path / "heights.f32")


def test_it_runs_twice_and_over_tables_that_no_frame_has_taken(
    client: Client, plug: Callable[..., Cable], tmp_path: Path
) -> None:
    cable = plug(client.pipeline)
    with td.Device(cable.address, client.pipeline) as device:
        device.registers["TABLE_COMMIT"] = COMMIT.mask()
        assert device.registers["TABLE_COMMIT"]
    for _ in range(2):
        assert client.run(str(cable.path)).returncode == 0


def test_it_writes_every_register_that_contacts_depend_on(tmp_path: Path, plug: Callable[..., Cable]) -> None:
    """With OFF_THRESHOLD as after a reset each frame of a press begins or ends a contact."""
    client = client_of(tmp_path, threshold_mm=0.02)
    cable = plug(client.pipeline)
    wanted = json.loads((client.folder / "parameters.json").read_text())["registers"]
    assert wanted["MINIMUM_AREA"] != REGISTERS["MINIMUM_AREA"].reset, "the test is void"
    for _ in range(2):
        assert client.run(str(cable.path)).returncode == 0
    with td.Device(cable.address, client.pipeline) as device:
        assert {name: device.registers[name] for name in wanted} == wanted
        assert [device.registers[f"RECORD_EVENT.{name}"] for name in ("touching", "began", "ended")] == [1, 0, 0]


def test_what_fails_is_said(client: Client, plug: Callable[..., Cable], tmp_path: Path) -> None:
    ball = td.sample("ball")
    other_grid = td.Pipeline(ball.sensor, ball.reference, grid=(12, 16))
    other_build = td.Pipeline(ball.sensor, ball.reference, grid=GRID, light_gains=False)
    resets = itertools.count()
    older, newer, restless = plug(None), plug(None), plug(None)
    wide, upside_down = plug(None), plug(None)
    wide.answer(lambda _: to_line(STATUS._replace(data_width=20).pack()))
    upside_down.answer(lambda _: to_line(STATUS._replace(bottom_first=False).pack()))
    older.answer(lambda _: to_line(bytes((link.Kind.STATUS, link.VERSION - 1))))
    newer.answer(lambda _: to_line(bytes((link.Kind.STATUS, link.VERSION + 1))))
    restless.answer(lambda asked: to_line(STATUS._replace(resets=next(resets)).pack()) if asked else b"")
    for port, text in {
        str(plug(other_grid).path): "the device has another grid than the tables",
        str(plug(other_build).path): "the device is another build",
        str(older.path): "the device speaks another version of the link",
        str(newer.path): "the device speaks another version of the link",
        str(restless.path): "the device was reset",
        str(wide.path): f"link_unit has another width of codes than the tables: set its DataWidth, {OF_BUILD}",
        str(upside_down.path): "link_unit has another order of rows than the tables: set its BottomFirst to 1 for the "
        f"tridiagonal solver, to 0 for the spectral one, {OF_BUILD}",
        str(plug(None).path): "the device does not answer",
        str(tmp_path / "none"): "the port cannot be opened",
    }.items():
        ran = client.run(port)
        assert (ran.returncode, ran.stderr) == (1, f"{port}: {text}\n")


@pytest.mark.parametrize("harm", HARMS)
def test_a_frame_that_the_device_doubts_is_named(client: Client, plug: Callable[..., Cable], harm: str) -> None:
    cable = plug(client.pipeline)
    cable.serving.device.harms = (harm,)
    assert re.search(f"\nheights are uncertain: .*{HARMS[harm]}, ", client.run(str(cable.path)).stderr)


@pytest.mark.parametrize("is_early", [True, False], ids=["before a picture", "after a picture"])
def test_frames_of_a_camera_are_refused(
    client: Client, plug: Callable[..., Cable], monkeypatch: pytest.MonkeyPatch, is_early: bool
) -> None:
    camera = {"camera": np.full((1, *GRID, 3), 128, np.uint8), "camera_s": 0.05} if is_early else {}
    picture = ModelDevice._picture
    if not is_early:
        monkeypatch.setattr(ModelDevice, "_picture", lambda *given: [picture(*given) for _ in range(2)])
    cable = plug(client.pipeline, **camera)
    ran = client.run(str(cable.path))
    text = "the device has a camera of its own: stop the camera, or take its depth with td.Device in Python"
    assert (ran.returncode, ran.stderr) == (1, f"{cable.path}: {text}\n")


def test_a_port_in_use_is_left_alone(client: Client, plug: Callable[..., Cable]) -> None:
    cable = plug(client.pipeline)
    with td.Device(cable.address, client.pipeline):
        ran = client.run(str(cable.path))
    text = "the port is in use by another program: close that one"
    assert (ran.returncode, ran.stderr) == (1, f"{cable.path}: {text}\n")


def test_a_line_that_ends(client: Client) -> None:
    ran = client.run_with([sys.executable, "-c", "import os; os.read(0, 1)"])
    assert (ran.returncode, ran.stderr) == (1, "-: the line has ended\n")


def test_bytes_on_the_line_are_those_of_the_package(client: Client, tmp_path: Path) -> None:
    source, library = tmp_path / "link.c", tmp_path / "link.so"
    source.write_text(LIBRARY)
    headers = (f"-I{client.folder}", f"-I{HEADER.parent}")
    compiled(tool("gcc"), *FLAGS, "-Wextra", "-pedantic", *headers, "-shared", "-fPIC", source, "-o", library)
    functions = ctypes.CDLL(str(library))
    out, rng = ctypes.create_string_buffer(2000), np.random.default_rng(1)

    def called(function: Callable[..., int], data: bytes) -> bytes:
        length = function(data, len(data), out)
        return out.raw[:length]

    lengths = [1, 2, 249, 250, 251, 252, 253, 254, 255, 503, 504, 505, LONGEST_BODY]
    for length in [*lengths, *rng.integers(1, LONGEST_BODY, 200).tolist()]:
        for zeros in (0, 0.01, 0.5):
            body = (rng.integers(1, 256, length) * (rng.random(length) >= zeros)).astype(np.uint8).tobytes()
            assert called(functions.line_of, body) == to_line(body)
            piece = to_line(body)[1:-1]
            for part in (piece, piece[: rng.integers(len(piece))]):
                assert called(functions.decoded, part) == (cobs_decode(part) or b"")


@pytest.mark.parametrize("file", [SOURCE, ROOT / "docs" / "link.md"], ids=lambda file: file.name)
def test_the_command_of_the_page_is_the_one_that_is_tested(file: Path) -> None:
    (command,) = re.findall(r"^ +(gcc .*)$", file.read_text(), re.MULTILINE)
    assert command == f"gcc {' '.join(FLAGS)} -Ihardware examples/link_client.c -o link_client"
