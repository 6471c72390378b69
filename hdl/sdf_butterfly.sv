// SPDX-License-Identifier: Apache-2.0
// sdf_butterfly: one radix-2 stage of a single-path delay feedback FFT.
//
//   words a, b of a block of 2 Delay, Delay apart:   a + b, then a - b        Halve: halved
//   RotateBlock > 0: the last quarter of each block of that size is turned by -j (Inverse: +j) first
//
// Stream in: bursts of Size complex words. Stream out: the same, sums of a block before its differences.
// Latency: Delay + 1 cycles. The delay line moves with en alone, so a burst leaves without one behind it.
// Bit-accurate model: models/sdf_butterfly.py.

module sdf_butterfly #(
  parameter int Width       = 27,
  parameter int Size        = 128,
  parameter int Delay       = 64,
  parameter int RotateBlock = 0,
  parameter int Inverse     = 0,
  parameter int Halve       = 0
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    en,
  input  logic                    in_start,
  input  logic                    in_frame_start,   // with in_start: the first burst of a frame
  input  logic signed [Width-1:0] in_re,
  input  logic signed [Width-1:0] in_im,
  output logic                    out_start,
  output logic                    out_frame_start,
  output logic signed [Width-1:0] out_re,
  output logic signed [Width-1:0] out_im,
  output logic [2:0]              saturations  // values clipped in this cycle
);

  localparam int PositionWidth = $clog2(Size);
  localparam int DelayBit = $clog2(Delay);

  logic [PositionWidth-1:0] position;
  logic active;
  burst_counter #(.Size(Size)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );

  logic second;  // b is present, a leaves the delay line
  assign second = active & position[DelayBit];

  logic signed [Width:0] b_re, b_im;
  if (RotateBlock > 0) begin : g_rotate
    localparam int QuarterBit = $clog2(RotateBlock) - 2;
    logic turn;
    assign turn = &position[QuarterBit+:2];
    if (Inverse != 0) begin : g_plus_j
      assign b_re = turn ? -$signed({in_im[Width-1], in_im}) : (Width + 1)'(in_re);
      assign b_im = turn ? (Width + 1)'(in_re) : (Width + 1)'(in_im);
    end else begin : g_minus_j
      assign b_re = turn ? (Width + 1)'(in_im) : (Width + 1)'(in_re);
      assign b_im = turn ? -$signed({in_re[Width-1], in_re}) : (Width + 1)'(in_im);
    end
  end else begin : g_straight
    assign b_re = (Width + 1)'(in_re);
    assign b_im = (Width + 1)'(in_im);
  end

  logic signed [Width-1:0] a_re, a_im, held_re, held_im;
  delay_line #(
    .Width(2 * Width),
    .Delay(Delay)
  ) u_delay (
    .clk, .rst, .en, .in({held_re, held_im}), .out({a_re, a_im})
  );

  logic signed [Width-1:0] sum_re, sum_im, difference_re, difference_im;
  logic [3:0] clipped;
  round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_sum_re (
    .in((Width + 2)'(a_re) + (Width + 2)'(b_re)), .out(sum_re), .clipped(clipped[0])
  );
  round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_sum_im (
    .in((Width + 2)'(a_im) + (Width + 2)'(b_im)), .out(sum_im), .clipped(clipped[1])
  );
  round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_difference_re (
    .in((Width + 2)'(a_re) - (Width + 2)'(b_re)), .out(difference_re), .clipped(clipped[2])
  );
  round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_difference_im (
    .in((Width + 2)'(a_im) - (Width + 2)'(b_im)), .out(difference_im), .clipped(clipped[3])
  );
  assign held_re = second ? difference_re : in_re;
  assign held_im = second ? difference_im : in_im;

  logic out_begins, frame_start_q;  // of the burst that enters
  assign out_begins = active & (position == PositionWidth'(Delay));
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start) frame_start_q <= in_frame_start;
      out_start <= out_begins;
      out_frame_start <= out_begins & frame_start_q;
      out_re <= second ? sum_re : a_re;
      out_im <= second ? sum_im : a_im;
    end
    saturations <= (en && second) ? 3'(clipped[0]) + 3'(clipped[1]) + 3'(clipped[2]) + 3'(clipped[3]) : '0;
    if (rst) begin
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
      saturations <= '0;
    end
  end

`ifndef SYNTHESIS
  initial if (Delay < 1 || 2 * Delay > Size) $fatal(1, "%m: Delay must be 1 to Size / 2");
`endif

endmodule
