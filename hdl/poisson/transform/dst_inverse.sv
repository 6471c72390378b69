// SPDX-License-Identifier: Apache-2.0
// dst_inverse: inverse DST-II of two rows in one complex transform.
//
//   row a is the real part of the transform, row b its imaginary part; times the gain of the coefficients,
//   (1 - 2^(1 - CoeffWidth))^(twiddle stages + 1)
//
// Stream in: bursts of Size / Paths beats, Paths modes of each row a beat, in bit-reversed order as row_pairs takes
// them. in_alone: row a alone, all modes of b are 0 and its samples do not count. Stream out: the same
// bursts; path l has in beat t the samples at position l Beats + t in Makhoul order (0, 2, 4, .., 5, 3, 1). Starts of
// both come 2 cycles before the first beat, path 0 is in the lowest bits. Latency: Beats / 2 + 10 cycles + fft;
// bursts may have pauses between them; en low: nothing moves.
//
//   row_pairs  ->  rotate by exp(j pi k / 2N) / j  ->  inverse fft  ->  sign (-1)^n
//
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/dst_inverse.py.

`default_nettype none

module dst_inverse #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Size       = 128,
  parameter int Paths      = 1,    // a power of two up to Size / 4
  parameter int InWidth    = 27,
  parameter int InputDrop  = 0,    // fraction bits from the input to the arithmetic; negative: added
  parameter int Width      = 27,   // of the arithmetic
  parameter int CoeffWidth = 18,
  parameter int OutputDrop = 3,    // fraction bits from the arithmetic to the output
  parameter int OutWidth   = 24,
  parameter int Sine       = 1,    // 1: DST-II; 0: DCT-II, without the sign (-1)^n
  parameter int Parity     = 0,  // 1: a parity bit in each word of a memory
  localparam int CountWidth = 8 + $clog2(Paths)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,
  input  wire                       in_frame_start,  // with in_start: the first burst of a frame
  input  wire                       in_alone,        // with in_start
  input  wire  [Paths*InWidth-1:0]  in_a,            // modes, F fraction bits
  input  wire  [Paths*InWidth-1:0]  in_b,
  output logic                      out_start,
  output logic                      out_frame_start,
  output logic                      out_alone,       // with out_start
  output logic [Paths*OutWidth-1:0] out_a,           // samples, F - InputDrop - OutputDrop fraction bits
  output logic [Paths*OutWidth-1:0] out_b,
  output logic [CountWidth-1:0]     saturations,     // clip count, delayed
  output logic                      flipped          // a word that was read has a flipped bit
);

  localparam int Beats = Size / Paths;
  localparam int BeatWidth = $clog2(Beats);
  localparam int Log2Size = $clog2(Size);
  localparam int Twiddles = (Log2Size - 1) / 2;
  localparam int Stages = Log2Size + Twiddles;
  localparam int ToRotated = Beats / 2 + 3 + 5;
  localparam int ToTransformed = ToRotated + Beats - 1 + 2 * Log2Size + 5 * Twiddles;

  logic pairs_flipped, phase_flipped, fft_flipped, alone_flipped;
  assign flipped = pairs_flipped | phase_flipped | fft_flipped | alone_flipped;
  logic pair_start, pair_frame_start;
  logic [Paths*InWidth-1:0] pair_re, pair_im;
  logic [$clog2(2*Paths+1)-1:0] clipped_pairs;
  row_pairs #(.Width(InWidth), .Size(Size), .Paths(Paths), .Parity(Parity)) u_pairs (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_a, .in_b,
    .out_start(pair_start), .out_frame_start(pair_frame_start), .out_re(pair_re), .out_im(pair_im),
    .saturations(clipped_pairs), .flipped(pairs_flipped)
  );

  logic rotated_start, rotated_frame_start;
  logic [Paths*Width-1:0] rotated_re, rotated_im;
  logic [$clog2(2*Paths+1)-1:0] clipped_phase;
  twiddle #(
    .InWidth(InWidth), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1 + InputDrop), .Paths(Paths),
    .Beats(Beats), .File({TableFolder, "phase_inverse.hex"}), .Parity(Parity)
  ) u_phase (
    .clk, .rst, .en,
    .in_start(pair_start), .in_frame_start(pair_frame_start), .in_re(pair_re), .in_im(pair_im),
    .out_start(rotated_start), .out_frame_start(rotated_frame_start), .out_re(rotated_re), .out_im(rotated_im),
    .saturations(clipped_phase), .flipped(phase_flipped)
  );

  logic fft_start, fft_frame_start;
  logic [Paths*Width-1:0] fft_re, fft_im;
  logic [$clog2(Paths*Stages+1)-1:0] clipped_fft;
  fft #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Size(Size), .Paths(Paths), .Inverse(1),
    .Parity(Parity)
  ) u_fft (
    .clk, .rst, .en,
    .in_start(rotated_start), .in_frame_start(rotated_frame_start), .in_re(rotated_re), .in_im(rotated_im),
    .out_start(fft_start), .out_frame_start(fft_frame_start), .out_re(fft_re), .out_im(fft_im),
    .saturations(clipped_fft), .flipped(fft_flipped)
  );

  // Samples of odd index are the second half of the positions.
  logic [BeatWidth-1:0] beat;
  logic active;
  logic [1:0] second_q;
  logic [2:0] active_q;
  td_burst_counter #(.Words(Beats)) u_counter (
    .clk, .rst, .en, .start(fft_start), .position(beat), .active
  );
  logic [2*Paths-1:0] clipped, clipped_q;
  for (genvar path = 0; path < Paths; path++) begin : g_path
    logic negative;
    assign negative = Sine != 0 && (Paths == 1 ? second_q[1] : 2 * path >= Paths);
    for (genvar row = 0; row < 2; row++) begin : g_row
      logic signed [Width-1:0] x;
      logic signed [Width:0] signed_x;
      logic signed [OutWidth-1:0] rounded;
      assign x = row == 0 ? fft_re[path*Width+:Width] : fft_im[path*Width+:Width];
      td_round_saturate #(.InWidth(Width + 1), .Drop(OutputDrop), .OutWidth(OutWidth)) u_output (
        .in(signed_x), .out(rounded), .clipped(clipped[2*path+row])
      );
      always_ff @(posedge clk) begin
        if (en) begin
          signed_x <= negative ? -$signed({x[Width-1], x}) : (Width + 1)'(x);
          if (row == 0) out_a[path*OutWidth+:OutWidth] <= rounded;
          else out_b[path*OutWidth+:OutWidth] <= rounded;
        end
      end
    end
  end

  logic alone, start_q, frame_start_q;  // alone: of the samples present
  td_delay_line #(.Width(1), .Delay(ToTransformed + 2), .Parity(Parity)) u_alone (
    .clk, .rst, .en, .in(in_alone), .out(out_alone), .flipped(alone_flipped)
  );

  logic [CountWidth-1:0] count;
  always_comb begin
    count = CountWidth'(clipped_pairs) + CountWidth'(clipped_phase) + CountWidth'(clipped_fft);
    for (int i = 0; i < 2 * Paths; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      second_q <= {second_q[0], beat[BeatWidth-1]};
      active_q <= {active_q[1:0], active};
      start_q <= fft_start;
      frame_start_q <= fft_frame_start;
      out_start <= start_q;
      out_frame_start <= frame_start_q;
      if (out_start) alone <= out_alone;
    end
    clipped_q <= clipped & {2 * Paths{en & active_q[2]}} & {Paths{~alone, 1'b1}};
    saturations <= count;
    if (rst) {active_q, start_q, frame_start_q, out_start, out_frame_start, clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
