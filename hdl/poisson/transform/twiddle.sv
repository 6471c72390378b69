// SPDX-License-Identifier: Apache-2.0
// twiddle: multiplies the words of several paths by complex factors from one ROM.
//
//   out = sat( round( in w / 2^Drop ) ),  w = factor of the path in word (beat) of the ROM
//
// Stream in: bursts of Beats beats, Paths complex words each, path 0 in the lowest bits; starts come 2 cycles before
// the first beat. Stream out: the same. Latency: 5 cycles; bursts may have pauses between them; en low: nothing moves.
// A path whose bit of Ones is 1 has the factor 1 in every beat, which is 2^(CoeffWidth-1) - 1: a subtraction takes the
// place of its multipliers. Bit-accurate model: models/tactile_depth/chip/poisson/transform/twiddle.py.

`default_nettype none

module twiddle #(
  parameter int InWidth    = 27,
  parameter int OutWidth   = 27,
  parameter int CoeffWidth = 18,
  parameter int Drop       = 17,
  parameter int Paths      = 4,  // a power of two
  parameter int Beats      = 32,  // a power of two
  parameter int Block      = Beats,  // a power of two up to Beats: beats that repeat their factors
  parameter int RealOnly   = 0,                            // out_im is 0
  parameter logic [Paths-1:0] Ones = '0,
  parameter int Parity     = 0,  // 1: a parity bit in each word of a memory
  parameter     File       = "twiddle_inverse_0.hex", // Block words: {-Im, Im, Re} of each path, path 0 lowest
  localparam int CountWidth = $clog2(2 * Paths + 1)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,
  input  wire                       in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Paths*InWidth-1:0]  in_re,           // F fraction bits, as in_im
  input  wire  [Paths*InWidth-1:0]  in_im,
  output logic                      out_start,
  output logic                      out_frame_start,
  output logic [Paths*OutWidth-1:0] out_re,          // F + CoeffWidth - 1 - Drop fraction bits, as out_im
  output logic [Paths*OutWidth-1:0] out_im,
  output logic [CountWidth-1:0]     saturations,     // clip count, delayed
  output logic                      flipped          // a word that was read has a flipped bit
);

  localparam int SumWidth = InWidth + CoeffWidth + 1;
  localparam int ToProduct = 4;  // cycles from a word to its exact product
  localparam int ToSum = 6;      // cycles from its start: ROM, a register behind it, product
  localparam int BeatWidth = $clog2(Beats);
  localparam int BlockWidth = $clog2(Block);
  localparam int FactorWidth = 3 * CoeffWidth;

  logic [BeatWidth-1:0] beat;
  logic active;
  td_burst_counter #(.Words(Beats)) u_counter (
    .clk, .rst, .en, .start(in_start), .position(beat), .active
  );

  // A block memory takes long to give a word, a distributed one has the longer way to its words.
  localparam int InBlockAbove = Paths == 1 ? td_memory_pkg::DistributedBits : td_memory_pkg::LateBits;
  localparam int InBlock = FactorWidth * Block > InBlockAbove ? 1 : 0;
  logic [BlockWidth-1:0] address;
  logic [Paths*FactorWidth-1:0] factors;
  logic factors_flipped;
  logic [Paths-1:0] late_flipped;
  assign flipped = factors_flipped | (late_flipped != '0);
  td_parity_rom #(
    .Width(Paths * FactorWidth), .Depth(Block), .File(File), .Style(InBlock), .Latency(1 + InBlock), .Parity(Parity)
  ) u_rom (
    .clk, .en, .address, .data(factors), .flipped(factors_flipped)
  );
  if (InBlock != 0) begin : g_register_behind
    assign address = beat[BlockWidth-1:0];
  end else begin : g_register_in_front
    always_ff @(posedge clk) if (en) address <= beat[BlockWidth-1:0];
  end

  logic [2*Paths-1:0] clipped;  // real part, imaginary part of each path
  for (genvar path = 0; path < Paths; path++) begin : g_path
    logic [1:0][InWidth-1:0] word;  // real part, imaginary part
    assign word = {in_im[path*InWidth+:InWidth], in_re[path*InWidth+:InWidth]};

    if (Ones[path]) begin : g_one
      // word - word / 2^Drop, the quotient rounded to even: a tie has an even word, so this is the product rounded.
      logic [1:0][InWidth-1:0] late, gained_q;
      td_delay_line #(.Width(2 * InWidth), .Delay(ToProduct), .Parity(Parity)) u_late (
        .clk, .rst, .en, .in(word), .out(late), .flipped(late_flipped[path])
      );
      for (genvar part = 0; part < 2; part++) begin : g_part
        logic [InWidth-1:0] quotient, gained;
        logic up, unused_carry;  // up: the quotient is rounded up
        assign quotient = {{Drop{late[part][InWidth-1]}}, late[part][InWidth-1:Drop]};
        assign up = late[part][Drop-1] & (late[part][Drop] | (late[part][Drop-2:0] != '0));
        assign {gained, unused_carry} = {late[part], 1'b1} + {~quotient, ~up};
        always_ff @(posedge clk) if (en) gained_q[part] <= gained;
      end
      assign {out_im[path*OutWidth+:OutWidth], out_re[path*OutWidth+:OutWidth]} = gained_q;
      assign clipped[2*path+:2] = '0;
    end else begin : g_product
      logic signed [CoeffWidth-1:0] w_re, w_im, w_minus_im;
      logic [1:0][SumWidth-1:0] sum;
      assign late_flipped[path] = 1'b0;
      assign {w_minus_im, w_im, w_re} = factors[path*FactorWidth+:FactorWidth];
      td_dot_product #(.AWidth(InWidth), .BWidth(CoeffWidth)) u_re (
        .clk, .en, .a0(word[0]), .b0(w_re), .a1(word[1]), .b1(w_minus_im), .sum(sum[0])
      );
      if (RealOnly == 0) begin : g_complex
        td_dot_product #(.AWidth(InWidth), .BWidth(CoeffWidth)) u_im (
          .clk, .en, .a0(word[0]), .b0(w_im), .a1(word[1]), .b1(w_re), .sum(sum[1])
        );
      end else begin : g_real_only
        assign sum[1] = '0;
      end
      for (genvar part = 0; part < 2; part++) begin : g_round
        logic signed [OutWidth-1:0] rounded, rounded_q;
        td_round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(OutWidth)) u_round (
          .in(sum[part]), .out(rounded), .clipped(clipped[2*path+part])
        );
        always_ff @(posedge clk) if (en) rounded_q <= rounded;
        if (part == 0) begin : g_re
          assign out_re[path*OutWidth+:OutWidth] = rounded_q;
        end else begin : g_im
          assign out_im[path*OutWidth+:OutWidth] = rounded_q;
        end
      end
    end
  end

  logic [ToProduct-1:0] start_q, frame_start_q;
  logic [ToSum-1:0] active_q;
  logic [2*Paths-1:0] clipped_q;
  logic [CountWidth-1:0] count;
  always_comb begin
    count = '0;
    for (int i = 0; i < 2 * Paths; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[ToProduct-2:0], in_start};
      frame_start_q <= {frame_start_q[ToProduct-2:0], in_frame_start};
      active_q <= {active_q[ToSum-2:0], active};
      out_start <= start_q[ToProduct-1];
      out_frame_start <= frame_start_q[ToProduct-1];
    end
    clipped_q <= clipped & {2 * Paths{en & active_q[ToSum-1]}};
    saturations <= count;
    if (rst) {start_q, frame_start_q, active_q, out_start, out_frame_start, clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
