// SPDX-License-Identifier: Apache-2.0
// round_divide: a weighted mean in 8 bits, one every cycle.
//
//   mean = total / (weight 2^Drop), rounded half to even, clipped to 0..255
//
// Restoring division of total / 2^Drop in a pipeline, one bit of the quotient a stage. The bits below 2^Drop decide in
// the rounding alone: their highest adds half to the remainder, the others tell whether anything is above a tie.
// `weight` is not 0. Latency: 10 cycles with en; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/camera/round_divide.py.

`default_nettype none

module round_divide #(
  parameter int TotalWidth  = 36,  // at least Drop + 10
  parameter int WeightWidth = 8,
  parameter int Drop        = 14
) (
  input  wire                          clk,
  input  wire                          en,
  input  wire signed [TotalWidth-1:0]  total,
  input  wire        [WeightWidth-1:0] weight,
  output logic       [7:0]             mean
);

  localparam int Bits = 8;  // of a quotient
  localparam int UpperWidth = TotalWidth - 1 - Drop - Bits;

  logic negative, too_large;
  logic [UpperWidth-1:0] upper;
  assign negative = total[TotalWidth-1];
  assign upper = total[TotalWidth-2:Drop+Bits];
  assign too_large = (WeightWidth + UpperWidth)'(upper) >= (WeightWidth + UpperWidth)'(weight);

  // Stage k holds a remainder below the weight, the lower bits of the total that are not divided yet, and above them
  // the bits of the quotient, which enter from below as those leave.
  logic [Bits:0][WeightWidth-1:0] remainders, weights;
  logic [Bits:0][Bits-1:0] quotients;
  logic [Bits:0] clipped, half, more;
  always_ff @(posedge clk) begin
    if (en) begin
      remainders[0] <= negative ? '0 : WeightWidth'(upper);
      quotients[0] <= negative ? '0 : total[Drop+:Bits];
      weights[0] <= weight;
      clipped <= {clipped[Bits-1:0], too_large & ~negative};
      half <= {half[Bits-1:0], total[Drop-1] & ~negative};
      more <= {more[Bits-1:0], |total[Drop-2:0] & ~negative};
    end
  end

  for (genvar k = 0; k < Bits; k++) begin : g_bit
    logic [WeightWidth:0] shifted, difference;
    assign shifted = {remainders[k], quotients[k][Bits-1]};
    assign difference = shifted - {1'b0, weights[k]};
    always_ff @(posedge clk) begin
      if (en) begin
        remainders[k+1] <= WeightWidth'(difference[WeightWidth] ? shifted : difference);
        quotients[k+1] <= {quotients[k][Bits-2:0], ~difference[WeightWidth]};
        weights[k+1] <= weights[k];
      end
    end
  end

  // Rounded up where the weight less twice the remainder is negative, a tie counting as more where it is to go up.
  logic [WeightWidth:0] twice;
  logic tie_up, up;
  logic [WeightWidth+1:0] unused_rest;
  assign twice = {remainders[Bits], half[Bits]};
  assign tie_up = more[Bits] | quotients[Bits][0];
  assign {up, unused_rest} = {2'b00, weights[Bits], 1'b1} + {1'b1, ~twice, ~tie_up};
  always_ff @(posedge clk) begin
    if (en) mean <= clipped[Bits] | quotients[Bits] == '1 ? '1 : quotients[Bits] + Bits'(up);
  end

endmodule

`default_nettype wire
