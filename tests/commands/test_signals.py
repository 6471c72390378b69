# SPDX-License-Identifier: Apache-2.0
"""SIGINT, SIGTERM and SIGHUP end a command: one line, its child processes and its temporary folder gone."""

import contextlib
import os
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import psutil
import pytest

from commands.common import signals, variables
from commands.common.repository import ROOT
from tactile_depth.base import interruption

ENDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated by SIGTERM", signal.SIGHUP: "terminated by SIGHUP"}
LONG = ["N=64", "SIM=icarus", "REPEAT=1000"]  # minutes
WAIT_S = 60


def started(command: Any, folder: Path) -> Any:
    """Start a command in its own session, with the default handling of signals."""

    def defaults() -> None:
        for number in ENDS:
            signal.signal(number, signal.SIG_DFL)

    models = str(ROOT / "models")
    outside = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}  # a build sets some
    return subprocess.Popen(
        command,
        cwd=folder,
        env=outside | {"PYTHONPATH": os.pathsep.join([str(ROOT), models])},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=defaults,
    )


def members(session: Any) -> Any:
    """Return the command lines of the living processes of a session."""
    lines = {}
    for process in psutil.process_iter():
        with contextlib.suppress(OSError, psutil.NoSuchProcess):  # it has ended
            if os.getsid(process.pid) == session and process.status() != psutil.STATUS_ZOMBIE:
                lines[process.pid] = " ".join(process.cmdline())
    return lines


def wait_for(condition: Any, what: Any) -> None:
    deadline = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < deadline, f"{what} did not come within {WAIT_S} s"
        time.sleep(0.05)


def wait_for_the_simulator(process: Any) -> None:
    """Wait until vvp runs; if the command ends earlier, fail with its output."""

    def running() -> Any:
        assert process.poll() is None, process.stderr.read()
        return any("vvp" in line for line in members(process.pid).values())

    wait_for(running, "the simulator")


def told(errors: str) -> list[str]:
    """Return the lines on stderr without those of make itself, and without the notice of a first build."""
    return [line for line in errors.splitlines() if not line.startswith(("make: ***", "building "))]


@pytest.mark.parametrize("number", ENDS, ids=lambda number: number.name)
def test_a_signal_ends_the_command(tmp_path: Path, number: Any) -> None:
    process = started([sys.executable, "-m", "commands", "sim", *LONG, f"OUT={tmp_path / 'a' / 'out'}"], ROOT)
    wait_for_the_simulator(process)
    os.kill(process.pid, number)
    _, errors = process.communicate(timeout=WAIT_S)
    assert process.returncode == 128 + number
    assert told(errors) == [f"make sim: {ENDS[number]}"]
    assert members(process.pid) == {}
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def makefile(tmp_path: Path) -> Any:
    """Return a folder with the Makefile and a complete virtual environment that runs the Python of this test."""
    folder = tmp_path / "place"
    python = folder / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} "$@"\n')
    python.chmod(0o755)
    shutil.copy(ROOT / "Makefile", folder)
    for requirements in ROOT.glob("requirements*.txt"):
        (folder / requirements.name).touch()
    (folder / ".venv" / "complete").touch()
    return folder


@pytest.mark.parametrize(
    ("kill", "number"), [*((os.killpg, number) for number in ENDS), (os.kill, signal.SIGTERM)], ids=str
)
def test_a_signal_to_the_terminal_or_to_make_alone_ends_make_and_its_command(
    tmp_path: Path, makefile: Any, kill: Any, number: Any
) -> None:
    process = started(["make", "sim", *LONG, f"OUT={tmp_path / 'a' / 'out'}"], makefile)
    wait_for_the_simulator(process)
    kill(process.pid, number)
    _, errors = process.communicate(timeout=WAIT_S)
    assert process.returncode != 0
    assert told(errors) == [f"make sim: {ENDS[number]}"] or kill is os.kill
    assert f"make sim: {ENDS[number]}\n" in errors
    wait_for(lambda: members(process.pid) == {}, "the end of every process")
    assert list(tmp_path.iterdir()) == [makefile]


@pytest.mark.parametrize("outer", [["make"], [sys.executable, "-m", "commands"]], ids=["make", "command"])
def test_5_s_after_sigkill_no_process_of_the_run_lives(tmp_path: Path, makefile: Path, outer: list[str]) -> None:
    configuration = ["N=64", "ROWS=24", "SOLVER=tridiagonal", f"DATA_WIDTH={22 + len(outer)}"]  # built by no other test
    process = started([*outer, "sim", *configuration, "SIM=verilator", f"OUT={tmp_path / 'out'}"], makefile)
    wait_for(lambda: any("cc1plus" in line for line in members(process.pid).values()), "the compiler")
    make, command = 0, process.pid
    if outer == ["make"]:
        make, (command,) = process.pid, (child.pid for child in psutil.Process(process.pid).children())
    run = f"{os.environ.get(signals.RUN, '')}/{make}-{command}"
    assert len([*signals.of_run(run)]) >= 3  # make, c++ and cc1plus at least
    process.kill()
    end = time.monotonic() + 5
    while (left := [*signals.of_run(run), *members(process.pid)]) and time.monotonic() < end:
        time.sleep(0.1)
    assert left == []


def test_a_signal_while_modules_are_imported_prints_one_line(tmp_path: Path) -> None:
    process = started([sys.executable, "-X", "importtime", "-m", "commands", "sim"], ROOT)
    lines = []
    while "numpy" not in (line := process.stderr.readline()):
        lines.append(line)
    os.kill(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=WAIT_S)
    assert process.returncode == 130
    assert [line for line in errors.splitlines() if not line.startswith("import time:")] == ["make sim: interrupted"]


def test_an_ignored_signal_stays_ignored_and_handlers_come_back() -> None:
    original = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        before = [signal.getsignal(number) for number in ENDS]
        with interruption.stoppable(signals.end_children):
            assert [signal.getsignal(number) for number in ENDS] != before
            os.kill(os.getpid(), signal.SIGHUP)
        assert [signal.getsignal(number) for number in ENDS] == before
    finally:
        signal.signal(signal.SIGHUP, original)


def test_a_second_signal_does_not_cut_the_cleaning_up_short() -> None:
    cleaned = []

    def command() -> None:
        try:
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(WAIT_S)
        finally:
            os.kill(os.getpid(), signal.SIGTERM)
            cleaned.append(True)

    with pytest.raises(SystemExit) as ended, variables.reported("sim"):
        command()
    assert ended.value.code == 128 + signal.SIGTERM
    assert cleaned == [True]


def test_grandchildren_end_and_those_that_ignore_sigterm_too() -> None:
    inner = (
        "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print('up', flush=True); time.sleep(99)"
    )
    outer = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {inner!r}])"
    with subprocess.Popen([sys.executable, "-c", outer], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "up\n"  # type: ignore[union-attr]
        assert len(signals.living()) == 2
        signals.end_children()
        assert signals.living() == []
        assert process.wait(WAIT_S) == -signal.SIGTERM


def test_a_child_of_a_child_that_ends_first_ends_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """A shell that starts a program while it is ended leaves it without a parent, as iverilog may leave ivl."""
    monkeypatch.setenv(signals.RUN, f"{os.environ.get(signals.RUN, '')}/0-{os.getpid()}")
    shell = "trap 'sleep 99 & exit 0' TERM; echo up; while :; do sleep 0.01; done"
    with subprocess.Popen(["sh", "-c", shell], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "up\n"  # type: ignore[union-attr]
        signals.end_children()
        assert [*signals.of_run(os.environ[signals.RUN])] == []
        assert process.wait(WAIT_S) == 0


def test_calls_of_a_pool_that_have_not_begun_are_cancelled() -> None:
    running, calls = threading.Event(), []

    def call(number: int) -> None:
        calls.append(number)
        running.set()
        subprocess.run(["sleep", str(WAIT_S)], check=False)

    def command() -> None:
        with signals.threads(1) as pool:
            for number in range(3):
                pool.submit(call, number)
            running.wait()
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(WAIT_S)

    begun = time.monotonic()
    with pytest.raises(SystemExit), variables.reported("lint"):
        command()
    assert calls == [0]
    assert signals.living() == []
    assert time.monotonic() - begun < WAIT_S / 2
