# SPDX-License-Identifier: Apache-2.0
"""Runner that plays the testbenches listed after it once for every mutant, each in a fork of the simulator.

The device is a netlist with all mutants; its register `mutsel` selects one, and 0 selects none. Starting a simulator
and importing its testbench takes longer than most mutants need to fail, so one process does both and then forks. The
child sets the register, runs the tests and ends with the first that fails. The settings of the run name `mutants`: the
`numbers` to run, `jobs`, the children at a time, and `results`, the file that gets a line per result.
"""

import json
import os
import resource
import signal
import time
from pathlib import Path
from typing import Any

import cocotb
import cocotb.regression
from cocotb.triggers import Timer

from tb.settings import RUN

SURVIVED, KILLED = 0, 1  # exit status of a child
# A mutant hangs if it takes this many times as long as the unchanged device, plus so many seconds.
HANG_FACTOR, HANG_SECONDS = 6, 10
REASON_LENGTH = 240


class Child:
    """Fork that runs the tests: its process, the file of its message, and the time of its start."""

    def __init__(self, number: int, process: Any, pipe: Any) -> None:
        self.number, self.process, self.pipe = number, process, pipe
        self.began = time.monotonic()

    def result(self, status: Any, usage: Any) -> dict[Any, Any]:
        with os.fdopen(self.pipe) as pipe:
            reason = pipe.read()
        if os.WIFEXITED(status) and os.WEXITSTATUS(status) in (SURVIVED, KILLED):
            verdict = "killed" if os.WEXITSTATUS(status) == KILLED else "survived"
        elif os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU:
            verdict, reason = "killed", "hangs"
        else:
            raise RuntimeError(f"mutant {self.number}: the simulator ended with status {status:#x}")
        seconds = usage.ru_utime + usage.ru_stime
        return {"mutant": self.number, "verdict": verdict, "reason": reason, "seconds": round(seconds, 2)}


def end_with_the_first_failure(pipe: Any) -> None:
    """Make this process end as soon as a test fails, or when all have passed."""
    manager: Any = cocotb.regression.RegressionManager

    def failed(self: Any, *_: Any, result: Any = None, **__: Any) -> None:
        reason = " ".join(f"{self._test.name}: {type(result).__name__}: {result}".split())
        os.write(pipe, reason[:REASON_LENGTH].encode())
        os._exit(KILLED)

    def passed(_: Any) -> None:
        os._exit(SURVIVED)

    manager._record_test_failed = failed  # cocotb has no public hook for either; its version is pinned
    manager._tear_down = passed


def fork(number: int, seconds: Any) -> Any:
    """Return the Child in the parent, None in the child."""
    read, write = os.pipe()
    process = os.fork()
    if process:
        os.close(write)
        return Child(number, process, read)
    os.close(read)
    if number:  # the unchanged device writes its failures to the log
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
    if seconds:
        # After the first time the system sends a signal, after the second it ends the process.
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    end_with_the_first_failure(write)
    return None


def wait(children: Any) -> Any:
    """Wait until one child ends; remove it from the set and return its result."""
    process, status, usage = os.wait4(-1, 0)
    (child,) = (child for child in children if child.process == process)
    children.remove(child)
    return child.result(status, usage)


def children(numbers: Any, jobs: int, keep: Any) -> Any:
    """Return the number of the mutant in a child, at once; return None in the parent when all children have ended."""
    running = {fork(0, 0)}
    if None in running:
        return 0
    golden = wait(running)
    keep(golden)
    if golden["verdict"] != "survived":
        return None
    seconds = int(HANG_FACTOR * golden["seconds"]) + HANG_SECONDS
    for number in numbers:
        if len(running) == jobs:
            keep(wait(running))
        child = fork(number, seconds)
        if child is None:
            return number
        running.add(child)
    while running:
        keep(wait(running))
    return None


@cocotb.test(stage=-1)  # before every test of a testbench, whatever their order
async def every_mutant(dut: Any) -> None:
    wanted = RUN.mutants
    with Path(wanted["results"]).open("a", buffering=1) as results:
        number = children(wanted["numbers"], wanted["jobs"], lambda result: results.write(json.dumps(result) + "\n"))
    if number is None:
        cocotb.regression._manager_inst._test_queue.clear()  # the children have run the tests
        return
    dut.mutsel.value = number
    await Timer(1, "step")
