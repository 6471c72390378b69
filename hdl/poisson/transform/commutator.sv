// SPDX-License-Identifier: Apache-2.0
// commutator: exchanges a bit of the beat number with one of the path number, in an FFT of several paths.
//
// Position p of a word in its burst has three fields: p = {t[high:s], path, t[s-1:0]}, where t is the beat.
//   Up = 1: s = log2(Delay) before, s + 1 behind: words of paths 2 h, 2 h + 1 go to h, h + Paths / 2
//   Up = 0: s = log2(Delay) + 1 before, s - 1 behind: the reverse
//
// Stream in: bursts of Beats beats, Paths complex words each, path 0 in the lowest bits; starts come 2 cycles before
// the first beat. Stream out: the same. Latency: Delay cycles, and no register at the output; bursts may have pauses
// between them; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/commutator.py.

`default_nettype none

module commutator #(
  parameter int Width  = 27,
  parameter int Paths  = 4,  // a power of two
  parameter int Beats  = 32,  // a power of two
  parameter int Delay  = 8,  // a power of two up to Beats / 2
  parameter int Up     = 1,
  parameter int Parity = 0  // 1: a parity bit in each word of a memory
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    in_start,
  input  wire                    in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Paths*Width-1:0] in_re,           // words of any format, unchanged in out_re and out_im
  input  wire  [Paths*Width-1:0] in_im,
  output logic                   out_start,
  output logic                   out_frame_start,
  output logic [Paths*Width-1:0] out_re,
  output logic [Paths*Width-1:0] out_im,
  output logic                   flipped  // a word that was read has a flipped bit
);

  localparam int BeatWidth = $clog2(Beats);
  localparam int DelayBit = $clog2(Delay);

  // The counter rests at 0, so the second half of a burst leaves behind its end as it leaves into the next burst.
  logic [BeatWidth-1:0] beat;
  logic active, frame_start_q;
  logic [1:0] second_q;
  td_burst_counter #(.Words(Beats)) u_counter (
    .clk, .rst, .en, .start(in_start), .position(beat), .active
  );
  assign out_start = active & (beat == BeatWidth'(Delay));
  assign out_frame_start = out_start & frame_start_q;
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start) frame_start_q <= in_frame_start;
      second_q <= {second_q[0], beat[DelayBit]};
    end
  end

  logic [Paths/2-1:0] a_flipped, b_flipped;
  assign flipped = {a_flipped, b_flipped} != '0;
  for (genvar pair = 0; pair < Paths / 2; pair++) begin : g_pair
    localparam int InA = Up != 0 ? 2 * pair : pair;
    localparam int InB = Up != 0 ? 2 * pair + 1 : pair + Paths / 2;
    localparam int OutA = Up != 0 ? pair : 2 * pair;
    localparam int OutB = Up != 0 ? pair + Paths / 2 : 2 * pair + 1;
    logic [2*Width-1:0] a, b, late_b, out_a, out_b;
    assign a = {in_re[InA*Width+:Width], in_im[InA*Width+:Width]};
    assign b = {in_re[InB*Width+:Width], in_im[InB*Width+:Width]};
    td_delay_line #(.Width(2 * Width), .Delay(Delay), .Parity(Parity)) u_b (
      .clk, .rst, .en, .in(b), .out(late_b), .flipped(b_flipped[pair])
    );
    td_delay_line #(.Width(2 * Width), .Delay(Delay), .Parity(Parity)) u_a (
      .clk, .rst, .en, .in(second_q[1] ? late_b : a), .out(out_a), .flipped(a_flipped[pair])
    );
    assign out_b = second_q[1] ? a : late_b;
    assign {out_re[OutA*Width+:Width], out_im[OutA*Width+:Width]} = out_a;
    assign {out_re[OutB*Width+:Width], out_im[OutB*Width+:Width]} = out_b;
  end

endmodule

`default_nettype wire
