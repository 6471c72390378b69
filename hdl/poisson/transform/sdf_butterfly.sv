// SPDX-License-Identifier: Apache-2.0
// sdf_butterfly: one radix-2 stage of a single-path delay feedback FFT.
//
//   words a, b of a block of 2 Delay, Delay apart:   a + b, then a - b        Halve: halved
//   RotateBlock > 0: the last quarter of each block of that size is first multiplied by -j (Inverse: +j)
//
// Stream in: bursts of Size complex words; starts come 2 cycles before the first word. Stream out: the same, sums of a
// block before its differences. Latency: Delay + 2 cycles. The delay line moves with en alone, so a burst leaves
// without one behind it.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/sdf_butterfly.py.

`default_nettype none

module sdf_butterfly #(
  parameter int Width       = 27,
  parameter int Size        = 128,  // a power of two
  parameter int Delay       = 64,  // a power of two up to Size / 2
  parameter int RotateBlock = 0,  // 0, or a power of two from 4 to Size
  parameter int Inverse     = 0,
  parameter int Halve       = 0,
  parameter int Parity      = 0  // 1: a parity bit in each word of a memory
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,
  input  wire                     in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [Width-1:0] in_re,           // F fraction bits, as in_im, out_re and out_im
  input  wire  signed [Width-1:0] in_im,
  output logic                    out_start,
  output logic                    out_frame_start,
  output logic signed [Width-1:0] out_re,
  output logic signed [Width-1:0] out_im,
  output logic [1:0]              saturations,     // clip count, delayed
  output logic                    flipped          // a word that was read has a flipped bit
);

  localparam int PositionWidth = $clog2(Size);
  localparam int DelayBit = $clog2(Delay);

  logic [1:0] start_q, start_of_frame_q;
  logic start;  // with the words
  logic [PositionWidth-1:0] position;
  logic active;
  assign start = start_q[1];
  td_burst_counter #(.Words(Size)) u_counter (
    .clk, .rst, .en, .start, .position, .active
  );

  logic second;  // b is present, a leaves the delay line
  assign second = active & position[DelayBit];

  // b, or its complement where the rotation makes it negative: that lacks 1.
  logic [Width-1:0] b_re, b_im;
  logic minus_re, minus_im;
  if (RotateBlock > 0) begin : g_rotate
    localparam int QuarterBit = $clog2(RotateBlock) - 2;
    logic rotate;
    logic [PositionWidth-1:0] next;
    assign next = position + PositionWidth'(1);
    always_ff @(posedge clk) if (en) rotate <= &2'(next >> QuarterBit) & ~start_q[0];
    assign minus_re = rotate & (Inverse != 0);
    assign minus_im = rotate & (Inverse == 0);
    assign b_re = $unsigned(rotate ? in_im : in_re) ^ {Width{minus_re}};
    assign b_im = $unsigned(rotate ? in_re : in_im) ^ {Width{minus_im}};
  end else begin : g_straight
    assign minus_re = 1'b0;
    assign minus_im = 1'b0;
    assign b_re = in_re;
    assign b_im = in_im;
  end

  // Sum and difference are exact in the line; they are rounded on their way out, one a cycle.
  logic signed [Width:0] a_re, a_im, sum_re, sum_im, difference_re, difference_im;
  logic [3:0] unused_carry;
  assign {sum_re, unused_carry[0]} = {a_re, 1'b1} + {b_re[Width-1], b_re, minus_re};
  assign {sum_im, unused_carry[1]} = {a_im, 1'b1} + {b_im[Width-1], b_im, minus_im};
  assign {difference_re, unused_carry[2]} = {a_re, 1'b1} + {~b_re[Width-1], ~b_re, ~minus_re};
  assign {difference_im, unused_carry[3]} = {a_im, 1'b1} + {~b_im[Width-1], ~b_im, ~minus_im};
  td_delay_line #(.Width(2 * (Width + 1)), .Delay(Delay), .Parity(Parity)) u_delay (
    .clk, .rst, .en,
    .in(second ? {difference_re, difference_im} : {(Width + 1)'(in_re), (Width + 1)'(in_im)}), .out({a_re, a_im}),
    .flipped
  );

  logic leaves_first_q, frame_start_q;
  assign out_frame_start = out_start & frame_start_q;
  logic signed [Width:0] leaving_re, leaving_im;
  always_ff @(posedge clk) begin
    if (en) begin
      // With the first sum of a burst; worked out a cycle ahead, since it goes far.
      out_start <= active & (position == PositionWidth'(Delay - 1)) & ~start_q[0];
      start_q <= {start_q[0], in_start};
      start_of_frame_q <= {start_of_frame_q[0], in_frame_start};
      if (start) frame_start_q <= start_of_frame_q[1];
      leaves_first_q <= out_start;
      leaving_re <= second ? sum_re : a_re;
      leaving_im <= second ? sum_im : a_im;
    end
    if (rst) {out_start, start_q, leaves_first_q} <= '0;
  end

  logic leaving;
  td_burst_counter #(.Words(Size)) u_leaving (
    .clk, .rst, .en, .start(leaves_first_q), .position(), .active(leaving)
  );
  logic signed [Width-1:0] rounded_re, rounded_im;
  logic [1:0] clipped, clipped_q;
  td_round_saturate #(.InWidth(Width + 1), .Drop(Halve), .OutWidth(Width)) u_round_re (
    .in(leaving_re), .out(rounded_re), .clipped(clipped[0])
  );
  td_round_saturate #(.InWidth(Width + 1), .Drop(Halve), .OutWidth(Width)) u_round_im (
    .in(leaving_im), .out(rounded_im), .clipped(clipped[1])
  );
  always_ff @(posedge clk) begin
    if (en) begin
      out_re <= rounded_re;
      out_im <= rounded_im;
    end
    clipped_q <= clipped & {2{en & leaving}};
    if (rst) clipped_q <= '0;
  end
  assign saturations = 2'(clipped_q[0]) + 2'(clipped_q[1]);

endmodule

`default_nettype wire
