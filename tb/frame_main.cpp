// SPDX-License-Identifier: Apache-2.0
// Simulates frame_bench for cocotb, and clocks it itself while it plays: a clock that Python drives takes as long as
// the whole design.
//
// From `go` to `done` the clock goes on with the period that Python's clock had, unless something that Python waits for
// is due. In between, and else always, time moves from one event of cocotb to the next.

#include <algorithm>
#include <cstdint>

#include "Vtop.h"
#include "verilated.h"
#include "verilated_vpi.h"

extern "C" void vlog_startup_routines_bootstrap();  // of cocotb

namespace {

constexpr uint64_t kNever = ~0ULL;
uint64_t now = 0;  // in units of the time precision

void CallValueCallbacks() {
  while (VerilatedVpi::callValueCbs()) {
  }
}

// Evaluates what the events of this time changed, until nothing changes any more.
void Settle(Vtop& top) {
  do {
    top.eval();
    VerilatedVpi::clearEvalNeeded();
    VerilatedVpi::doInertialPuts();
    CallValueCallbacks();
    if (!VerilatedVpi::evalNeeded()) {
      VerilatedVpi::callCbs(cbReadWriteSynch);
      VerilatedVpi::doInertialPuts();
      CallValueCallbacks();
    }
  } while (VerilatedVpi::evalNeeded());
  VerilatedVpi::callCbs(cbReadOnlySynch);
}

// Clocks the bench until it is done, or as long as nothing is due; ends with the clock low.
void Play(Vtop& top, uint64_t half_period) {
  while (!Verilated::gotFinish() && !top.done && now + 2 * half_period < VerilatedVpi::cbNextDeadline()) {
    for (const uint8_t level : {1, 0}) {
      now += half_period;
      top.clk = level;
      top.eval();
    }
  }
}

}  // namespace

double sc_time_stamp() { return static_cast<double>(now); }

int main(int argc, char** argv) {
  Verilated::commandArgs(argc, argv);
  Vtop top("");
  Verilated::fatalOnVpiError(false);
  vlog_startup_routines_bootstrap();
  VerilatedVpi::callCbs(cbStartOfSimulation);
  CallValueCallbacks();

  uint64_t edge = 0, half_period = kNever;  // the last edge of Python's clock
  uint8_t level = 0;
  while (!Verilated::gotFinish()) {
    Settle(top);
    if (top.clk != level) {
      half_period = now - edge;
      edge = now;
      level = top.clk;
    }
    if (top.go && !top.done && !level && half_period != kNever) {
      Play(top, half_period);
      Settle(top);
    }
    const uint64_t next = VerilatedVpi::cbNextDeadline();
    if (next == kNever) break;
    now = std::max(now, next);
    VerilatedVpi::callCbs(cbNextSimTime);
    CallValueCallbacks();
    VerilatedVpi::callTimedCbs();
    CallValueCallbacks();
  }
  top.final();
  VerilatedVpi::callCbs(cbEndOfSimulation);
  return Verilated::threadContextp()->errorCount() > 0 ? 1 : 0;
}
