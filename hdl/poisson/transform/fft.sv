// SPDX-License-Identifier: Apache-2.0
// fft: pipelined FFT, radix 2^2, Paths words a cycle, with the same codes for every number of paths.
//
//   X[k] = g sum x[n] W^(nk), W = exp(-2 pi j / Size)       (Inverse: exp(+2 pi j / Size))
//   g = 2^-(butterflies that halve) (1 - 2^(1 - CoeffWidth))^(twiddle stages)
//
// Stream in: bursts of Beats = Size / Paths beats, Paths complex words each, path 0 in the lowest bits; starts come 2
// cycles before the first beat. Position p of a word is path Beats + beat (Inverse: beat Paths + path). Stream out: the
// same, p = beat Paths + path (Inverse: path Beats + beat). Natural order in, bit-reversed order out (Inverse: the
// reverse). Latency: Beats - 1 + 2 log2(Size) + 5 (twiddle stages) cycles; bursts may have pauses between them; en low:
// nothing moves.
//
// Stages, forward: two butterflies and a twiddle multiplication for each block of Size, Size / 4, .. points, without
// the multiplication for a block of 4 and with one butterfly alone for a block of 2. The inverse has the same stages
// from the last to the first. The second butterfly of a pair in stream order rotates and halves; the lone one halves in
// the inverse.
//
// One path: single-path delay feedback (He and Torkelson, IPPS 1996). More: multi-path delay commutator. In each stage
// the path number is a window of log2(Paths) bits of the position, p = {t[high:s], path, t[s-1:0]}. Before a pair of
// butterflies (Inverse: before its twiddle multiplication) commutators move it to the bits of the pair: down from the
// top bits (Inverse: up from the lowest ones). So with 4 paths or more a quarter of the factors are always 1.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/fft.py.

`default_nettype none

module fft #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width      = 27,
  parameter int CoeffWidth = 18,
  parameter int Size       = 128,  // a power of two, at least 8
  parameter int Paths      = 2,  // a power of two up to Size / 2
  parameter int Inverse    = 0,
  parameter int Parity     = 0,  // 1: a parity bit in each word of a memory
  localparam int Log2Size = $clog2(Size),
  localparam int Stages = Log2Size + (Log2Size - 1) / 2,
  localparam int CountWidth = $clog2(Paths * Stages + 1)  // of a sum and its difference, or of a product, one clips
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    in_start,
  input  wire                    in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Paths*Width-1:0] in_re,           // codes; out_ has the same Q format
  input  wire  [Paths*Width-1:0] in_im,
  output logic                   out_start,
  output logic                   out_frame_start,
  output logic [Paths*Width-1:0] out_re,
  output logic [Paths*Width-1:0] out_im,
  output logic [CountWidth-1:0]  saturations,     // clip count, delayed
  output logic                   flipped          // a word that was read has a flipped bit
);

  localparam int PathWidth = $clog2(Paths);
  localparam int Beats = Size / Paths;
  localparam int BeatWidth = $clog2(Beats);
  localparam int StageCountWidth = $clog2(2 * Paths + 1);

  // Lowest bit of the position in the path number of a stage: `part` as below, `bits` of a position in the block.
  function automatic int window(input int bits, input int part);
    if (Paths == 2) window = part == 0 ? bits - 1 : bits - 2;
    else if (Inverse != 0) window = bits < PathWidth ? 0 : bits - PathWidth;
    else window = bits < 2 ? 0 : bits - 2 < BeatWidth ? bits - 2 : BeatWidth;
  endfunction

  // Paths whose factors are 1 in every beat: the first quarter of a block, and the first word of each quarter.
  function automatic logic [Paths-1:0] ones(input int block, input int lowest);
    ones = '1;
    for (int p = 0; p < Size; p++) begin
      if (p % block >= block / 4 && p % (block / 4) != 0) ones[(p/(1<<lowest))%Paths] = 1'b0;
    end
  endfunction

  wire [Stages:0] start, frame_start;
  wire [Stages:0][Paths*Width-1:0] re, im;
  wire [Stages-1:0][StageCountWidth-1:0] clipped;
  wire [Stages-1:0][2:0] flips;  // of the commutators and the stage behind them
  assign flipped = flips != '0;
  assign start[0] = in_start;
  assign frame_start[0] = in_frame_start;
  assign re[0] = in_re;
  assign im[0] = in_im;

  for (genvar i = 0; i < Stages; i++) begin : g_stage
    localparam int Forward = Inverse != 0 ? Stages - 1 - i : i;  // position of this stage in the forward transform
    localparam int Pair = Forward / 3;
    localparam int Part = Forward % 3;  // of the pair: first butterfly, second one, twiddle multiplication
    localparam int Block = Size >> (2 * Pair);
    localparam int Window = window($clog2(Block), Part);
    localparam int Before = Inverse != 0 ? Forward + 1 : Forward - 1;  // the stage before this one
    localparam int WindowBefore = i == 0 ? (Inverse != 0 ? 0 : BeatWidth) :
        window(Log2Size - 2 * (Before / 3), Before % 3);
    localparam int Moves = Paths == 1 ? 0 : Inverse != 0 ? Window - WindowBefore : WindowBefore - Window;
    localparam int Halve = Part == (Inverse != 0 ? 0 : 1) ? 1 : 0;

    wire once_start, once_frame_start, moved_start, moved_frame_start;
    wire [Paths*Width-1:0] once_re, once_im, moved_re, moved_im;
    if (Moves > 0) begin : g_move_0
      localparam int Delay = 1 << (Inverse != 0 ? WindowBefore : WindowBefore - 1);
      commutator #(
        .Width(Width), .Paths(Paths), .Beats(Beats), .Delay(Delay), .Up(Inverse), .Parity(Parity)
      ) u_commutator (
        .clk, .rst, .en, .in_start(start[i]), .in_frame_start(frame_start[i]), .in_re(re[i]), .in_im(im[i]),
        .out_start(once_start), .out_frame_start(once_frame_start), .out_re(once_re), .out_im(once_im),
        .flipped(flips[i][0])
      );
    end else begin : g_stay_0
      assign once_start = start[i];
      assign once_frame_start = frame_start[i];
      assign once_re = re[i];
      assign once_im = im[i];
      assign flips[i][0] = 1'b0;
    end
    if (Moves > 1) begin : g_move_1
      localparam int Delay = 1 << (Inverse != 0 ? WindowBefore + 1 : WindowBefore - 2);
      commutator #(
        .Width(Width), .Paths(Paths), .Beats(Beats), .Delay(Delay), .Up(Inverse), .Parity(Parity)
      ) u_commutator (
        .clk, .rst, .en, .in_start(once_start), .in_frame_start(once_frame_start), .in_re(once_re), .in_im(once_im),
        .out_start(moved_start), .out_frame_start(moved_frame_start), .out_re(moved_re), .out_im(moved_im),
        .flipped(flips[i][1])
      );
    end else begin : g_stay_1
      assign moved_start = once_start;
      assign moved_frame_start = once_frame_start;
      assign moved_re = once_re;
      assign moved_im = once_im;
      assign flips[i][1] = 1'b0;
    end

    if (Part == 2) begin : g_twiddle
      twiddle #(
        .InWidth(Width), .OutWidth(Width), .CoeffWidth(CoeffWidth), .Drop(CoeffWidth - 1), .Paths(Paths),
        .Beats(Beats), .Block(Paths == 1 ? Block : Beats), .Ones(ones(Block, Window)), .Parity(Parity),
        .File({TableFolder, Inverse != 0 ? "twiddle_inverse_" : "twiddle_forward_", "0" + 8'(Pair), ".hex"})
      ) u_twiddle (
        .clk, .rst, .en,
        .in_start(moved_start), .in_frame_start(moved_frame_start), .in_re(moved_re), .in_im(moved_im),
        .out_start(start[i+1]), .out_frame_start(frame_start[i+1]), .out_re(re[i+1]), .out_im(im[i+1]),
        .saturations(clipped[i]), .flipped(flips[i][2])
      );
    end else if (Paths == 1) begin : g_single_path
      sdf_butterfly #(
        .Width(Width), .Size(Size), .Delay(Block >> (Part + 1)), .RotateBlock(Halve != 0 && Block > 2 ? Block : 0),
        .Inverse(Inverse), .Halve(Halve), .Parity(Parity)
      ) u_butterfly (
        .clk, .rst, .en,
        .in_start(moved_start), .in_frame_start(moved_frame_start), .in_re(moved_re), .in_im(moved_im),
        .out_start(start[i+1]), .out_frame_start(frame_start[i+1]), .out_re(re[i+1]), .out_im(im[i+1]),
        .saturations(clipped[i]), .flipped(flips[i][2])
      );
    end else begin : g_butterfly
      localparam int Bit = $clog2(Block) - 1 - Part;         // of the position
      localparam int Other = Inverse != 0 ? Bit - 1 : Bit + 1;  // of the other butterfly of the pair
      localparam int OtherInBeat = Inverse != 0 ? Other : Bit;
      butterfly #(
        .Width(Width), .Paths(Paths), .Beats(Beats), .PathBit(Bit - Window), .Inverse(Inverse), .Halve(Halve),
        .RotateBit(Halve == 0 || Block == 2 ? -1 : Paths == 2 ? PathWidth + OtherInBeat : Other - Window)
      ) u_butterfly (
        .clk, .rst, .en,
        .in_start(moved_start), .in_frame_start(moved_frame_start), .in_re(moved_re), .in_im(moved_im),
        .out_start(start[i+1]), .out_frame_start(frame_start[i+1]), .out_re(re[i+1]), .out_im(im[i+1]),
        .saturations(clipped[i])
      );
      assign flips[i][2] = 1'b0;
    end
  end

  assign out_start = start[Stages];
  assign out_frame_start = frame_start[Stages];
  assign out_re = re[Stages];
  assign out_im = im[Stages];

  logic [CountWidth-1:0] clipped_all;
  always_comb begin
    clipped_all = '0;
    for (int i = 0; i < Stages; i++) clipped_all = clipped_all + CountWidth'(clipped[i]);
  end
  always_ff @(posedge clk) begin
    saturations <= clipped_all;
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
