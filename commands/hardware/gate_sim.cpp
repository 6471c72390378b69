// SPDX-License-Identifier: Apache-2.0
// Frames through a mapped netlist of tactile_depth, gate by gate without delays, and how often each net toggles.
//
// Verilator compiles a netlist of this size for longer than this runs it. One pass over the gates in order settles a clock.
// commands/hardware/gate_sim.py writes what this reads, from standard input, 32-bit words, and reads what this writes.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

struct Gate {  // out = bit of `table` that the inputs choose
  uint64_t table;
  int32_t out, count, in[6];
};

struct Memory {
  int32_t width;
  std::vector<int32_t> write_en, write_address, write_data, read_en, read_address, read_data;
  std::vector<uint8_t> words;
  uint32_t reads, writes;
  std::vector<uint8_t> taken;  // what it shows after the edge
  bool reading;
};

int32_t word() {
  int32_t value;
  if (std::fread(&value, sizeof value, 1, stdin) != 1) std::exit(3);
  return value;
}

std::vector<int32_t> list() {
  std::vector<int32_t> values(word());
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
    for (auto& net : gate.in) net = word();
  }
  return all;
}

}  // namespace

int main() {
  const int32_t nets = word();
  const auto logic = gates();
  const auto registers = gates();
  std::vector<Memory> memories(word());
  for (auto& memory : memories) {
    memory.width = word();
    memory.write_en = list();
    memory.write_address = list();
    memory.write_data = list();
    memory.read_en = list();
    memory.read_address = list();
    memory.read_data = list();
    const auto bits = list();
    memory.words.assign(bits.begin(), bits.end());
    memory.taken.resize(memory.width);
  }
  const auto ones = list();  // inputs that stay at one
  const int32_t rst = word(), tvalid = word(), tlast = word(), tuser = word();
  const auto tdata = list();
  const int32_t tready = word(), depth_valid = word();
  const auto depth = list();
  const int32_t columns = word(), frames = word();
  const auto pixels = list();
  const auto codes = list();
  const int32_t sample = word(), samples = word();
  const auto watched = list();

  std::vector<uint8_t> value(nets, 0), following(registers.size());
  std::vector<uint32_t> toggles(nets, 0);
  const auto set = [&](int32_t net, uint8_t bit) {
    toggles[net] += value[net] ^ bit;
    value[net] = bit;
  };
  const auto evaluate = [&](const Gate& gate) {
    unsigned index = 0;
    for (int i = 0; i < gate.count; i++) index |= static_cast<unsigned>(value[gate.in[i]]) << i;
    return static_cast<uint8_t>(gate.table >> index & 1);
  };
  const auto number = [&](const std::vector<int32_t>& bus) {
    uint64_t sum = 0;
    for (size_t i = 0; i < bus.size(); i++) sum |= static_cast<uint64_t>(value[bus[i]]) << i;
    return sum;
  };

  value[1] = 1;
  for (const auto net : ones) value[net] = 1;
  const int64_t size = static_cast<int64_t>(pixels.size());
  int64_t sent = 0, seen = 0, wrong = 0, last_at = -1;
  std::vector<char> line(watched.size() + 1, '\n');
  FILE* lines = std::fopen("watched.txt", "wb");
  if (!lines) return 3;
  for (int64_t clock = 0;; clock++) {
    if (clock > (frames + 2) * size + 100000) return 4;  // it takes no pixels
    const bool reset = clock < 8;
    set(rst, reset);
    set(tvalid, !reset && sent < frames * size);
    set(tlast, sent % columns == columns - 1);
    set(tuser, sent % size == 0);
    for (size_t i = 0; i < tdata.size(); i++) set(tdata[i], pixels[sent % size] >> i & 1);
    for (const auto& gate : logic) set(gate.out, evaluate(gate));

    if (!reset) {
      if (value[depth_valid]) {
        wrong += number(depth) != static_cast<uint32_t>(codes[seen % size]);
        seen++;
      }
      if (last_at < 0 && sent >= (frames - 1) * size) {  // the last frame begins: count from here
        last_at = 0;
        toggles.assign(nets, 0);
        for (auto& memory : memories) memory.reads = memory.writes = 0;
      } else if (last_at >= 0) {
        last_at++;
      }
      if (last_at == size) break;
      if (last_at >= sample && last_at < sample + samples) {
        for (size_t i = 0; i < watched.size(); i++) line[i] = static_cast<char>('0' + value[watched[i]]);
        std::fwrite(line.data(), 1, line.size(), lines);
      }
      if (value[tvalid] && value[tready]) sent++;
    }

    for (size_t i = 0; i < registers.size(); i++) following[i] = evaluate(registers[i]);
    for (auto& memory : memories) {
      memory.reading = value[memory.read_en[0]];
      if (memory.reading) {
        const uint64_t from = number(memory.read_address) * memory.width;
        for (int32_t i = 0; i < memory.width; i++) memory.taken[i] = from + i < memory.words.size() ? memory.words[from + i] : 0;
        memory.reads++;
      }
      if (!memory.write_en.empty() && value[memory.write_en[0]]) {
        const uint64_t to = number(memory.write_address) * memory.width;
        for (int32_t i = 0; i < memory.width; i++)
          if (to + i < memory.words.size()) memory.words[to + i] = value[memory.write_data[i]];
        memory.writes++;
      }
    }
    for (size_t i = 0; i < registers.size(); i++) set(registers[i].out, following[i]);
    for (auto& memory : memories)
      if (memory.reading)
        for (int32_t i = 0; i < memory.width; i++) set(memory.read_data[i], memory.taken[i]);
  }
  std::fclose(lines);

  FILE* counted = std::fopen("toggles.bin", "wb");
  if (!counted) return 3;
  for (auto& memory : memories) {
    std::fwrite(&memory.reads, sizeof memory.reads, 1, counted);
    std::fwrite(&memory.writes, sizeof memory.writes, 1, counted);
  }
  std::fwrite(toggles.data(), sizeof toggles[0], toggles.size(), counted);
  std::fclose(counted);
  std::printf("%lld %lld %lld\n", static_cast<long long>(seen), static_cast<long long>(wrong), static_cast<long long>(last_at));
  return 0;
}
