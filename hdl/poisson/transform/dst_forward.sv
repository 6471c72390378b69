// SPDX-License-Identifier: Apache-2.0
// dst_forward: DST-II of a burst by Makhoul's method (IEEE Transactions ASSP 28, 1980).
//
//   out[p] = g sum over n of x[n] sin(pi (2n + 1) (N - k) / 2N),  k = p with its bits reversed, N = Size
//   g = 2^-(halvings of sdf_fft) (1 - 2^(1 - CoeffWidth))^(twiddle stages + 1), and the drops below
//
// Stream in: bursts of Size samples in Makhoul order (0, 2, 4, .., 5, 3, 1). Stream out: bursts, bit-reversed order.
// Latency: 10 cycles + sdf_fft; bursts may have pauses between them; en low: nothing moves.
//
//   sign (-1)^n  ->  sdf_fft  ->  rotate by exp(-j pi k / 2N), real part
//
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/dst_forward.py.

`default_nettype none

module dst_forward #(
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
  input  wire  signed [InWidth-1:0]  in_data,         // sample, F fraction bits
  output logic                       out_start,
  output logic                       out_frame_start,
  output logic signed [OutWidth-1:0] out_data,        // mode, F - InputDrop - OutputDrop fraction bits
  output logic [7:0]                 saturations      // clip count, delayed
);

  // Samples of odd index are the second half of the burst.
  logic [$clog2(Size)-1:0] position;
  logic active;
  td_burst_counter #(.Words(Size)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );
  logic signed [InWidth:0] signed_in;
  logic signed [Width-1:0] x, x_q;
  logic signed [InWidth-1:0] data_q;
  logic negative, clipped, clipped_q;
  logic [1:0] active_q;
  logic [2:0] start_q, frame_start_q;
  td_round_saturate #(.InWidth(InWidth + 1), .Drop(InputDrop), .OutWidth(Width)) u_input (
    .in(signed_in), .out(x), .clipped
  );
  always_ff @(posedge clk) begin
    if (en) begin
      data_q <= in_data;
      negative <= Sine != 0 && position[$clog2(Size)-1];
      signed_in <= negative ? -$signed({data_q[InWidth-1], data_q}) : (InWidth + 1)'(data_q);
      x_q <= x;
      active_q <= {active_q[0], active};
      start_q <= {start_q[1:0], in_start};
      frame_start_q <= {frame_start_q[1:0], in_frame_start};
    end
    clipped_q <= en & active_q[1] & clipped;
    if (rst) begin
      active_q <= '0;
      start_q <= '0;
      frame_start_q <= '0;
      clipped_q <= 1'b0;
    end
  end

  logic fft_start, fft_frame_start;
  logic signed [Width-1:0] fft_re, fft_im;
  logic [6:0] clipped_fft;
  sdf_fft #(.TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Size(Size), .Inverse(0)) u_fft (
    .clk, .rst, .en,
    .in_start(start_q[2]), .in_frame_start(frame_start_q[2]), .in_re(x_q), .in_im(Width'(0)),
    .out_start(fft_start), .out_frame_start(fft_frame_start), .out_re(fft_re), .out_im(fft_im),
    .saturations(clipped_fft)
  );

  logic signed [OutWidth-1:0] unused_im;
  logic [1:0] clipped_phase;
  twiddle_multiply #(
    .InWidth(Width), .OutWidth(OutWidth), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1 + OutputDrop),
    .Size(Size), .Block(Size), .RealOnly(1), .File({TableFolder, "phase_forward.hex"})
  ) u_phase (
    .clk, .rst, .en,
    .in_start(fft_start), .in_frame_start(fft_frame_start), .in_re(fft_re), .in_im(fft_im),
    .out_start, .out_frame_start, .out_re(out_data), .out_im(unused_im),
    .saturations(clipped_phase)
  );

  always_ff @(posedge clk) begin
    saturations <= 8'(clipped_q) + 8'(clipped_fft) + 8'(clipped_phase);
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
