// SPDX-License-Identifier: Apache-2.0
// round_divide: a weighted mean in 8 bits, one every clock.
//
//   mean = total / (weight 2^Drop), rounded half to even, clipped to 0..255
//
// Restoring division in a pipeline, one bit of the quotient a stage. `weight` is not 0.
// Latency: 10 cycles with en; en low: nothing moves. Bit-accurate model: models/tactile_depth/camera/round_divide.py.

`default_nettype none

module round_divide #(
  parameter int TotalWidth  = 20,
  parameter int WeightWidth = 8,
  parameter int Drop        = 2
) (
  input  wire                          clk,
  input  wire                          en,
  input  wire signed [TotalWidth-1:0]  total,
  input  wire        [WeightWidth-1:0] weight,
  output logic       [7:0]             mean
);

  localparam int Bits = 8;  // of a quotient
  localparam int DivisorWidth = WeightWidth + Drop;
  localparam int UpperWidth = TotalWidth - 1 - Bits;

  logic negative, too_large;
  logic [DivisorWidth-1:0] divisor;
  logic [UpperWidth-1:0] upper;
  assign negative = total[TotalWidth-1];
  assign divisor = DivisorWidth'(weight) << Drop;
  assign upper = total[TotalWidth-2:Bits];
  assign too_large = (DivisorWidth + UpperWidth)'(upper) >= (DivisorWidth + UpperWidth)'(divisor);

  // Stage k holds a remainder below the divisor, the lower bits of the total that are not divided yet, and above them
  // the bits of the quotient, which enter from below as those leave.
  logic [Bits:0][DivisorWidth-1:0] remainders, divisors;
  logic [Bits:0][Bits-1:0] quotients;
  logic [Bits:0] clipped;
  always_ff @(posedge clk) begin
    if (en) begin
      remainders[0] <= negative ? '0 : DivisorWidth'(upper);
      quotients[0] <= negative ? '0 : total[Bits-1:0];
      divisors[0] <= divisor;
      clipped[0] <= too_large & ~negative;
    end
  end

  for (genvar k = 0; k < Bits; k++) begin : g_bit
    logic [DivisorWidth:0] shifted, difference;
    logic unused_top;
    assign shifted = {remainders[k], quotients[k][Bits-1]};
    assign difference = shifted - {1'b0, divisors[k]};
    assign unused_top = shifted[DivisorWidth];
    always_ff @(posedge clk) begin
      if (en) begin
        remainders[k+1] <= difference[DivisorWidth] ? shifted[DivisorWidth-1:0] : difference[DivisorWidth-1:0];
        quotients[k+1] <= {quotients[k][Bits-2:0], ~difference[DivisorWidth]};
        divisors[k+1] <= divisors[k];
        clipped[k+1] <= clipped[k];
      end
    end
  end

  logic [DivisorWidth:0] twice, whole;
  logic up;
  assign twice = {remainders[Bits], 1'b0};
  assign whole = {1'b0, divisors[Bits]};
  assign up = twice > whole | (twice == whole & quotients[Bits][0]);
  always_ff @(posedge clk) begin
    if (en) mean <= clipped[Bits] | quotients[Bits] == '1 ? '1 : quotients[Bits] + Bits'(up);
  end

  if (UpperWidth < 1 || WeightWidth < 1 || Drop < 0) begin : g_refused
    TotalWidth_must_be_at_least_10_WeightWidth_at_least_1_and_Drop_at_least_0 u_refused ();
  end

endmodule

`default_nettype wire
