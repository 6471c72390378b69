// SPDX-License-Identifier: Apache-2.0
// centroid: mean column and mean row of an area, by one sequential divider.
//
//   mean = 16 sum / area, rounded to the nearest, ties to even: in units of 1/16 pixel
//
// `start` begins with the column and abandons what is under way; it may come with `done`. column_sum counts in that
// cycle; row_sum and area are held from `start` to `done`. No position has more than PositionWidth bits, so a sum is
// less than area 2^PositionWidth; an area of 0 gives no meaning to the result.
// Latency: 2 PositionWidth + 12 cycles from `start` to `done`; column and row are valid in that cycle alone.
// Bit-accurate model: models/tactile_depth/contact/centroid.py.

`default_nettype none

module centroid #(
  parameter int PositionWidth = 7,
  parameter int AreaWidth     = 15,
  localparam int SumWidth = AreaWidth + PositionWidth - 1,
  localparam int MeanWidth = PositionWidth + 4
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  start,
  input  wire  [SumWidth-1:0]  column_sum,  // pixels
  input  wire  [SumWidth-1:0]  row_sum,     // pixels
  input  wire  [AreaWidth-1:0] area,        // pixels
  output logic                 done,
  output logic [MeanWidth-1:0] column,      // 4 fraction bits, pixels
  output logic [MeanWidth-1:0] row          // 4 fraction bits, pixels
);

  localparam int QuotientWidth = MeanWidth + 1;  // one bit to round by

  logic of_row, divided;
  logic [SumWidth-1:0] sum;
  logic [QuotientWidth-1:0] quotient;
  logic [AreaWidth-1:0] remainder;
  logic unused_overflow;
  assign sum = start ? column_sum : row_sum;
  td_divide #(.DivisorWidth(AreaWidth), .QuotientWidth(QuotientWidth)) u_divide (
    .clk, .rst, .start(start | (divided & ~of_row)), .numerator({1'b0, sum, 5'd0}), .divisor(area),
    .done(divided), .quotient, .remainder, .overflow(unused_overflow)
  );

  logic signed [QuotientWidth:0] rounded;
  logic unused_clipped;
  logic [1:0] unused_rounded;  // no mean of positions is larger than the largest
  td_round_saturate #(.InWidth(QuotientWidth + 2), .Drop(2), .OutWidth(QuotientWidth + 1)) u_round (
    .in($signed({1'b0, quotient, remainder != '0})), .out(rounded), .clipped(unused_clipped)
  );
  assign {unused_rounded, row} = rounded;
  assign done = divided & of_row;

  always_ff @(posedge clk) begin
    if (divided) column <= row;
    if (start || divided) of_row <= ~start;
  end

endmodule

`default_nettype wire
