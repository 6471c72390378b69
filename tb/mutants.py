# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of the testbenches that follow it once for every mutant, each in a fork of the simulator.

The device is a netlist with all mutants in it; its register `mutsel` says which one is alive, 0 being none. To start a
simulator and import its testbench takes longer than most mutants live, so one process does that and then forks: the
child sets the register, runs the tests and ends with the first that fails. Environment: MUTANT_NUMBERS, those to run,
with commas; MUTANT_JOBS, how many at a time; MUTANT_RESULTS, the file that results are added to, a line each.
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

SURVIVED, KILLED = 0, 1  # exit status of a child
# A mutant that takes this many times as long as the device itself, and so many seconds, hangs.
HANG_FACTOR, HANG_SECONDS = 6, 10
REASON_LENGTH = 240


class Child:
    """A fork that runs the tests: its process, what it says on the way out, when it began."""

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
    """End this process as soon as a test fails, or when all have passed."""
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
    """Returns the Child in the parent, None in the child."""
    read, write = os.pipe()
    process = os.fork()
    if process:
        os.close(write)
        return Child(number, process, read)
    os.close(read)
    if number:  # the device itself says in the log what it fails in
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
    if seconds:
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))  # at the first a signal, at the second the end
    end_with_the_first_failure(write)
    return None


def wait(children: Any) -> Any:
    """Wait for one of them to end; it leaves the set. Returns its result."""
    process, status, usage = os.wait4(-1, 0)
    (child,) = (child for child in children if child.process == process)
    children.remove(child)
    return child.result(status, usage)


def children(numbers: Any, jobs: int, keep: Any) -> Any:
    """In the parent: returns None when all have run. In a child: returns its number at once."""
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
    numbers = [int(number) for number in os.environ["MUTANT_NUMBERS"].split(",") if number]
    with Path(os.environ["MUTANT_RESULTS"]).open("a", buffering=1) as results:
        number = children(
            numbers,
            int(os.environ["MUTANT_JOBS"]),
            lambda result: results.write(json.dumps(result) + "\n"),
        )
    if number is None:
        cocotb.regression._manager_inst._test_queue.clear()  # the children have run them
        return
    dut.mutsel.value = number
    await Timer(1, "step")
