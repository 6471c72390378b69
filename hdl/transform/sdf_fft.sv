// SPDX-License-Identifier: Apache-2.0
// sdf_fft: pipelined FFT, radix 2^2, single-path delay feedback (He and Torkelson, IPPS 1996), one word a clock.
//
//   X[k] = g sum x[n] W^(nk), W = exp(-2 pi j / Size)       (Inverse: exp(+2 pi j / Size))
//   g = 2^-(butterflies that halve) (1 - 2^(1 - CoeffWidth))^(twiddle stages)
//
// Stream in: bursts of Size complex words, natural order (Inverse: bit-reversed).
// Stream out: bursts, bit-reversed order (Inverse: natural).
// Latency: Size - 1 + 2 log2(Size) + 6 (twiddle stages) cycles.
//
// The chain, forward: [a, Delay = B/2] [b, Delay = B/4, turns, halves] [twiddle, if B > 4] for B = Size, Size/4, ..;
// with log2(Size) odd a last [Delay = 1]. The inverse is the same chain from its end, where [a] turns and halves in
// place of [b], and so does the lone one. Bit-accurate model: models/tactile_depth/transform/sdf_fft.py.

module sdf_fft #(
  parameter int Width      = 27,
  parameter int CoeffWidth = 18,
  parameter int Size       = 128,
  parameter int Inverse    = 0
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
  output logic [6:0]              saturations  // values clipped in a cycle, a little ago
);

  localparam int Log2Size = $clog2(Size);
  localparam int Pairs = Log2Size / 2;
  localparam int Lone = Log2Size % 2;
  localparam int Links = Pairs + Lone;  // links of the chain: pairs with their twiddle stage, and the lone butterfly

  wire [Links:0] start, frame_start;
  wire [(Links+1)*Width-1:0] re;
  wire [(Links+1)*Width-1:0] im;
  wire [Links*7-1:0] clipped;

  assign start[0] = in_start;
  assign frame_start[0] = in_frame_start;
  assign re[Width-1:0] = in_re;
  assign im[Width-1:0] = in_im;

  for (genvar i = 0; i < Links; i++) begin : g_link
    if (Lone == 1 && i == (Inverse != 0 ? 0 : Links - 1)) begin : g_lone
      wire [1:0] clipped_lone;
      sdf_butterfly #(
        .Width(Width), .Size(Size), .Delay(1), .Inverse(Inverse), .Halve(Inverse)
      ) u_lone (
        .clk, .rst, .en,
        .in_start(start[i]), .in_frame_start(frame_start[i]),
        .in_re(re[i*Width+:Width]), .in_im(im[i*Width+:Width]),
        .out_start(start[i+1]), .out_frame_start(frame_start[i+1]),
        .out_re(re[(i+1)*Width+:Width]), .out_im(im[(i+1)*Width+:Width]),
        .saturations(clipped_lone)
      );
      assign clipped[i*7+:7] = 7'(clipped_lone);
    end else begin : g_pair
      localparam int Pair = Inverse != 0 ? Links - 1 - i : i;  // counted from the largest block
      localparam int Block = Size >> (2 * Pair);
      wire first_start, first_frame_start, second_start, second_frame_start;
      wire [Width-1:0] first_re, first_im, second_re, second_im;
      wire [1:0] clipped_a, clipped_b, clipped_twiddle;
      assign clipped[i*7+:7] = 7'(clipped_a) + 7'(clipped_b) + 7'(clipped_twiddle);

      if (Inverse != 0) begin : g_inverse
        if (Block > 4) begin : g_twiddle
          twiddle_multiply #(
            .InWidth(Width), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1),
            .Size(Size), .Block(Block), .File({"twiddle_inverse_", 8'(48 + Pair), ".hex"})
          ) u_twiddle (
            .clk, .rst, .en,
            .in_start(start[i]), .in_frame_start(frame_start[i]),
            .in_re(re[i*Width+:Width]), .in_im(im[i*Width+:Width]),
            .out_start(first_start), .out_frame_start(first_frame_start),
            .out_re(first_re), .out_im(first_im),
            .saturations(clipped_twiddle)
          );
        end else begin : g_no_twiddle
          assign first_start = start[i];
          assign first_frame_start = frame_start[i];
          assign first_re = re[i*Width+:Width];
          assign first_im = im[i*Width+:Width];
          assign clipped_twiddle = '0;
        end
        sdf_butterfly #(
          .Width(Width), .Size(Size), .Delay(Block / 4), .Inverse(1)
        ) u_b (
          .clk, .rst, .en,
          .in_start(first_start), .in_frame_start(first_frame_start),
          .in_re(first_re), .in_im(first_im),
          .out_start(second_start), .out_frame_start(second_frame_start),
          .out_re(second_re), .out_im(second_im),
          .saturations(clipped_b)
        );
        sdf_butterfly #(
          .Width(Width), .Size(Size), .Delay(Block / 2), .RotateBlock(Block), .Inverse(1), .Halve(1)
        ) u_a (
          .clk, .rst, .en,
          .in_start(second_start), .in_frame_start(second_frame_start),
          .in_re(second_re), .in_im(second_im),
          .out_start(start[i+1]), .out_frame_start(frame_start[i+1]),
          .out_re(re[(i+1)*Width+:Width]), .out_im(im[(i+1)*Width+:Width]),
          .saturations(clipped_a)
        );
      end else begin : g_forward
        sdf_butterfly #(
          .Width(Width), .Size(Size), .Delay(Block / 2)
        ) u_a (
          .clk, .rst, .en,
          .in_start(start[i]), .in_frame_start(frame_start[i]),
          .in_re(re[i*Width+:Width]), .in_im(im[i*Width+:Width]),
          .out_start(first_start), .out_frame_start(first_frame_start),
          .out_re(first_re), .out_im(first_im),
          .saturations(clipped_a)
        );
        sdf_butterfly #(
          .Width(Width), .Size(Size), .Delay(Block / 4), .RotateBlock(Block), .Halve(1)
        ) u_b (
          .clk, .rst, .en,
          .in_start(first_start), .in_frame_start(first_frame_start),
          .in_re(first_re), .in_im(first_im),
          .out_start(second_start), .out_frame_start(second_frame_start),
          .out_re(second_re), .out_im(second_im),
          .saturations(clipped_b)
        );
        if (Block > 4) begin : g_twiddle
          twiddle_multiply #(
            .InWidth(Width), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1),
            .Size(Size), .Block(Block), .File({"twiddle_forward_", 8'(48 + Pair), ".hex"})
          ) u_twiddle (
            .clk, .rst, .en,
            .in_start(second_start), .in_frame_start(second_frame_start),
            .in_re(second_re), .in_im(second_im),
            .out_start(start[i+1]), .out_frame_start(frame_start[i+1]),
            .out_re(re[(i+1)*Width+:Width]), .out_im(im[(i+1)*Width+:Width]),
            .saturations(clipped_twiddle)
          );
        end else begin : g_no_twiddle
          assign start[i+1] = second_start;
          assign frame_start[i+1] = second_frame_start;
          assign re[(i+1)*Width+:Width] = second_re;
          assign im[(i+1)*Width+:Width] = second_im;
          assign clipped_twiddle = '0;
        end
      end
    end
  end

  assign out_start = start[Links];
  assign out_frame_start = frame_start[Links];
  assign out_re = re[Links*Width+:Width];
  assign out_im = im[Links*Width+:Width];

  logic [6:0] clipped_all;
  always_comb begin
    clipped_all = '0;
    for (int i = 0; i < Links; i++) clipped_all = clipped_all + clipped[i*7+:7];
  end
  always_ff @(posedge clk) begin
    saturations <= clipped_all;
    if (rst) saturations <= '0;
  end

`ifndef SYNTHESIS
  initial if (Size < 8 || Size != (1 << Log2Size)) $fatal(1, "%m: Size must be a power of two, at least 8");
`endif

endmodule
