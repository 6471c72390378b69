# SPDX-License-Identifier: Apache-2.0
"""Rerun's viewer as a process of its own: a window of this computer, or a server for browsers."""

from __future__ import annotations

import contextlib
import errno
import ipaddress
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote, urlsplit

from tactile_depth.base.errors import InputError
from tactile_depth.cli.failure import Failure
from tactile_depth.cli.source import INSTALL

LOOPBACK, PORT = "127.0.0.1", 9090
INSTEAD = "give --web to watch in a browser, or --headless --save FILE.rrd to record"
AGAIN = "start it again, or give --headless --save FILE.rrd to record"
SCREENS = ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET")
START_S, END_S = 30.0, 0.5  # a viewer starts in 0.3 s on an idle machine, and ends within milliseconds
NOISE = re.compile(r"\x1b\[[0-9;]*m|.* at \S+\.rs:\d+: |^Error: ")  # colours, and where in its source it failed
PLACES = ("Rerun.app/Contents/MacOS/Rerun", "rerun.exe", "rerun")  # of the program in its package


class Page(NamedTuple):
    """Address at which browsers find the viewer; its data come from the port after that one."""

    host: str
    port: int

    @property
    def url(self) -> str:
        """Address to open in a browser; of a server on all addresses, with the name of this computer."""
        host = self.host if not ipaddress.ip_address(self.host).is_unspecified else socket.gethostname()
        host = f"[{host}]" if ":" in host else host
        return f"http://{host}:{self.port}?url={quote(f'rerun+http://{host}:{self.port + 1}/proxy', safe='')}"


def page_of(address: str) -> Page:
    """Return the page of `IP`, `IP:PORT` or `localhost`; raise InputError if it is none."""
    option = f"--web-address {address}"
    try:
        parts = urlsplit(f"//{address}")
        host = ipaddress.ip_address({"localhost": LOOPBACK}.get(parts.hostname or "", parts.hostname or ""))
        port = PORT if parts.port is None else parts.port
    except ValueError as error:
        accepted = f"an IP address of this computer, with a port or without: {LOOPBACK}:{PORT}"
        raise InputError(option, " is no address", accepted=accepted) from error
    if not 0 < port < 2**16 - 1:
        raise InputError(f"{option}: accepted are ports from 1 to {2**16 - 2}")
    return Page(str(host), port)


def load_rerun() -> Any:
    """Return the module rerun, whose own log is off.

    Raises
    ------
    Failure
        It is not installed.
    """
    os.environ.setdefault("RUST_LOG", "off")
    try:
        import rerun
    except ImportError as error:
        raise Failure(f"frames are shown by Rerun, which is not installed: {INSTALL}") from error
    return rerun


class Viewer(AbstractContextManager["Viewer"]):
    """The viewer; use it in a `with` block.

    A server ends with the block. A window stays, to look at what came, unless an exception ends the block.

    Parameters
    ----------
    page : Page or None
        Where browsers find it; None for a window.

    Attributes
    ----------
    url : str
        Where it takes data, at this computer.
    is_page : bool
        It shows pages, not a window.

    Raises
    ------
    InputError
        There is no screen, or the address is not one of this computer.
    Failure
        A port is in use, or the viewer does not start.
    """

    def __init__(self, page: Page | None) -> None:
        load_rerun()  # its absence is told first
        self.is_page = page is not None
        is_unix = sys.platform not in ("win32", "darwin")
        if page is None and is_unix and not any(map(os.environ.get, SCREENS)):
            raise InputError(f"there is no screen: DISPLAY is not set: {INSTEAD}")
        host = LOOPBACK if page is None else page.host
        words = [_program(), "--bind", host, "--hide-welcome-screen", "--expect-data-soon"]
        if page is None:
            ports = [_free_port()]
        else:
            ports = [page.port + 1, page.port]
            for port in ports:
                _require_free(host, port)
            words += ["--serve-web", "--newest-first", "--web-viewer-port", str(page.port)]
            if not ipaddress.ip_address(host).is_loopback:
                words += ["--cors-allow-origin", f"http://*:{page.port}"]
        reached = host if not ipaddress.ip_address(host).is_unspecified else LOOPBACK
        self.url = f"rerun+http://{f'[{reached}]' if ':' in reached else reached}:{ports[0]}/proxy"
        self._log = tempfile.TemporaryFile()  # noqa: SIM115
        self._process = subprocess.Popen(
            [*words, "--port", str(ports[0])],
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=self._log,
            start_new_session=True,  # Ctrl-C goes to this program, which ends the viewer
        )
        try:
            for port in ports:
                self._wait_for(reached, port)
        except BaseException:
            self._end()
            raise

    def __exit__(self, kind: object, *raised: object) -> None:
        if kind is not None or self.is_page:
            self._end()
        self._log.close()

    def is_open(self) -> bool:
        """Return False if the user has closed the window; raise Failure if the viewer ended by an error."""
        if self._process.poll() is None:
            return True
        if self._process.returncode == 0:
            return False
        raise Failure(f"the viewer ended{self._reason()}: {AGAIN if self.is_page else INSTEAD}")

    def _wait_for(self, host: str, port: int) -> None:
        """Wait until it listens."""
        deadline = time.monotonic() + START_S
        while self.is_open():
            with contextlib.suppress(OSError), socket.create_connection((host, port), timeout=1):
                return
            if time.monotonic() > deadline:
                raise Failure(f"the viewer does not start within {START_S:g} s{self._reason()}: {AGAIN}")
            time.sleep(0.02)
        raise Failure(f"the viewer ended at its start: {AGAIN}")

    def _end(self) -> None:
        self._process.terminate()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _reason(self) -> str:
        """Return the last error that the viewer printed, in brackets; "" without one."""
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").splitlines()
        errors = [NOISE.sub("", line).strip() for line in lines if line.startswith("Error")]
        return f" ({errors[-1]})" if errors else ""


def _program() -> str:
    """Return the path of Rerun's viewer; raise Failure if it is not installed."""
    folder = Path(load_rerun().__file__).parent.parent / "rerun_cli"
    for place in PLACES:
        if (folder / place).exists():
            return str(folder / place)
    if (path := shutil.which("rerun")) is not None:
        return path
    raise Failure(f"the viewer of Rerun is not installed: {INSTALL}")


def _free_port() -> int:
    with socket.socket() as one:
        one.bind((LOOPBACK, 0))
        return one.getsockname()[1]


def _require_free(host: str, port: int) -> None:
    """Raise InputError for an address of another computer, Failure for a port that cannot be used."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as one:
        if os.name == "posix":
            one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a connection that has just ended is no use
        try:
            one.bind((host, port))
        except OSError as error:
            if error.errno == errno.EADDRNOTAVAIL:
                raise InputError(f"--web-address {host} is no address of this computer: give one that is") from error
            why = "is in use" if error.errno == errno.EADDRINUSE else f"cannot be used ({error.strerror})"
            problem = f"port {port} of {host} {why}: give --web-address {host}:PORT, which also takes PORT + 1"
            raise Failure(problem) from error
