// SPDX-License-Identifier: Apache-2.0
// twiddle_multiply: multiplies the words of a stream by complex factors from a ROM.
//
//   out = sat( round( in w / 2^Drop ) ),  w = word (position mod Block) of the ROM
//
// Stream in: bursts of Size complex words. Stream out: the same. Latency: 7 cycles; en low: nothing moves.
// A factor of 1 is 2^(CoeffWidth-1) - 1, so with Drop = CoeffWidth - 1 the gain is 1 - 2^(1 - CoeffWidth).
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/twiddle_multiply.py, which also says what the ROMs
// hold.

`default_nettype none

module twiddle_multiply #(
  parameter int InWidth    = 27,
  parameter int OutWidth   = 27,
  parameter int CoeffWidth = 18,
  parameter int Drop       = 17,
  parameter int Size       = 128,  // a power of two
  parameter int Block      = 128,  // a power of two up to Size
  parameter int RealOnly   = 0,                       // out_im is 0
  parameter     File       = "twiddle_forward_0.hex"  // Block words {-Im, Im, Re} of the factor
) (
  input  wire                        clk,
  input  wire                        rst,
  input  wire                        en,
  input  wire                        in_start,
  input  wire                        in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [InWidth-1:0]  in_re,           // F fraction bits, as in_im
  input  wire  signed [InWidth-1:0]  in_im,
  output logic                       out_start,
  output logic                       out_frame_start,
  output logic signed [OutWidth-1:0] out_re,          // F + CoeffWidth - 1 - Drop fraction bits, as out_im
  output logic signed [OutWidth-1:0] out_im,
  output logic [1:0]                 saturations      // clip count, delayed
);

  localparam int SumWidth = InWidth + CoeffWidth + 1;
  localparam int ToSum = 6;  // cycles to the exact product: ROM and a register, dot product

  localparam int PositionWidth = $clog2(Size);
  localparam int BlockWidth = $clog2(Block);

  logic [PositionWidth-1:0] position;
  logic active;
  td_burst_counter #(.Words(Size)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );

  logic [3*CoeffWidth-1:0] factor;
  logic signed [CoeffWidth-1:0] w_re, w_im, w_minus_im;
  logic [BlockWidth-1:0] address;
  td_rom #(.Width(3 * CoeffWidth), .Depth(Block), .File(File)) u_rom (.clk, .en, .address, .data(factor));

  // A block memory takes long to give a word, a distributed one has the longer way to its words.
  if (3 * CoeffWidth * Block > td_memory_pkg::DistributedBits) begin : g_register_behind
    assign address = position[BlockWidth-1:0];
    always_ff @(posedge clk) if (en) {w_minus_im, w_im, w_re} <= factor;
  end else begin : g_register_in_front
    always_ff @(posedge clk) if (en) address <= position[BlockWidth-1:0];
    assign {w_minus_im, w_im, w_re} = factor;
  end

  logic [1:0][InWidth-1:0] re_q, im_q;
  logic [ToSum-1:0] start_q, frame_start_q, active_q;
  always_ff @(posedge clk) begin
    if (en) begin
      re_q <= {re_q[0], in_re};
      im_q <= {im_q[0], in_im};
      start_q <= {start_q[ToSum-2:0], in_start};
      frame_start_q <= {frame_start_q[ToSum-2:0], in_frame_start};
      active_q <= {active_q[ToSum-2:0], active};
    end
    if (rst) {start_q, frame_start_q, active_q} <= '0;
  end

  logic signed [OutWidth-1:0] rounded_re, rounded_im;
  logic [1:0] clipped, clipped_q;

  logic signed [SumWidth-1:0] sum_re;
  td_dot_product #(.AWidth(InWidth), .BWidth(CoeffWidth)) u_re (
    .clk, .en, .a0(re_q[1]), .b0(w_re), .a1(im_q[1]), .b1(w_minus_im), .sum(sum_re)
  );
  td_round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(OutWidth)) u_round_re (
    .in(sum_re), .out(rounded_re), .clipped(clipped[0])
  );

  if (RealOnly == 0) begin : g_im
    logic signed [SumWidth-1:0] sum_im;
    td_dot_product #(.AWidth(InWidth), .BWidth(CoeffWidth)) u_im (
      .clk, .en, .a0(re_q[1]), .b0(w_im), .a1(im_q[1]), .b1(w_re), .sum(sum_im)
    );
    td_round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(OutWidth)) u_round_im (
      .in(sum_im), .out(rounded_im), .clipped(clipped[1])
    );
  end else begin : g_real_only
    assign rounded_im = '0;
    assign clipped[1] = 1'b0;
  end

  always_ff @(posedge clk) begin
    if (en) begin
      out_start <= start_q[ToSum-1];
      out_frame_start <= frame_start_q[ToSum-1];
      out_re <= rounded_re;
      out_im <= rounded_im;
    end
    clipped_q <= clipped & {2{en & active_q[ToSum-1]}};
    if (rst) {out_start, out_frame_start, clipped_q} <= '0;
  end
  assign saturations = 2'(clipped_q[0]) + 2'(clipped_q[1]);

endmodule

`default_nettype wire
