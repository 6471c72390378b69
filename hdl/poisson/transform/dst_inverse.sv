// SPDX-License-Identifier: Apache-2.0
// dst_inverse: inverse DST-II of a burst, the reverse of dst_forward.
//
//   out = g x when in = dst_forward(x),  g = (1 - 2^(1 - CoeffWidth))^(2 (twiddle stages + 1)), and the drops below
//
// Stream in: bursts of Size modes, bit-reversed order, as dst_forward puts them out.
// Stream out: bursts of samples in Makhoul order (0, 2, 4, .., 5, 3, 1). Latency: Size / 2 + 11 cycles
// + sdf_fft; bursts may have pauses between them; en low: nothing moves.
//
//   mode_pairs  ->  rotate C[N-k] + j C[k] by exp(j pi k / 2N) / j  ->  inverse sdf_fft  ->  sign (-1)^n
//
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/dst_inverse.py.

`default_nettype none

module dst_inverse #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Size       = 128,
  parameter int InWidth    = 24,
  parameter int InputDrop  = -3,   // fraction bits from the input to the arithmetic; negative: added
  parameter int Width      = 27,   // of the arithmetic
  parameter int CoeffWidth = 18,
  parameter int OutputDrop = 3,    // fraction bits from the arithmetic to the output
  parameter int OutWidth   = 24,
  parameter int Sine       = 1     // 1: DST-II; 0: DCT-II, without the sign (-1)^n
) (
  input  wire                        clk,
  input  wire                        rst,
  input  wire                        en,
  input  wire                        in_start,
  input  wire                        in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [InWidth-1:0]  in_data,         // mode, F fraction bits
  output logic                       out_start,
  output logic                       out_frame_start,
  output logic signed [OutWidth-1:0] out_data,        // sample, F - InputDrop - OutputDrop fraction bits
  output logic [7:0]                 saturations      // clip count, delayed
);

  logic pair_start, pair_frame_start;
  logic signed [InWidth-1:0] mode, mirrored;
  mode_pairs #(.Width(InWidth), .Size(Size)) u_pairs (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_mode(in_data),
    .out_start(pair_start), .out_frame_start(pair_frame_start), .out_mode(mode), .out_mirrored(mirrored)
  );

  logic rotated_start, rotated_frame_start;
  logic signed [Width-1:0] rotated_re, rotated_im;
  logic [1:0] clipped_phase;
  twiddle_multiply #(
    .InWidth(InWidth), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1 + InputDrop),
    .Size(Size), .Block(Size), .File({TableFolder, "phase_inverse.hex"})
  ) u_phase (
    .clk, .rst, .en,
    .in_start(pair_start), .in_frame_start(pair_frame_start), .in_re(mirrored), .in_im(mode),
    .out_start(rotated_start), .out_frame_start(rotated_frame_start), .out_re(rotated_re), .out_im(rotated_im),
    .saturations(clipped_phase)
  );

  logic fft_start, fft_frame_start;
  logic signed [Width-1:0] x, unused_im;
  logic [6:0] clipped_fft;
  sdf_fft #(.TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Size(Size), .Inverse(1)) u_fft (
    .clk, .rst, .en,
    .in_start(rotated_start), .in_frame_start(rotated_frame_start), .in_re(rotated_re), .in_im(rotated_im),
    .out_start(fft_start), .out_frame_start(fft_frame_start), .out_re(x), .out_im(unused_im),
    .saturations(clipped_fft)
  );

  // Samples of odd index are the second half of the burst.
  logic [$clog2(Size)-1:0] position;
  logic active;
  td_burst_counter #(.Words(Size)) u_counter (
    .clk, .rst, .en, .start(fft_start), .position, .active
  );
  logic signed [Width:0] signed_x;
  logic signed [OutWidth-1:0] rounded;
  logic active_q, start_q, frame_start_q, clipped, clipped_q;
  td_round_saturate #(.InWidth(Width + 1), .Drop(OutputDrop), .OutWidth(OutWidth)) u_output (
    .in(signed_x), .out(rounded), .clipped
  );
  always_ff @(posedge clk) begin
    if (en) begin
      signed_x <= Sine != 0 && position[$clog2(Size)-1] ? -$signed({x[Width-1], x}) : (Width + 1)'(x);
      active_q <= active;
      start_q <= fft_start;
      frame_start_q <= fft_frame_start;
      out_start <= start_q;
      out_frame_start <= frame_start_q;
      out_data <= rounded;
    end
    clipped_q <= en & active_q & clipped;
    saturations <= 8'(clipped_q) + 8'(clipped_fft) + 8'(clipped_phase);
    if (rst) begin
      active_q <= 1'b0;
      start_q <= 1'b0;
      frame_start_q <= 1'b0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
      clipped_q <= 1'b0;
      saturations <= '0;
    end
  end

endmodule

`default_nettype wire
