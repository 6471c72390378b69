// SPDX-License-Identifier: Apache-2.0
// Flips bits of a pipeline while frames stream through, and compares its frames with those of a run without a flip.
//
// The top is a wrapper of one configuration; registers and words of memory are public in it. Standard input holds
// numbers, lists with their length before them:
//   places to invert before the first frame; places to record
//   writes of registers: how many, then offset and value of each; offset of STATUS
//   pixels of a frame; values a beat; bytes a value; frames before the one that enters as bits flip
//   words of s_axis: tuser in 25, tlast in 24, tdata below. They repeat without a pause
//   flips, up to the end: place, bit (numbered through all words), clock from the first of the frame that enters
// Without flips the output lists the places (scope, module, signal, bits and bytes of a word, words, and 1 if its bits
// stay flipped when all combinational logic has followed, else it is a copy), the codes of each frame and STATUS;
// history.bin gets the recorded places in each clock of the frame that enters.
// Otherwise a line for each flip: of the frames in flight, the next and the one after it, the largest change in codes
// and in % of its frame's peak, and 1 if a frame did not come whole; then what the run without a flip lacks: marks in
// word 12 of records, bits of STATUS (all ones: no answer).
//
// An experiment begins from the last state kept before the flip, and ends when all state is again that of the run
// without a flip. A bit that does not stay flipped ends the program.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "Vtop.h"
#include "Vtop__Syms.h"
#include "verilated.h"
#include "verilated_syms.h"

void Vtop___024root___eval_settle(Vtop___024root* root);  // of the model: all combinational logic, from the registers

double sc_time_stamp() { return 0; }

namespace {

constexpr int kResetClocks = 8, kAnswerClocks = 100;
constexpr int kFrames = 3;  // of the output: in flight, after, after that
constexpr std::size_t kMarksWord = 12;
constexpr uint32_t kMarks = 0xFFFF, kNoAnswer = 0xFFFFFFFF;

template <class T>
uint32_t ByteOf(const T& bus, int number) {
  return static_cast<uint32_t>(bus >> 8 * number) & 0xFF;
}
template <std::size_t N>
uint32_t ByteOf(const VlWide<N>& bus, int number) {
  return bus[number / 4] >> 8 * (number % 4) & 0xFF;
}

struct Beat {  // of a stream that leaves
  long clock;
  bool begins;  // a frame of depth, or a record
  std::vector<int32_t> words;
  bool last;
};

struct Packet {  // a frame of depth, or a record
  long clock;
  std::vector<int32_t> words;
  std::vector<bool> lasts;
};

struct Kept {  // at a clock
  std::vector<uint8_t> registers;
  long sent;
  std::size_t depth, records;
};

struct Place {
  std::string names;  // scope, module, signal
  uint8_t* data;
  long bits, bytes, words;  // bits and bytes of a word

  void Flip(long bit) const { data[bit / bits * bytes + bit % bits / 8] ^= static_cast<uint8_t>(1 << bit % bits % 8); }
  bool IsSet(long bit) const { return data[bit / bits * bytes + bit % bits / 8] >> bit % bits % 8 & 1; }
};

[[noreturn]] void Fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::exit(1);
}

long Number() {
  long number;
  if (!(std::cin >> number)) Fail("the input ends early");
  return number;
}

std::vector<long> Numbers() {
  std::vector<long> numbers(Number());
  for (auto& number : numbers) number = Number();
  return numbers;
}

class Run {
 public:
  Run(Vtop& top, const std::vector<Place>& places)
      : top_(top), places_(places), inverted_(Numbers()), recorded_(Numbers()) {
    for (long left = Number(); left > 0; left--) {
      const long offset = Number();
      writes_.emplace_back(offset, Number());
    }
    status_ = Number();
    pixels_ = Number();
    lanes_ = static_cast<int>(Number());
    bytes_ = static_cast<int>(Number());
    before_ = Number();
    words_ = Numbers();
    period_ = std::max(32L, pixels_ / 64);
  }

  // Runs without a flip. `history`: takes the recorded places, and each clock is checked to leave nothing to settle.
  void Reference(std::FILE* history) {
    top_.m_axis_tready = top_.m_event_tready = top_.s_axil_bready = top_.s_axil_rready = 1;
    top_.s_axil_wstrb = 15;
    top_.rst = 1;
    for (int i = 0; i < kResetClocks; i++) Clock();
    top_.rst = 0;
    for (const auto& each : writes_) Write(each.first, each.second);
    for (const long number : inverted_) Invert(places_[number]);
    streams_ = true;
    long begun = 0;
    for (clock_ = -before_ * pixels_; end_ == 0 || clock_ < end_; Clock()) {
      if (clock_ > 20 * pixels_ + 100000) Fail("no depth comes");
      if (clock_ == 0 && sent_ != before_ * pixels_) Fail("it does not take a pixel a clock");
      if (clock_ >= 0 && clock_ % period_ == 0) kept_.push_back(Keep());
      begun += !depth_.empty() && depth_.back().clock == clock_ - 1 && depth_.back().begins;
      if (end_ == 0 && begun > before_ + kFrames) end_ = clock_ + pixels_ / 2;
      if (!history) continue;
      if (!IsSettled()) Fail("to settle the model changes it");
      if (clock_ < 0 || clock_ >= pixels_) continue;
      for (const long number : recorded_)
        std::fwrite(places_[number].data, places_[number].bytes, places_[number].words, history);
    }
    all_depth_ = depth_;
    all_records_ = records_;
    frames_ = Packets(depth_);
    frame_records_ = Packets(records_);
    no_flip_ = Status();
  }

  void PrintPlaces() {
    for (const auto& place : places_) {
      Restore(0);
      const std::vector<uint8_t> before(place.data, place.data + place.words * place.bytes);
      Invert(place);
      Vtop___024root___eval_settle(top_.rootp);
      Invert(place);
      const bool stays = std::equal(before.begin(), before.end(), place.data);
      std::printf("%s %ld %ld %ld %d\n", place.names.c_str(), place.bits, place.bytes, place.words, stays);
    }
  }

  void PrintFrames() const {
    for (long number = 0; number < before_ + kFrames; number++) {
      for (const int32_t code : frames_[number].words) std::printf("%d ", code);
      std::puts("");
    }
    std::printf("%u\n", no_flip_);
  }

  void Flip(const Place& place, long bit, long clock) {
    Restore(clock / period_);
    while (clock_ < clock) Clock();
    const bool before = place.IsSet(bit);
    place.Flip(bit);
    Vtop___024root___eval_settle(top_.rootp);
    if (place.IsSet(bit) == before) Fail("a flip does not stay");
    bool healed = false;
    while (clock_ < end_ + std::min(late_, 2 * pixels_) && !healed) {
      Clock();
      const std::size_t number = clock_ / period_;
      if (clock_ % period_ == 0 && number < kept_.size()) healed = IsAt(kept_[number]);
    }
    if (healed) {
      const Kept& now = kept_[clock_ / period_];
      depth_.insert(depth_.end(), all_depth_.begin() + now.depth, all_depth_.end());
      records_.insert(records_.end(), all_records_.begin() + now.records, all_records_.end());
    }
    Print(clock, Packets(depth_), Packets(records_), healed ? no_flip_ : Status());
  }

 private:
  static void Invert(const Place& place) {
    for (long bit = 0; bit < place.words * place.bits; bit++) place.Flip(bit);
  }

  void* State() const { return top_.rootp->vlSymsp; }  // of all instances

  Kept Keep() const {
    Kept kept{std::vector<uint8_t>(sizeof(Vtop__Syms)), sent_, depth_.size(), records_.size()};
    std::memcpy(kept.registers.data(), State(), kept.registers.size());
    return kept;
  }

  bool IsAt(const Kept& kept) const {
    return sent_ == kept.sent && !std::memcmp(State(), kept.registers.data(), kept.registers.size());
  }

  bool IsSettled() const {
    const Kept before = Keep();
    Vtop___024root___eval_settle(top_.rootp);
    return IsAt(before);
  }

  void Restore(std::size_t number) {
    const Kept& kept = kept_[number];
    std::memcpy(State(), kept.registers.data(), kept.registers.size());
    sent_ = kept.sent;
    late_ = 0;
    lates_.assign(sent_ / pixels_, 0);
    clock_ = static_cast<long>(number) * period_;
    depth_.assign(all_depth_.begin(), all_depth_.begin() + kept.depth);
    records_.assign(all_records_.begin(), all_records_.begin() + kept.records);
  }

  // What the model answers to its inputs in this clock.
  void Settle() {
    top_.clk = 0;
    top_.eval();
  }

  void Clock() {
    const long pixel = words_[sent_ % words_.size()];
    top_.s_axis_tvalid = streams_;
    top_.s_axis_tdata = pixel & 0xFFFFFF;
    top_.s_axis_tlast = pixel >> 24 & 1;
    top_.s_axis_tuser = pixel >> 25 & 1;
    Settle();
    if (streams_) {
      if (!top_.s_axis_tready) late_++;
      else if (++sent_ % pixels_ == 0) lates_.push_back(late_);
      if (top_.m_axis_tvalid) depth_.push_back({clock_, top_.m_axis_tuser != 0, Codes(), top_.m_axis_tlast != 0});
      const bool begins = records_.empty() || records_.back().last;
      const int32_t word = static_cast<int32_t>(top_.m_event_tdata);
      if (top_.m_event_tvalid) records_.push_back({clock_, begins, {word}, top_.m_event_tlast != 0});
    }
    top_.clk = 1;
    top_.eval();
    clock_++;
  }

  std::vector<int32_t> Codes() const {
    std::vector<int32_t> codes;
    for (int lane = 0; lane < lanes_; lane++) {
      uint32_t code = 0;
      for (int i = 0; i < bytes_; i++) code |= ByteOf(top_.m_axis_tdata, lane * bytes_ + i) << 8 * i;
      codes.push_back(static_cast<int32_t>(code << (32 - 8 * bytes_)) >> (32 - 8 * bytes_));
    }
    return codes;
  }

  void Write(long offset, long value) {
    top_.s_axil_awaddr = offset;
    top_.s_axil_wdata = value;
    top_.s_axil_awvalid = top_.s_axil_wvalid = 1;
    for (int i = 0; i < kAnswerClocks; i++) {
      Settle();
      const bool address = top_.s_axil_awready, data = top_.s_axil_wready, answer = top_.s_axil_bvalid;
      Clock();
      if (address) top_.s_axil_awvalid = 0;
      if (data) top_.s_axil_wvalid = 0;
      if (answer) return;
    }
    Fail("a write has no answer");
  }

  uint32_t Status() {
    top_.s_axil_araddr = status_;
    top_.s_axil_arvalid = 1;
    for (int i = 0; i < kAnswerClocks; i++) {
      Settle();
      const bool address = top_.s_axil_arready, answer = top_.s_axil_rvalid;
      const uint32_t word = top_.s_axil_rdata;
      Clock();
      if (address) top_.s_axil_arvalid = 0;
      if (answer) return word;
    }
    return kNoAnswer;
  }

  static std::vector<Packet> Packets(const std::vector<Beat>& beats) {
    std::vector<Packet> packets;
    for (const auto& beat : beats) {
      if (beat.begins || packets.empty()) packets.push_back({beat.clock, {}, {}});
      Packet& packet = packets.back();
      packet.words.insert(packet.words.end(), beat.words.begin(), beat.words.end());
      packet.lasts.push_back(beat.last);
    }
    return packets;
  }

  // The packet nearest to the clock in which that of a frame is due, which may have entered late, if it has the same
  // form; nullptr: none within half a frame.
  const Packet* Due(const std::vector<Packet>& packets, Packet due, std::size_t number) const {
    if (number < lates_.size()) due.clock += lates_[number];
    const Packet* nearest = nullptr;
    long distance = pixels_ / 2;
    for (const auto& packet : packets) {
      if (std::labs(packet.clock - due.clock) >= distance) continue;
      distance = std::labs(packet.clock - due.clock);
      nearest = &packet;
    }
    const bool whole = nearest && nearest->words.size() == due.words.size() && nearest->lasts == due.lasts;
    return whole ? nearest : nullptr;
  }

  void Print(long clock, const std::vector<Packet>& frames, const std::vector<Packet>& records, uint32_t status) const {
    int32_t change[kFrames] = {};
    double percent[kFrames] = {};
    bool torn[kFrames] = {};
    uint32_t marks = 0;
    const long after = before_ + (clock > 0);  // the first frame that enters behind the flip
    for (long number = 0; number < after + kFrames - 1; number++) {
      const long column = std::max(0L, number - after + 1);
      const Packet& expected = frames_[number];
      if (const Packet* frame = Due(frames, expected, number)) {
        int32_t peak = 1, largest = 0;
        for (std::size_t i = 0; i < expected.words.size(); i++) {
          peak = std::max(peak, std::abs(expected.words[i]));
          largest = std::max(largest, std::abs(frame->words[i] - expected.words[i]));
        }
        change[column] = std::max(change[column], largest);
        percent[column] = std::max(percent[column], 100.0 * largest / peak);
      } else {
        torn[column] = true;
      }
      const Packet& due = frame_records_[number];
      const Packet* record = Due(records, due, number);
      if (record) marks |= static_cast<uint32_t>(record->words[kMarksWord] & ~due.words[kMarksWord]) & kMarks;
    }
    for (int i = 0; i < kFrames; i++) std::printf("%d %.4g %d ", change[i], percent[i], torn[i]);
    std::printf("%u %u\n", marks, status == kNoAnswer ? status : status & ~no_flip_);
  }

  Vtop& top_;
  std::vector<std::pair<long, long>> writes_;
  const std::vector<Place>& places_;
  std::vector<long> inverted_, recorded_, words_, lates_;  // lates_: clocks by which each frame entered late
  long status_, pixels_, before_, period_, sent_ = 0, late_ = 0, clock_ = 0, end_ = 0;
  int lanes_, bytes_;
  bool streams_ = false;
  uint32_t no_flip_ = 0;
  std::vector<Beat> depth_, records_, all_depth_, all_records_;
  std::vector<Packet> frames_, frame_records_;
  std::vector<Kept> kept_;
};

std::vector<Place> Places() {
  std::vector<Place> places;
  for (const auto& scope : *Verilated::scopeNameMap()) {
    if (!scope.second->varsp()) continue;
    const char* module = scope.second->defname();
    const std::string names = std::string(scope.first) + " " + (module ? module : "-") + " ";
    for (auto& each : *scope.second->varsp()) {
      const VerilatedVar& signal = each.second;
      if (signal.isParam()) continue;
      long words = 1;
      for (int i = 1; i <= signal.udims(); i++) words *= signal.elements(i);
      const long bits = signal.entBits(), bytes = signal.entSize();
      places.push_back({names + each.first, static_cast<uint8_t*>(signal.datap()), bits, bytes, words});
    }
  }
  return places;
}

}  // namespace

int main(int argc, char** argv) {
  Verilated::commandArgs(argc, argv);
  Vtop top("");
  const std::vector<Place> places = Places();
  Run run(top, places);
  long place;
  if (!(std::cin >> place)) {
    std::FILE* history = std::fopen("history.bin", "wb");
    if (!history) Fail("history.bin cannot be written");
    run.Reference(history);
    std::fclose(history);
    run.PrintPlaces();
    std::puts("");
    run.PrintFrames();
    return 0;
  }
  run.Reference(nullptr);
  do {
    const long bit = Number();
    run.Flip(places[place], bit, Number());
  } while (std::cin >> place);
  return 0;
}
