// SPDX-License-Identifier: Apache-2.0
// spectral_divide: divides each mode by its eigenvalue of the five-point Laplacian.
//
//   out = sat( round( in M 2^S / 2^Drop ) ),  M 2^S / 2^Drop = c / (lambda_k + lambda_l) from a ROM
//   c takes back the gain of all transforms and turns pixels into full scales of the depth code
//
// Stream in: bursts of Columns modes, Columns of them a frame, both directions in bit-reversed order. Stream out: the
// same. Starts of both come 2 cycles before the first mode. Latency: 4 cycles; en low: nothing moves.
// The table is symmetric: the ROM holds the lower triangle, p (p + 1) / 2 + t for t <= p, and its address is kept by
// adding. Mantissa M has CoeffWidth bits at every size of the reciprocal.
// Bit-accurate model: models/tactile_depth/chip/poisson/spectral_divide.py, which also writes the ROM.

`default_nettype none

module spectral_divide #(
  parameter int Width      = 27,
  parameter int CoeffWidth = 18,
  parameter int Columns    = 128,  // a power of two
  parameter int ShiftWidth = 4,
  parameter int Drop       = 23,
  parameter int Parity     = 0,  // 1: a parity bit in each word of a memory
  parameter     File       = "reciprocal.hex"  // Columns (Columns + 1) / 2 words {S, M}
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,
  input  wire                     in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [Width-1:0] in_data,         // mode of the divergence
  output logic                    out_start,
  output logic                    out_frame_start,
  output logic signed [Width-1:0] out_data,        // mode of depth, in the format for which c was computed
  output logic                    saturations,     // clip count, delayed
  output logic                    flipped          // a word that was read has a flipped bit
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int Words = Columns * (Columns + 1) / 2;
  localparam int AddressWidth = $clog2(Words);
  localparam int TriangleWidth = AddressWidth - 1;  // Columns (Columns - 1) / 2 is the largest
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int ShiftedWidth = ProductWidth + (1 << ShiftWidth) - 1;
  localparam int ToShifted = 5;  // cycles from a start to the shifted product: address, ROM, operands, product, shift
  localparam int ToStart = ToShifted - 2;

  // p: burst in the frame, t: word in the burst; tri_p = p (p + 1) / 2, tri_t likewise.
  logic [PositionWidth-1:0] p_q, p, t;
  logic [TriangleWidth-1:0] tri_p_q, tri_p, tri_t_q, tri_t;
  logic [AddressWidth-1:0] address;
  logic active;
  td_burst_counter #(.Words(Columns)) u_counter (
    .clk, .rst, .en, .start(in_start), .position(t), .active
  );
  assign tri_t = in_start ? '0 : tri_t_q;
  assign p = in_frame_start ? '0 : p_q;
  assign tri_p = in_frame_start ? '0 : tri_p_q;

  logic burst_ends;
  assign burst_ends = active & (t == PositionWidth'(Columns - 1));

  always_ff @(posedge clk) begin
    if (en) begin
      address <= (t <= p) ? AddressWidth'(tri_p) + AddressWidth'(t) : AddressWidth'(tri_t) + AddressWidth'(p);
      tri_t_q <= tri_t + TriangleWidth'(t) + TriangleWidth'(1);
      p_q <= burst_ends ? p + PositionWidth'(1) : p;
      tri_p_q <= burst_ends ? tri_p + TriangleWidth'(p) + TriangleWidth'(1) : tri_p;
    end
  end

  logic [ShiftWidth-1:0] shift, shift_q;
  logic signed [CoeffWidth-1:0] mantissa;
  td_parity_rom #(
    .Width(ShiftWidth + CoeffWidth), .Depth(Words), .File(File), .Latency(2), .Parity(Parity)
  ) u_rom (
    .clk, .en, .address, .data({shift, mantissa}), .flipped
  );

  logic signed [Width-1:0] data_q;
  logic signed [ProductWidth-1:0] product;
  logic signed [ShiftedWidth-1:0] shifted;
  logic [ToStart-1:0] start_q, frame_start_q;
  logic [ToShifted-1:0] active_q;
  logic signed [Width-1:0] rounded;
  logic clipped;
  td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
    .clk, .en, .a(data_q), .b(mantissa), .product
  );
  td_round_saturate #(.InWidth(ShiftedWidth), .Drop(Drop), .OutWidth(Width)) u_round (
    .in(shifted), .out(rounded), .clipped
  );

  always_ff @(posedge clk) begin
    if (en) begin
      data_q <= in_data;
      shift_q <= shift;
      shifted <= ShiftedWidth'(product) <<< shift_q;
      out_data <= rounded;
      start_q <= {start_q[ToStart-2:0], in_start};
      frame_start_q <= {frame_start_q[ToStart-2:0], in_frame_start};
      active_q <= {active_q[ToShifted-2:0], active};
      out_start <= start_q[ToStart-1];
      out_frame_start <= frame_start_q[ToStart-1];
    end
    saturations <= en & active_q[ToShifted-1] & clipped;
    if (rst) {start_q, frame_start_q, active_q, out_start, out_frame_start, saturations} <= '0;
  end

endmodule

`default_nettype wire
