# SPDX-License-Identifier: Apache-2.0
"""Serial port with the model of a device, or with anything else, at its other end: a pty that can be unplugged."""

from __future__ import annotations

import os
import select
import threading
import tty
from collections.abc import Callable
from pathlib import Path

import tactile_depth as td
from tests.device.model_device import Serving, Setup


def setup_of(pipeline: td.Pipeline, **wanted: object) -> Setup:
    """Return a device that fits a pipeline."""
    return Setup(pipeline.config, pipeline.pixel_pitch_mm, **wanted)  # type: ignore[arg-type]


class Cable:
    """Serial port at a path, which a thread serves while it is plugged in.

    Parameters
    ----------
    path : Path
        Becomes a symbolic link to the pty.
    setup : Setup, optional
        Device at the other end; by default nobody reads or writes.

    Attributes
    ----------
    serving : Serving
    """

    def __init__(self, path: Path, setup: Setup | None = None) -> None:
        self.path, self.setup = path, setup
        self._thread: threading.Thread | None = None
        self.plug()

    @property
    def address(self) -> str:
        return f"serial:{self.path}"

    def plug(self) -> None:
        """Plug the device in, which then has been powered up."""
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.path.symlink_to(os.ttyname(self.slave))
        if self.setup is not None:
            self.serving = Serving(self.setup, self.master, self.master)
            self._run(self.serving.run)

    def answer(self, speak: Callable[[bytes], bytes]) -> None:
        """Serve the port with a function of bytes that came, which may be none, to bytes of the device."""
        self._answers = True

        def run() -> None:
            while self._answers:
                ready = select.select([self.master], [], [], 0.01)[0]
                reply = speak(os.read(self.master, 4096) if ready else b"")
                if reply and select.select([], [self.master], [], 0.1)[1]:
                    os.write(self.master, reply[:512])

        self._run(run)

    def _run(self, run: Callable[[], None]) -> None:
        self._thread = threading.Thread(target=run, daemon=True)
        self._thread.start()

    def unplug(self) -> None:
        """Unplug the device; doing it twice does nothing."""
        if not self.path.is_symlink():
            return
        self.path.unlink()
        self._answers = False
        if self.setup is not None:
            self.serving.wanted.add("end")
        if self._thread is not None:
            self._thread.join()
        os.close(self.slave)
        os.close(self.master)
