// SPDX-License-Identifier: Apache-2.0
// Simulates a device with a host link: standard input is the line to it, standard output the line from it.
//
// The device is tb/device_bench.sv, whose line carries a byte a clock; with PINS defined it is the top of the ULX3S, at
// the pins of its serial port. SIGUSR1 resets it; the end of the input ends the simulation. When no byte has moved for
// as many clocks as the first argument says, time stands still until one comes.

#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>

#include "Vtop.h"
#include "verilated.h"

namespace {

constexpr int kResetClocks = 8;
constexpr int kPollClocks = 64;        // between two looks at the input
constexpr size_t kBlock = 4096;        // bytes of a read or write
volatile std::sig_atomic_t asked_reset = 0;

class Line {
 public:
  // Read what has come; with `wait` until something comes. False: the input has ended.
  bool Read(bool wait) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const int ready = poll(&input, 1, wait ? -1 : 0);
    if (ready <= 0) return true;  // nothing, or a signal
    uint8_t block[kBlock];
    const ssize_t count = read(STDIN_FILENO, block, sizeof block);
    if (count <= 0) return count < 0;
    in_.insert(in_.end(), block, block + count);
    return true;
  }

  void Flush() {
    for (size_t sent = 0; sent < out_.size();) {
      const ssize_t count = write(STDOUT_FILENO, out_.data() + sent, out_.size() - sent);
      if (count < 0) std::exit(0);  // nobody listens any more
      sent += static_cast<size_t>(count);
    }
    out_.clear();
  }

  bool empty() const { return in_.empty(); }
  uint8_t front() const { return in_.front(); }
  void Pop() { in_.pop_front(); }
  void Push(uint8_t byte) {
    out_.push_back(static_cast<char>(byte));
    if (out_.size() >= kBlock) Flush();
  }

 private:
  std::deque<uint8_t> in_;
  std::string out_;
};

#ifdef PINS

class Port {  // of the ULX3S
 public:
  explicit Port(Vtop& top) : top_(top) { top.ftdi_txd = 1; }
  void Clock() {
    top_.clk_25mhz = 0;
    top_.eval();
    top_.clk_25mhz = 1;
    top_.eval();
  }
  void Reset(bool on, bool) { top_.btn = on; }
  // Move bits for one clock. True: something moves.
  bool Move(Line& line) {
    if (send_clocks_ == 0 && !line.empty()) {
      send_word_ = 1u << 9 | line.front() << 1;
      line.Pop();
      send_clocks_ = kBits * BIT_CLOCKS;
    }
    const int place = kBits - (send_clocks_ + BIT_CLOCKS - 1) / BIT_CLOCKS;
    top_.ftdi_txd = send_clocks_ > 0 ? send_word_ >> place & 1 : 1;
    if (send_clocks_ > 0) send_clocks_--;
    Clock();
    if (take_clocks_ == 0) {
      if (!top_.ftdi_rxd) take_clocks_ = 1;
    } else {
      const int bit = take_clocks_ / BIT_CLOCKS;
      if (take_clocks_ % BIT_CLOCKS == BIT_CLOCKS / 2) take_word_ = take_word_ >> 1 | top_.ftdi_rxd << (kBits - 1);
      take_clocks_++;
      if (bit == kBits - 1 && take_clocks_ % BIT_CLOCKS > BIT_CLOCKS / 2) {
        take_clocks_ = 0;
        if (take_word_ >> (kBits - 1) & 1) line.Push(take_word_ >> 1 & 0xFF);
      }
    }
    return send_clocks_ > 0 || take_clocks_ > 0;
  }

 private:
  static constexpr int kBits = 10;
  Vtop& top_;
  int send_clocks_ = 0, take_clocks_ = 0;
  unsigned send_word_ = 0, take_word_ = 0;
};

#else

class Port {  // of device_bench
 public:
  explicit Port(Vtop& top) : top_(top) {}
  void Clock() {
    top_.clk = 0;
    top_.eval();
    top_.clk = 1;
    top_.eval();
  }
  void Reset(bool on, bool power_up) {
    top_.rst = on;
    top_.cold_rst = on && power_up;
  }
  bool Move(Line& line) {
    top_.in_valid = !line.empty();
    if (top_.in_valid) top_.in_data = line.front();
    top_.clk = 0;
    top_.eval();
    const bool taken = top_.in_valid && top_.in_ready, given = top_.out_valid;
    if (taken) line.Pop();
    if (given) line.Push(top_.out_data);
    top_.clk = 1;
    top_.eval();
    return taken || given;
  }

 private:
  Vtop& top_;
};

#endif

}  // namespace

int main(int argc, char** argv) {
  Verilated::commandArgs(argc, argv);
  std::signal(SIGPIPE, SIG_IGN);
  struct sigaction action {};
  action.sa_handler = [](int) { asked_reset = 1; };
  sigaction(SIGUSR1, &action, nullptr);  // without SA_RESTART: it wakes poll
  const long idle_limit = argc > 1 ? std::atol(argv[1]) : 1L << 20;

  Vtop top;
  Port port(top);
  Line line;
  const auto reset = [&](bool power_up) {
    port.Reset(true, power_up);
    for (int clock = 0; clock < kResetClocks; clock++) port.Clock();
    port.Reset(false, power_up);
  };
  reset(true);
  std::fputs("ready\n", stderr);

  long idle = 0;
  for (bool open = true; open || idle < idle_limit;) {
    if (asked_reset) {
      asked_reset = 0;
      reset(false);
      idle = 0;
    }
    const bool wait = idle >= idle_limit;
    if (wait || idle % kPollClocks == 0) {
      if (idle) line.Flush();
      if (open && line.empty()) open = line.Read(wait);
      if (wait) idle = 0;
    }
    idle = port.Move(line) ? 1 : idle + 1;
  }
  line.Flush();
  top.final();
  return 0;
}
