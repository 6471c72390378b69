// SPDX-License-Identifier: Apache-2.0
// sdf_fft: pipelined FFT, radix 2^2, single-path delay feedback (He and Torkelson, IPPS 1996), one word a cycle.
//
//   X[k] = g sum x[n] W^(nk), W = exp(-2 pi j / Size)       (Inverse: exp(+2 pi j / Size))
//   g = 2^-(butterflies that halve) (1 - 2^(1 - CoeffWidth))^(twiddle stages)
//
// Stream in: bursts of Size complex words, natural order (Inverse: bit-reversed).
// Stream out: bursts, bit-reversed order (Inverse: natural).
// Latency: Size - 1 + 2 log2(Size) + 7 (twiddle stages) cycles; en low: nothing moves.
//
// Stages, forward: two butterflies and a twiddle multiplication for each block of Size, Size / 4, .. points, without
// the multiplication for a block of 4 and with one butterfly alone for a block of 2. The inverse has the same stages
// from the last to the first. The second butterfly of a pair in stream order rotates and halves, see sdf_butterfly; the
// lone one halves in the inverse. Bit-accurate model: models/tactile_depth/chip/poisson/transform/sdf_fft.py.

`default_nettype none

module sdf_fft #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width      = 27,
  parameter int CoeffWidth = 18,
  parameter int Size       = 128,  // a power of two, at least 8
  parameter int Inverse    = 0
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,
  input  wire                     in_frame_start,   // with in_start: the first burst of a frame
  input  wire  signed [Width-1:0] in_re,           // code; out_ has the same Q format
  input  wire  signed [Width-1:0] in_im,
  output logic                    out_start,
  output logic                    out_frame_start,
  output logic signed [Width-1:0] out_re,
  output logic signed [Width-1:0] out_im,
  output logic [6:0]              saturations      // clip count, delayed
);

  localparam int Log2Size = $clog2(Size);
  localparam int Stages = Log2Size + (Log2Size - 1) / 2;

  wire [Stages:0] start, frame_start;
  wire [Stages:0][Width-1:0] re, im;
  wire [Stages-1:0][1:0] clipped;

  assign start[0] = in_start;
  assign frame_start[0] = in_frame_start;
  assign re[0] = in_re;
  assign im[0] = in_im;

  for (genvar i = 0; i < Stages; i++) begin : g_stage
    localparam int Forward = Inverse != 0 ? Stages - 1 - i : i;  // position of this stage in the forward transform
    localparam int Pair = Forward / 3;
    localparam int Part = Forward % 3;  // of the pair: first butterfly, second one, twiddle multiplication
    localparam int Block = Size >> (2 * Pair);
    if (Part == 2) begin : g_twiddle
      twiddle_multiply #(
        .InWidth(Width), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1), .Size(Size), .Block(Block),
        .File({TableFolder, Inverse != 0 ? "twiddle_inverse_" : "twiddle_forward_", "0" + 8'(Pair), ".hex"})
      ) u_twiddle (
        .clk, .rst, .en, .in_start(start[i]), .in_frame_start(frame_start[i]), .in_re(re[i]), .in_im(im[i]),
        .out_start(start[i+1]), .out_frame_start(frame_start[i+1]), .out_re(re[i+1]), .out_im(im[i+1]),
        .saturations(clipped[i])
      );
    end else begin : g_butterfly
      localparam int Halve = Part == (Inverse != 0 ? 0 : 1) ? 1 : 0;
      sdf_butterfly #(
        .Width(Width), .Size(Size), .Delay(Block >> (Part + 1)), .RotateBlock(Halve != 0 && Block > 2 ? Block : 0),
        .Inverse(Inverse), .Halve(Halve)
      ) u_butterfly (
        .clk, .rst, .en, .in_start(start[i]), .in_frame_start(frame_start[i]), .in_re(re[i]), .in_im(im[i]),
        .out_start(start[i+1]), .out_frame_start(frame_start[i+1]), .out_re(re[i+1]), .out_im(im[i+1]),
        .saturations(clipped[i])
      );
    end
  end

  assign out_start = start[Stages];
  assign out_frame_start = frame_start[Stages];
  assign out_re = re[Stages];
  assign out_im = im[Stages];

  logic [1:0][6:0] clipped_all, clipped_q;  // in even and in odd stages
  always_comb begin
    clipped_all = '0;
    for (int i = 0; i < Stages; i++) clipped_all[i%2] = clipped_all[i%2] + 7'(clipped[i]);
  end
  always_ff @(posedge clk) begin
    clipped_q <= clipped_all;
    saturations <= clipped_q[0] + clipped_q[1];
    if (rst) {clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
