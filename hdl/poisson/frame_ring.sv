// SPDX-License-Identifier: Apache-2.0
// frame_ring: keeps the words of frames, one behind the other, until each frame is read.
//
// Stream in: frames of Words words, gaps anywhere. Out: out_frame_start in a cycle with out_en chooses the frame that
// is read next: the latest one that is whole; with Late the one before it, if the last word of the latest one came less
// than half of Late cycles with en ago, rounded up to a power of two. Each out_next with out_en asks for its next word,
// LastFirst: from the last one back; out_data has it two cycles with out_en later. Held: words that come from the first
// word of a frame until it is read, at most. Bit-accurate model: models/tactile_depth/chip/poisson/frame_ring.py.

`default_nettype none

module frame_ring #(
  parameter int Width     = 13,
  parameter int Words     = 384,  // of a frame
  parameter int Held      = 800,
  parameter int LastFirst = 1,
  parameter int Late      = 0,    // cycles of a frame if the next one may be whole before it is read, else 0
  parameter int Parity    = 0     // 1: a parity bit in each word of the memory
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              en,
  input  wire              in_valid,
  input  wire              in_frame_start,  // with in_valid: the first word of a frame
  input  wire  [Width-1:0] in_data,
  input  wire              out_en,
  input  wire              out_frame_start,
  input  wire              out_next,
  output logic [Width-1:0] out_data,
  output logic             flipped          // a word that was read has a flipped bit
);

  localparam int AddressWidth = $clog2(Held);
  localparam int WordWidth = $clog2(Words);

  logic [WordWidth-1:0] word, word_next;
  logic [AddressWidth-1:0] write_address, first_address, latest, chosen, read_address;
  logic whole;
  assign word = in_frame_start ? '0 : word_next;
  assign whole = in_valid & (word == WordWidth'(Words - 1));
  always_ff @(posedge clk) begin
    if (en && in_valid) begin
      word_next <= word + WordWidth'(1);
      write_address <= write_address + AddressWidth'(1);
      if (in_frame_start) first_address <= write_address;
    end
    if (en && whole) latest <= LastFirst != 0 ? write_address : first_address;
    if (out_en && out_frame_start) read_address <= chosen;
    else if (out_en && out_next) read_address <= read_address + (LastFirst != 0 ? '1 : AddressWidth'(1));
    if (rst) write_address <= '0;
  end

  if (Late == 0) begin : g_latest
    assign chosen = latest;
  end else begin : g_late
    localparam int SinceWidth = $clog2(Late);
    logic [AddressWidth-1:0] earlier;
    logic [SinceWidth-1:0] since;  // cycles from the last word of the latest frame, up to half of Late
    assign chosen = since[SinceWidth-1] ? latest : earlier;
    always_ff @(posedge clk) begin
      if (en && whole) {earlier, since} <= {latest, SinceWidth'(0)};
      else if (en && !since[SinceWidth-1]) since <= since + SinceWidth'(1);
    end
  end

  td_parity_ram #(.Width(Width), .Depth(1 << AddressWidth), .Style(1), .Latency(2), .Parity(Parity)) u_words (
    .clk, .en(out_en), .write_en(en & in_valid), .write_address, .write_data(in_data), .read_en(out_en & out_next),
    .read_address, .read_data(out_data), .flipped
  );

endmodule

`default_nettype wire
