// SPDX-License-Identifier: Apache-2.0
// butterfly: one radix-2 stage of a multi-path FFT.
//
//   words a, b of a beat, in the paths l and l + 2^PathBit:   a + b in path l, a - b in the other one   Halve: halved
//   RotateBit >= 0: b is first multiplied by -j (Inverse: +j) where this bit of {beat, path l} is 1
//
// Stream in: bursts of Beats beats, Paths complex words each, path 0 in the lowest bits; starts come 2 cycles before
// the first beat. Stream out: the same. Latency: 2 cycles; bursts may have pauses between them; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/butterfly.py.

`default_nettype none

module butterfly #(
  parameter int Width     = 27,
  parameter int Paths     = 4,  // a power of two
  parameter int Beats     = 32,  // a power of two
  parameter int PathBit   = 0,  // a bit of the path number
  parameter int RotateBit = -1,  // another bit of beat and path, -1: none
  parameter int Inverse   = 0,
  parameter int Halve     = 0,
  localparam int CountWidth = $clog2(2 * Paths + 1)
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,
  input  wire                     in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Paths*Width-1:0]  in_re,           // F fraction bits, as in_im, out_re and out_im
  input  wire  [Paths*Width-1:0]  in_im,
  output logic                    out_start,
  output logic                    out_frame_start,
  output logic [Paths*Width-1:0]  out_re,
  output logic [Paths*Width-1:0]  out_im,
  output logic [CountWidth-1:0]   saturations      // clip count, delayed
);

  localparam int PathWidth = $clog2(Paths);
  localparam int BeatWidth = $clog2(Beats);

  logic [BeatWidth-1:0] beat, beat_q, beat_qq;  // beat_qq: of the words present
  logic active;
  td_burst_counter #(.Words(Beats)) u_counter (
    .clk, .rst, .en, .start(in_start), .position(beat), .active
  );
  always_ff @(posedge clk) begin
    if (en) begin
      beat_q <= beat;
      beat_qq <= beat_q;
    end
  end

  logic [2*Paths-1:0] clipped;  // real part, imaginary part of each path
  for (genvar pair = 0; pair < Paths / 2; pair++) begin : g_pair
    localparam int A = ((pair >> PathBit) << (PathBit + 1)) | (pair & ((1 << PathBit) - 1));
    localparam int B = A + (1 << PathBit);

    // b, or its complement where the rotation makes it negative: that lacks 1.
    logic [1:0][Width-1:0] a, b;
    logic [1:0] minus;
    assign a = {in_im[A*Width+:Width], in_re[A*Width+:Width]};
    if (RotateBit >= 0) begin : g_rotate
      logic rotate;
      if (RotateBit < PathWidth) begin : g_path
        assign rotate = 1'(A >> RotateBit);
      end else begin : g_beat
        assign rotate = beat_qq[RotateBit-PathWidth];
      end
      assign minus = {rotate & (Inverse == 0), rotate & (Inverse != 0)};
      assign b[0] = (rotate ? in_im[B*Width+:Width] : in_re[B*Width+:Width]) ^ {Width{minus[0]}};
      assign b[1] = (rotate ? in_re[B*Width+:Width] : in_im[B*Width+:Width]) ^ {Width{minus[1]}};
    end else begin : g_straight
      assign minus = '0;
      assign b = {in_im[B*Width+:Width], in_re[B*Width+:Width]};
    end

    // Half a sum of two words always fits, half a difference does not. Rotated: -1 where it depends on the beat.
    localparam int Rotated = RotateBit < 0 ? 0 : RotateBit < PathWidth ? (A >> RotateBit) & 1 : -1;
    for (genvar result = 0; result < 4; result++) begin : g_result
      localparam int Part = result % 2;  // 0: real, 1: imaginary
      localparam int Path = result < 2 ? A : B;
      localparam int Minus = Part == (Inverse != 0 ? 0 : 1) ? Rotated : 0;  // b is negated
      localparam int Fits = Halve != 0 && Minus == (result < 2 ? 0 : 1) ? 1 : 0;
      logic [Width-1:0] operand;
      logic carry, unused_carry;
      logic signed [Width:0] sum, sum_q;
      logic signed [Width-1:0] rounded, rounded_q;
      assign operand = result < 2 ? b[Part] : ~b[Part];
      assign carry = result < 2 ? minus[Part] : ~minus[Part];
      assign {sum, unused_carry} = {a[Part][Width-1], a[Part], 1'b1} + {operand[Width-1], operand, carry};
      if (Fits != 0) begin : g_fits
        logic unused_sign;
        td_round_saturate #(.InWidth(Width + 1), .Drop(Halve), .OutWidth(Width + 1)) u_round (
          .in(sum_q), .out({unused_sign, rounded}), .clipped(clipped[2*Path+Part])
        );
      end else begin : g_limited
        td_round_saturate #(.InWidth(Width + 1), .Drop(Halve), .OutWidth(Width)) u_round (
          .in(sum_q), .out(rounded), .clipped(clipped[2*Path+Part])
        );
      end
      always_ff @(posedge clk) begin
        if (en) begin
          sum_q <= sum;
          rounded_q <= rounded;
        end
      end
      if (Part == 0) begin : g_re
        assign out_re[Path*Width+:Width] = rounded_q;
      end else begin : g_im
        assign out_im[Path*Width+:Width] = rounded_q;
      end
    end
  end

  logic start_q, frame_start_q;
  logic [2:0] active_q;
  logic [2*Paths-1:0] clipped_q;
  logic [CountWidth-1:0] count;
  always_comb begin
    count = '0;
    for (int i = 0; i < 2 * Paths; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      active_q <= {active_q[1:0], active};
      start_q <= in_start;
      frame_start_q <= in_frame_start;
      out_start <= start_q;
      out_frame_start <= frame_start_q;
    end
    clipped_q <= clipped & {2 * Paths{en & active_q[2]}};
    saturations <= count;
    if (rst) {active_q, start_q, frame_start_q, out_start, out_frame_start, clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
