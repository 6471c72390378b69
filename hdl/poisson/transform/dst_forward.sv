// SPDX-License-Identifier: Apache-2.0
// dst_forward: DST-II of a burst by Makhoul's method (IEEE Transactions ASSP 28, 1980), Words words a cycle.
//
//   out[p] = g sum over n of x[n] sin(pi (2n + 1) (N - k) / 2N),  k = p with its bits reversed, N = Size
//   g = 2^-(halvings of fft) (1 - 2^(1 - CoeffWidth))^(twiddle stages + 1), and the drops below
//
// Stream in: bursts of Beats = Size / Words beats, the word of path 0 in the lowest bits; starts come 2 cycles before
// the first beat. Path l has in beat t the sample at position l Beats + t in Makhoul order, as row_order sends them.
// Stream out: the same; path l has in beat t the mode at position t Words + l in bit-reversed order.
// Latency: 6 cycles + fft; bursts may have pauses between them; en low: nothing moves.
//
//   sign (-1)^n  ->  fft  ->  rotate by exp(-j pi k / 2N), real part
//
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/dst_forward.py.

`default_nettype none

module dst_forward #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Size       = 128,
  parameter int Words      = 1,  // a power of two up to Size / 2
  parameter int InWidth    = 24,
  parameter int Width      = 27,   // of the arithmetic
  parameter int CoeffWidth = 18,
  parameter int InputDrop  = 0,    // fraction bits from the input to the arithmetic; negative: added
  parameter int OutputDrop = 3,    // fraction bits from the arithmetic to the output
  parameter int OutWidth   = 24,
  parameter int Sine       = 1,    // 1: DST-II; 0: DCT-II, without the sign (-1)^n
  parameter int Parity     = 0,  // 1: a parity bit in each word of a memory
  localparam int CountWidth = 8 + $clog2(Words)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,
  input  wire                       in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Words*InWidth-1:0]  in_data,         // samples, F fraction bits
  output logic                      out_start,
  output logic                      out_frame_start,
  output logic [Words*OutWidth-1:0] out_data,        // modes, F - InputDrop - OutputDrop fraction bits
  output logic [CountWidth-1:0]     saturations,     // clip count, delayed
  output logic                      flipped          // a word that was read has a flipped bit
);

  localparam int Beats = Size / Words;
  localparam int Stages = $clog2(Size) + ($clog2(Size) - 1) / 2;

  // Samples of odd index are the second half of the row, and of the paths.
  logic [$clog2(Beats)-1:0] beat;
  logic active, start_q, frame_start_q;
  td_burst_counter #(.Words(Beats)) u_counter (
    .clk, .rst, .en, .start(in_start), .position(beat), .active
  );
  logic [1:0] active_q, second_q;
  logic [Words-1:0] clipped, clipped_q;
  logic [Words*Width-1:0] x_q;
  for (genvar path = 0; path < Words; path++) begin : g_path
    logic odd;
    logic signed [InWidth-1:0] sample;
    logic signed [InWidth:0] signed_in;
    logic signed [Width-1:0] x;
    assign sample = in_data[path*InWidth+:InWidth];
    assign odd = Words == 1 ? second_q[1] : 2 * path >= Words;
    assign signed_in = Sine != 0 && odd ? -$signed({sample[InWidth-1], sample}) : (InWidth + 1)'(sample);
    td_round_saturate #(.InWidth(InWidth + 1), .Drop(InputDrop), .OutWidth(Width)) u_input (
      .in(signed_in), .out(x), .clipped(clipped[path])
    );
    always_ff @(posedge clk) if (en) x_q[path*Width+:Width] <= x;
  end

  logic fft_flipped, phase_flipped;
  assign flipped = fft_flipped | phase_flipped;
  logic fft_start, fft_frame_start;
  logic [Words*Width-1:0] fft_re, fft_im;
  logic [$clog2(Words*Stages+1)-1:0] clipped_fft;
  fft #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Size(Size), .Paths(Words), .Inverse(0),
    .Parity(Parity)
  ) u_fft (
    .clk, .rst, .en,
    .in_start(start_q), .in_frame_start(frame_start_q), .in_re(x_q), .in_im((Words * Width)'(0)),
    .out_start(fft_start), .out_frame_start(fft_frame_start), .out_re(fft_re), .out_im(fft_im),
    .saturations(clipped_fft), .flipped(fft_flipped)
  );

  logic [$clog2(2*Words+1)-1:0] clipped_phase;
  twiddle #(
    .InWidth(Width), .OutWidth(OutWidth), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1 + OutputDrop), .Paths(Words),
    .Beats(Beats), .RealOnly(1), .File({TableFolder, "phase_forward.hex"}), .Parity(Parity)
  ) u_phase (
    .clk, .rst, .en,
    .in_start(fft_start), .in_frame_start(fft_frame_start), .in_re(fft_re), .in_im(fft_im),
    .out_start, .out_frame_start, .out_re(out_data), .out_im(), .saturations(clipped_phase),
    .flipped(phase_flipped)
  );

  logic [CountWidth-1:0] count;
  always_comb begin
    count = CountWidth'(clipped_fft) + CountWidth'(clipped_phase);
    for (int i = 0; i < Words; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      active_q <= {active_q[0], active};
      second_q <= {second_q[0], beat[$clog2(Beats)-1]};
      start_q <= in_start;
      frame_start_q <= in_frame_start;
    end
    clipped_q <= clipped & {Words{en & active_q[1]}};
    saturations <= count;
    if (rst) {active_q, start_q, frame_start_q, clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
