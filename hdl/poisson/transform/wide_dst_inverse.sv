// SPDX-License-Identifier: Apache-2.0
// wide_dst_inverse: inverse DST-II of two rows in one complex transform, Words samples of a row per cycle.
//
//   gain of dst_inverse; row a is the real part of the transform, row b its imaginary part
//
// Stream in: bursts of 2 Size / Words beats, Words modes each: row a, then row b, in the order of wide_row_pairs;
// starts come 2 cycles before the first beat. in_alone: row a alone, no row b leaves. Stream out: row a, then row b,
// each a burst of Size / Words beats of Words samples in natural order; starts come with the first beat. The first word
// of a beat is in the lowest bits. Latency from start to start: 5 Size / Words + 12 + 2 log2(Size) + 5 (twiddle stages)
// cycles; with 2 words 7 (twiddle stages) + 2. Bursts may have pauses between them; en low: nothing moves.
//
//   wide_row_pairs  ->  rotate by exp(j pi k / 2N) / j  ->  inverse wide_fft  ->  sign (-1)^n  ->  wide_corner_turn
//
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/wide_dst_inverse.py.

`default_nettype none

module wide_dst_inverse #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Size       = 128,
  parameter int Words      = 8,  // a power of two, 2 to Size / 2
  parameter int InWidth    = 27,
  parameter int InputDrop  = 0,    // fraction bits from the input to the arithmetic; negative: added
  parameter int Width      = 27,   // of the arithmetic
  parameter int CoeffWidth = 18,
  parameter int OutputDrop = 3,    // fraction bits from the arithmetic to the output
  parameter int OutWidth   = 24,
  parameter int Sine       = 1,    // 1: DST-II; 0: DCT-II, without the sign (-1)^n
  localparam int CountWidth = 8 + $clog2(Words)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,
  input  wire                       in_frame_start,  // with in_start: the first burst of a frame
  input  wire                       in_alone,        // with in_start
  input  wire  [Words*InWidth-1:0]  in_data,         // modes, F fraction bits
  output logic                      out_start,
  output logic                      out_frame_start,
  output logic [Words*OutWidth-1:0] out_data,        // samples, F - InputDrop - OutputDrop fraction bits
  output logic [CountWidth-1:0]     saturations      // clip count, delayed
);

  localparam int Paths = Words / 2;
  localparam int Beats = Size / Paths;
  localparam int BeatWidth = $clog2(Beats);
  localparam int Log2Size = $clog2(Size);
  localparam int Twiddles = (Log2Size - 1) / 2;
  localparam int Stages = Log2Size + Twiddles;
  localparam int ToPairs = Beats / 2 + 2;
  localparam int ToRotated = ToPairs + 5;
  localparam int ToTransformed = ToRotated + Beats - 1 + 2 * Log2Size + (Paths == 1 ? 7 * Twiddles + 2 : 5 * Twiddles);

  logic pair_start, pair_frame_start;
  logic [Paths*InWidth-1:0] pair_re, pair_im;
  logic [$clog2(4*Paths+1)-1:0] clipped_pairs;
  wide_row_pairs #(.Width(InWidth), .Size(Size), .Paths(Paths)) u_pairs (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_alone, .in_data,
    .out_start(pair_start), .out_frame_start(pair_frame_start), .out_re(pair_re), .out_im(pair_im),
    .saturations(clipped_pairs)
  );

  logic rotated_start, rotated_frame_start;
  logic [Paths*Width-1:0] rotated_re, rotated_im;
  logic [$clog2(2*Paths+1)-1:0] clipped_phase;
  wide_twiddle #(
    .InWidth(InWidth), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1 + InputDrop), .Paths(Paths),
    .Beats(Beats), .File({TableFolder, "wide_phase_inverse.hex"})
  ) u_phase (
    .clk, .rst, .en,
    .in_start(pair_start), .in_frame_start(pair_frame_start), .in_re(pair_re), .in_im(pair_im),
    .out_start(rotated_start), .out_frame_start(rotated_frame_start), .out_re(rotated_re), .out_im(rotated_im),
    .saturations(clipped_phase)
  );

  logic fft_start, fft_frame_start;
  logic [Paths*Width-1:0] fft_re, fft_im;
  logic [$clog2(2*Paths*Stages+1)-1:0] clipped_fft;
  wide_fft #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Size(Size), .Paths(Paths), .Inverse(1)
  ) u_fft (
    .clk, .rst, .en,
    .in_start(rotated_start), .in_frame_start(rotated_frame_start), .in_re(rotated_re), .in_im(rotated_im),
    .out_start(fft_start), .out_frame_start(fft_frame_start), .out_re(fft_re), .out_im(fft_im),
    .saturations(clipped_fft)
  );

  // Samples of odd index are the second half of the positions.
  logic [BeatWidth-1:0] beat;
  logic active;
  logic [1:0] second_q;
  logic [2:0] active_q;
  td_burst_counter #(.Words(Beats)) u_counter (
    .clk, .rst, .en, .start(fft_start), .position(beat), .active
  );
  logic [1:0][Paths*OutWidth-1:0] rounded_q;  // row a, row b
  logic [Words-1:0] clipped, clipped_q;
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
          rounded_q[row][path*OutWidth+:OutWidth] <= rounded;
        end
      end
    end
  end

  logic alone, alone_q;  // with the start at the corner turn; behind it
  logic [1:0] start_q, frame_start_q;
  td_delay_line #(.Width(1), .Delay(ToTransformed + 2)) u_alone (
    .clk, .rst, .en, .in(in_alone), .out(alone)
  );
  wide_corner_turn #(.Width(OutWidth), .Size(Size), .Paths(Paths)) u_corner_turn (
    .clk, .rst, .en, .in_start(start_q[1]), .in_frame_start(frame_start_q[1]), .in_alone(alone),
    .in_a(rounded_q[0]), .in_b(rounded_q[1]), .out_start, .out_frame_start, .out_data
  );

  logic [CountWidth-1:0] count;
  always_comb begin
    count = CountWidth'(clipped_pairs) + CountWidth'(clipped_phase) + CountWidth'(clipped_fft);
    for (int i = 0; i < Words; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      second_q <= {second_q[0], beat[BeatWidth-1]};
      active_q <= {active_q[1:0], active};
      start_q <= {start_q[0], fft_start};
      frame_start_q <= {frame_start_q[0], fft_frame_start};
      if (start_q[1]) alone_q <= alone;
    end
    clipped_q <= clipped & {Words{en & active_q[2]}} & {Paths{~alone_q, 1'b1}};
    saturations <= count;
    if (rst) {active_q, start_q, frame_start_q, clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
