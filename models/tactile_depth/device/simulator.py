# SPDX-License-Identifier: Apache-2.0
"""Simulator of a device in a process of its own, whose standard input and output are the line."""

from __future__ import annotations

import contextlib
import os
import select
import subprocess
import sys
import threading
from importlib.util import find_spec
from pathlib import Path

import tactile_depth
from tactile_depth.base import files
from tactile_depth.base.errors import REPOSITORY
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.errors import DeviceError
from tactile_depth.device.transport import Pace

COMMAND = "commands.run.device_sim"
PINS = "--pins"
READY = "ready"
START_S = 600.0  # a simulator that is not ready by then is not built
END_S = 5.0
PIPE_BYTES = 1 << 16
PACES = {False: Pace(2.0, 60.0, 0.1), True: Pace(2.0, 120.0, 0.5)}  # without and with the pins of the line


def command_of(folder: Path, pins: bool) -> tuple[list[str], Path]:
    """Return the command of the simulator and the folder in which it runs, the root of the repository.

    Parameters
    ----------
    folder : Path
        Files of the configuration, as `Pipeline.hardware` writes them.
    pins : bool
        Simulate the pins of the serial line too.

    Raises
    ------
    DeviceError
        This package is not in a clone of the repository, or the clone is not set up.
    """
    root = Path(tactile_depth.__file__).resolve().parents[2]
    # The simulator needs packages that `make setup` installs; another Python, as one with a viewer, may lack them.
    python = sys.executable if find_spec("cocotb_tools") else str(root / ".venv" / "bin" / "python")
    if not (root / "commands" / "run" / "device_sim.py").is_file() or not Path(python).exists():
        problem = "a simulated device needs the RTL, which pip does not install"
        remedy = f"clone {REPOSITORY}, run `make setup` there, and use the Python of its .venv"
        raise DeviceError(problem, remedy=remedy)
    return [python, "-m", COMMAND, str(folder), *([PINS] if pins else [])], root


class Simulator:
    """Simulator of the device of a pipeline's configuration.

    Parameters
    ----------
    pipeline : Pipeline
    pins : bool
        Simulate the pins of the serial line too.

    Raises
    ------
    DeviceError
        The simulator cannot be built or does not start.
    """

    def __init__(self, pipeline: Pipeline, pins: bool = False) -> None:
        self.name = "the simulator"
        self.silence = "it may be built of other sources than this package"
        self.pace = PACES[pins]
        self._folder = contextlib.ExitStack()
        self._last = ""  # line on its standard error
        self._ready = threading.Event()
        self._process: subprocess.Popen | None = None
        try:
            folder = self._folder.enter_context(files.temporary())
            pipeline.hardware(folder, quiet=True)
            command, root = command_of(folder, pins)
            self._start(command, root)
        except BaseException:
            self.close()
            raise

    def _start(self, command: list[str], root: Path) -> None:
        self._process = process = subprocess.Popen(
            command,
            cwd=root,
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C ends this program, which ends the simulator
        )
        assert process.stdin is not None
        assert process.stdout is not None
        self._in, self._out = process.stdin.fileno(), process.stdout.fileno()
        os.set_blocking(self._in, False)
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        if not self._ready.wait(START_S):
            raise DeviceError(f"the simulator is not ready after {START_S:g} s", remedy="build it on an idle machine")
        if process.poll() is not None:
            raise self._ended("does not start")

    def _listen(self) -> None:
        """Read standard error to its end; show what comes before the simulator is ready."""
        process = self._process
        assert process is not None
        assert process.stderr is not None
        for line in iter(process.stderr.readline, b""):
            text = line.decode(errors="replace").strip()
            if text.startswith(READY):
                self._ready.set()
            elif text:
                self._last = text
                if not self._ready.is_set():
                    print(text, file=sys.stderr, flush=True)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(END_S)
        self._ready.set()

    def read(self, timeout_s: float) -> bytes:
        """Return bytes of the device; none at the time-out. Raises DeviceError if the simulator has ended."""
        if not select.select([self._out], [], [], timeout_s)[0]:
            return b""
        data = os.read(self._out, PIPE_BYTES)
        if not data:
            raise self._ended("has ended")
        return data

    def write(self, data: bytes) -> None:
        """Send bytes. Raises DeviceError if the simulator has ended or takes none."""
        rest = memoryview(data)
        while rest:
            if not select.select([], [self._in], [], self.pace.limit_s)[1]:
                remedy = "close the device and open it again"
                raise DeviceError(f"the simulator has taken no bytes for {self.pace.limit_s:g} s", remedy=remedy)
            try:
                rest = rest[os.write(self._in, rest) :]
            except BlockingIOError:  # less room than a pipe promises
                continue
            except OSError as error:
                raise self._ended("has ended") from error

    def close(self) -> None:
        """End the simulator and remove its files."""
        process, self._process = self._process, None
        if process is not None:
            assert process.stdin is not None
            process.stdin.close()  # which ends it
            try:
                process.wait(END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            self._listener.join(END_S)
            for pipe in (process.stdout, process.stderr):
                assert pipe is not None
                pipe.close()
        self._folder.close()

    def _ended(self, what: str) -> DeviceError:
        return DeviceError(
            f"the simulator {what}{self._last and f' ({self._last})'}", remedy="the next call starts it anew"
        )
