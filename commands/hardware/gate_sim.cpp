// SPDX-License-Identifier: Apache-2.0
// Simulates a mapped netlist of tactile_depth on frames, without delays, and in a window of clocks with delays too.
//
// Counts the transitions of each net. Verilator compiles a netlist of this size for longer than this program runs: one
// pass over the gates in order settles a clock. gate_sim.py writes standard input (32-bit words) and reads the output.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <queue>
#include <utility>
#include <vector>

namespace {

struct Gate {  // out = bit of `table` that the inputs select; delays of a rise and a fall of out in ps
  uint64_t table;
  int32_t out, count, in[6], rise[6], fall[6];
};

using List = std::vector<int32_t>;
using Values = std::vector<uint8_t>;  // of all nets

struct Memory {
  int32_t width;
  List write_en, write_address, write_data, read_en, read_address, read_data, words;  // words: bits at power-up
  int64_t reads = 0, writes = 0;
};

struct Design {  // in the order of the input
  int32_t nets;
  std::vector<Gate> logic, registers;
  std::vector<Memory> memories;
  int32_t rst, tvalid, tlast, tuser;
  List tdata;
  int32_t tready, depth_valid;
  List depth;
  int32_t columns, frames;
  List pixels, codes;
  int32_t window_start, window_size, other_ps;  // other_ps: delay of memories and inputs
  List high;                                    // registers that begin with 1
};

int32_t word() {
  int32_t value;
  if (std::fread(&value, sizeof value, 1, stdin) != 1) std::exit(3);
  return value;
}

List list() {
  List values(word());
  for (auto& value : values) value = word();
  return values;
}

std::vector<Gate> gates() {
  std::vector<Gate> all(word());
  for (auto& gate : all) {
    const uint64_t low = static_cast<uint32_t>(word());
    gate.table = low | static_cast<uint64_t>(static_cast<uint32_t>(word())) << 32;
    gate.out = word();
    gate.count = word();
    for (auto* row : {gate.in, gate.rise, gate.fall})
      for (int i = 0; i < 6; i++) row[i] = word();
  }
  return all;
}

std::vector<Memory> memories() {
  std::vector<Memory> all(word());
  for (auto& memory : all) memory = {word(), list(), list(), list(), list(), list(), list(), list()};
  return all;
}

uint8_t evaluate(const Gate& gate, const Values& value) {
  unsigned index = 0;
  for (int i = 0; i < gate.count; i++) index |= static_cast<unsigned>(value[gate.in[i]]) << i;
  return static_cast<uint8_t>(gate.table >> index & 1);
}

uint64_t number(const List& bus, const Values& value) {
  uint64_t sum = 0;
  for (size_t i = 0; i < bus.size(); i++) sum |= static_cast<uint64_t>(value[bus[i]]) << i;
  return sum;
}

// Nets that a clock edge changes, with their values after it; memories are read and written.
std::vector<std::pair<int32_t, uint8_t>> edge(Design& design, const Values& value) {
  std::vector<std::pair<int32_t, uint8_t>> following;
  for (const auto& gate : design.registers) following.emplace_back(gate.out, evaluate(gate, value));
  for (auto& memory : design.memories) {
    if (value[memory.read_en[0]]) {
      const uint64_t from = number(memory.read_address, value) * memory.width;
      for (int32_t i = 0; i < memory.width; i++)
        following.emplace_back(memory.read_data[i], from + i < memory.words.size() ? memory.words[from + i] : 0);
      memory.reads++;
    }
    if (!memory.write_en.empty() && value[memory.write_en[0]]) {
      const uint64_t to = number(memory.write_address, value) * memory.width;
      for (int32_t i = 0; i < memory.width; i++)
        if (to + i < memory.words.size()) memory.words[to + i] = value[memory.write_data[i]];
      memory.writes++;
    }
  }
  return following;
}

// Event-driven simulation of single clocks with inertial delays: a pulse shorter than the delay of a gate is lost.
class Window {
 public:
  std::vector<uint32_t> without, with;  // transitions of each net without and with delays
  int64_t wrong = 0;                    // clocks that settled otherwise than without delays

  explicit Window(const Design& design)
      : without(design.nets), with(design.nets), logic_(design.logic), readers_(design.nets),
        source_(design.nets, true), rise_(design.nets, design.other_ps), fall_(rise_), serial_(design.nets) {
    for (size_t g = 0; g < logic_.size(); g++) {
      source_[logic_[g].out] = false;
      for (int i = 0; i < logic_[g].count; i++) readers_[logic_[g].in[i]].emplace_back(g, i);
    }
    for (const auto& gate : design.registers) {  // the delay from the clock
      rise_[gate.out] = gate.rise[0];
      fall_[gate.out] = gate.fall[0];
    }
  }

  // From the settled state `before` a clock edge to the settled state `after`.
  void clock(const Values& before, const Values& after) {
    value_ = target_ = before;
    for (size_t net = 0; net < before.size(); net++) {
      without[net] += before[net] != after[net];
      if (source_[net]) schedule(0, static_cast<int32_t>(net), after[net], rise_[net], fall_[net]);
    }
    while (!queue_.empty()) {
      const Event event = queue_.top();
      queue_.pop();
      if (event.serial != serial_[event.net]) continue;  // another event has replaced it
      value_[event.net] = target_[event.net];
      with[event.net]++;
      for (const auto& [g, i] : readers_[event.net]) {
        const Gate& gate = logic_[g];
        schedule(event.time, gate.out, evaluate(gate, value_), gate.rise[i], gate.fall[i]);
      }
    }
    wrong += value_ != after;
  }

 private:
  struct Event {
    int64_t time;
    int32_t net;
    uint32_t serial;
    bool operator<(const Event& other) const { return time > other.time; }  // the earliest is on top
  };

  void schedule(int64_t now, int32_t net, uint8_t bit, int32_t rise, int32_t fall) {
    if (bit == target_[net]) return;
    target_[net] = bit;
    serial_[net]++;
    if (bit != value_[net]) queue_.push({now + (bit ? rise : fall), net, serial_[net]});
  }

  const std::vector<Gate>& logic_;
  std::vector<std::vector<std::pair<int32_t, int>>> readers_;  // gate and input
  std::vector<bool> source_;  // not driven by logic
  List rise_, fall_;
  Values value_, target_;  // target: the value after the pending event
  std::vector<uint32_t> serial_;
  std::priority_queue<Event> queue_;
};

}  // namespace

int main() {
  Design d{word(), gates(), gates(), memories(), word(), word(), word(), word(), list(), word(), word(), list(),
           word(), word(), list(), list(), word(), word(), word(), list()};
  Window window(d);
  Values value(d.nets, 0), before;
  std::vector<uint32_t> toggles(d.nets, 0);
  const auto set = [&](int32_t net, uint8_t bit) {
    toggles[net] += value[net] ^ bit;
    value[net] = bit;
  };
  value[1] = 1;
  for (const int32_t net : d.high) value[net] = 1;
  const int64_t size = static_cast<int64_t>(d.pixels.size());
  int64_t sent = 0, received = 0, wrong = 0, clock_of_last = -1;
  for (int64_t clock = 0;; clock++) {
    if (clock > (d.frames + 2) * size + 100000) return 4;  // it takes no pixels
    const bool reset = clock < 8;
    set(d.rst, reset);
    set(d.tvalid, !reset && sent < d.frames * size);
    set(d.tlast, sent % d.columns == d.columns - 1);
    set(d.tuser, sent % size == 0);
    for (size_t i = 0; i < d.tdata.size(); i++) set(d.tdata[i], d.pixels[sent % size] >> i & 1);
    for (const auto& gate : d.logic) set(gate.out, evaluate(gate, value));

    if (!reset) {
      if (value[d.depth_valid]) wrong += number(d.depth, value) != static_cast<uint32_t>(d.codes[received++ % d.codes.size()]);
      if (clock_of_last >= 0) {
        clock_of_last++;
      } else if (sent >= (d.frames - 1) * size) {  // the last frame begins: count from here
        clock_of_last = 0;
        toggles.assign(d.nets, 0);
        for (auto& memory : d.memories) memory.reads = memory.writes = 0;
      }
      const int64_t place = clock_of_last - d.window_start;
      if (place >= 0 && place < d.window_size) window.clock(before, value);
      if (clock_of_last >= 0) before = value;
      if (clock_of_last == size) break;
      if (value[d.tvalid] && value[d.tready]) sent++;
    }
    for (const auto& [net, bit] : edge(d, value)) set(net, bit);
  }

  std::vector<int64_t> output{received, wrong, clock_of_last, window.wrong};
  for (const auto& memory : d.memories) output.insert(output.end(), {memory.reads, memory.writes});
  for (const auto* counts : {&toggles, &window.without, &window.with})
    output.insert(output.end(), counts->begin(), counts->end());
  std::fwrite(output.data(), sizeof output[0], output.size(), stdout);
  return 0;
}
