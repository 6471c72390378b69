# SPDX-License-Identifier: Apache-2.0
"""The viewer of `tactile-depth live`: on a computer without a screen, on which addresses, and how it ends."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from tactile_depth.cli.viewer import Page, page_of
from tests.press_video import press_frames, write_sensor

FRAMES = 12
END_S = 2.0
needs_rerun = pytest.mark.skipif("not __import__('importlib.util').util.find_spec('rerun')", reason="make live-test")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with drawn presses, background and calibration."""
    folder = tmp_path_factory.mktemp("inputs")
    write_sensor(folder)
    np.save(folder / "presses.npy", press_frames(FRAMES))
    return folder


def started(
    inputs: Path, *words: str, reference: str = "background.png", calibration: str = "sensor.npz", **options: Any
) -> Any:
    """Start the command without a screen."""
    known = ["--reference", reference, "--calibration", calibration, "--grid", "32x24"]
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    environment |= {"PYTHONPATH": str(Path(td.__file__).parent.parent)} | options.pop("variables", {})
    return subprocess.Popen(
        [sys.executable, "-m", "tactile_depth.cli", "live", "presses.npy", *known, *words],
        cwd=inputs,
        env=environment,
        text=True,
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
    )


def lines_to(lines: Iterator[str], last: str) -> Iterator[str]:
    for line in lines:
        yield line
        if line.startswith(last):
            return


def is_open(host: str, port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection((host, port), timeout=5):
        return True
    return False


@pytest.fixture
def port() -> int:
    """Return a port that is free, as the next one is."""
    while True:
        with socket.socket() as one, socket.socket() as other:
            one.bind(("127.0.0.1", 0))
            number = one.getsockname()[1]
            with contextlib.suppress(OSError, OverflowError):
                other.bind(("127.0.0.1", number + 1))
                break
    return number


def test_addresses_of_pages() -> None:
    assert page_of("localhost") == Page("127.0.0.1", 9090)
    assert page_of("[::1]:8000").url == "http://[::1]:8000?url=rerun%2Bhttp%3A%2F%2F%5B%3A%3A1%5D%3A8001%2Fproxy"
    assert page_of("0.0.0.0:80").url.startswith(f"http://{socket.gethostname()}:80?url=")


@needs_rerun
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=lambda number: number.name)
def test_a_page_is_at_127_0_0_1_alone_and_ends_with_the_command(inputs: Path, port: int, number: Any) -> None:
    process = started(inputs, "--web-address", f"127.0.0.1:{port}")
    lines = iter(process.stdout.readline, "")
    assert next(lines) == f"open {page_of(f'127.0.0.1:{port}').url}\n"
    assert [is_open(host, each) for host in ("127.0.0.1", "127.0.0.2") for each in (port, port + 1)] == [1, 1, 0, 0]
    assert f"frames: read {FRAMES}, shown {FRAMES}" in "".join(line for line in lines_to(lines, "no more frames"))
    assert process.poll() is None
    began = time.monotonic()
    process.send_signal(number)
    process.wait(60)
    assert time.monotonic() - began < END_S
    assert process.returncode == 128 + number
    assert len(process.stderr.read().splitlines()) == 1
    assert not is_open("127.0.0.1", port)
    assert not is_open("127.0.0.1", port + 1)


@needs_rerun
def test_without_a_screen_one_line_names_web(inputs: Path) -> None:
    process = started(inputs)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert errors == (
        "tactile-depth: there is no screen: DISPLAY is not set: give --web to watch in a browser, or --headless --save "
        "FILE.rrd to record\n"
    )


@needs_rerun
def test_a_screen_that_cannot_be_reached_is_one_line(inputs: Path) -> None:
    process = started(inputs, variables={"DISPLAY": ":987"})
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 3
    (line,) = errors.splitlines()
    assert line.startswith("tactile-depth: the viewer ended")
    assert "give --web" in line


@needs_rerun
def test_a_port_in_use_is_named(inputs: Path, port: int) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", port + 1))
        other.listen()
        process = started(inputs, "--web-address", f"127.0.0.1:{port}")
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 3
    assert errors.startswith(
        f"tactile-depth: port {port + 1} of 127.0.0.1 is in use: give --web-address 127.0.0.1:PORT"
    )


@needs_rerun
@pytest.mark.parametrize(
    ("words", "known", "message"),
    [
        (["--web-address", "192.0.2.1"], {}, "--web-address 192.0.2.1 is no address of this computer"),
        ([], {"calibration": "none.npz"}, "none.npz"),
        ([], {"reference": "none.png"}, "none.png"),
    ],
)
def test_a_wrong_input_is_named_before_anything_is_served(
    inputs: Path, words: list[str], known: dict[str, str], message: str
) -> None:
    printed, errors = (process := started(inputs, "--web", *words, **known)).communicate(timeout=60)
    assert process.returncode == 2
    assert message in errors
    assert "open http" not in printed


@needs_rerun
def test_a_recording_has_the_times_of_captures(tmp_path: Path) -> None:
    from rerun.chunk import RrdReader  # type: ignore[import-not-found]

    from tactile_depth.cli.display import Display

    sample = td.sample()
    pipeline = td.Pipeline(sample.sensor, sample.reference, grid=(24, 32))
    seconds = [1.5, 2.25]
    with Display(tmp_path / "run.rrd", window=False, names=["0", "1"]) as display:
        for number, captured_at in enumerate(seconds):
            result = pipeline(sample.image, captured_at=captured_at)
            for sensor in (0, 1):
                display.show(number, sample.image, result, sensor)
        display.show(2, sample.image, pipeline(sample.image), 0)
    times: dict[str, list[Any]] = {}
    for chunk in RrdReader(tmp_path / "run.rrd").stream():
        batch = chunk.to_record_batch()
        if str(chunk.entity_path).endswith("/height") and "captured" in batch.schema.names:
            column = batch.column(batch.schema.names.index("captured"))
            times.setdefault(str(chunk.entity_path), []).extend(column.cast("int64").to_pylist())
    assert times == {f"/sensor_{sensor}/height": [1_500_000_000, 2_250_000_000] for sensor in (0, 1)}


@needs_rerun
@pytest.mark.parametrize("closed", ["1", "0 1 2"])
def test_closed_streams_end_nothing(inputs: Path, tmp_path: Path, closed: str) -> None:
    def close() -> None:
        for number in map(int, closed.split()):
            os.close(number)

    words = ["--headless", "--save", str(tmp_path / "run.rrd")]
    process = started(inputs, *words, stdout=None, stderr=None, preexec_fn=close)
    assert process.wait(60) == 0
    assert (tmp_path / "run.rrd").stat().st_size > 0


@needs_rerun
def test_a_reader_that_has_ended_is_one_line(inputs: Path, tmp_path: Path) -> None:
    process = started(inputs, "--headless", "--save", str(tmp_path / "run.rrd"))
    process.stdout.close()
    errors = process.stderr.read()
    assert process.wait(60) == 3
    assert errors == "tactile-depth: whatever reads the output has ended\n"
