// SPDX-License-Identifier: Apache-2.0
// centroid: mean column and mean row of weighted pixels, by one sequential divider.
//
//   mean = 16 moment / weight, rounded to the nearest, ties to even: in units of 1/16 pixel
//
// `start` begins with the column and abandons what is under way; it may come with `done`. column_moment counts in that
// cycle; row_moment and weight are held from `start` to `done`. A moment is the sum of each weight times its position.
// No position has more than PositionWidth bits, so a moment is less than weight 2^PositionWidth; a weight of 0 gives no
// meaning to the result.
// Latency: 2 PositionWidth + 12 cycles from `start` to `done`; column and row are valid in that cycle alone.
// Bit-accurate model: models/tactile_depth/chip/contact/centroid.py.

`default_nettype none

module centroid #(
  parameter int PositionWidth = 7,
  parameter int WeightWidth   = 38,
  localparam int MomentWidth = WeightWidth + PositionWidth,
  localparam int MeanWidth = PositionWidth + 4
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    start,
  input  wire  [MomentWidth-1:0] column_moment,
  input  wire  [MomentWidth-1:0] row_moment,
  input  wire  [WeightWidth-1:0] weight,
  output logic                   done,
  output logic [MeanWidth-1:0]   column,         // 4 fraction bits, pixels
  output logic [MeanWidth-1:0]   row             // 4 fraction bits, pixels
);

  localparam int QuotientWidth = MeanWidth + 1;  // one bit to round by

  logic of_row, divided;
  logic [MomentWidth-1:0] moment;
  logic [QuotientWidth-1:0] quotient;
  logic [WeightWidth-1:0] remainder;
  assign moment = start ? column_moment : row_moment;
  td_divide #(.DivisorWidth(WeightWidth), .QuotientWidth(QuotientWidth)) u_divide (
    .clk, .rst, .start(start | (divided & ~of_row)), .numerator({moment, 5'd0}), .divisor(weight),
    .done(divided), .quotient, .remainder, .overflow()
  );

  logic signed [QuotientWidth:0] rounded;
  logic [1:0] unused_rounded;  // no mean of positions is larger than the largest
  td_round_saturate #(.InWidth(QuotientWidth + 2), .Drop(2), .OutWidth(QuotientWidth + 1)) u_round (
    .in($signed({1'b0, quotient, remainder != '0})), .out(rounded), .clipped()
  );
  assign {unused_rounded, row} = rounded;
  assign done = divided & of_row;

  always_ff @(posedge clk) begin
    if (divided) column <= row;
    if (start || divided) of_row <= ~start;
  end

endmodule

`default_nettype wire
