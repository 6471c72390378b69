// SPDX-License-Identifier: Apache-2.0
// td_divide: quotient and remainder of unsigned integers by restoring division, one quotient bit a cycle.
//
//   numerator = quotient divisor + remainder,  remainder < divisor
//
// `start` takes the numerator and abandons a division under way. The divisor is held from `start` to `done`. Quotient,
// remainder and overflow are valid in the cycle of `done` alone; the next `start` may come in that cycle. `overflow`:
// the quotient has more than QuotientWidth bits, or the divisor is 0, so quotient and remainder mean nothing.
// Latency: QuotientWidth + 1 cycles from start to done. Bit-accurate model:
// models/tactile_depth/chip/common/td_divide.py.

`default_nettype none

module td_divide #(
  parameter int DivisorWidth  = 24,
  parameter int QuotientWidth = 25,
  localparam int NumeratorWidth = DivisorWidth + QuotientWidth
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      start,
  input  wire [NumeratorWidth-1:0] numerator,
  input  wire [DivisorWidth-1:0]   divisor,
  output logic                     done,
  output logic [QuotientWidth-1:0] quotient,
  output logic [DivisorWidth-1:0]  remainder,
  output logic                     overflow
);

  localparam int CountWidth = $clog2(QuotientWidth + 1);

  // The lower part of the numerator leaves `quotient` at the top while quotient bits enter at the bottom.
  logic dividing, fits;
  logic [CountWidth-1:0] bits_to_come;
  logic [DivisorWidth-1:0] upper;
  logic [DivisorWidth:0] shifted, difference;
  assign upper = numerator[NumeratorWidth-1:QuotientWidth];
  assign shifted = {remainder, quotient[QuotientWidth-1]};
  assign difference = shifted - {1'b0, divisor};
  assign fits = ~difference[DivisorWidth];
  assign done = dividing & bits_to_come == '0;

  always_ff @(posedge clk) begin
    if (start) begin
      {remainder, quotient} <= numerator;
      overflow <= upper >= divisor;
      bits_to_come <= CountWidth'(QuotientWidth);
    end else begin
      remainder <= fits ? difference[DivisorWidth-1:0] : shifted[DivisorWidth-1:0];
      quotient <= {quotient[QuotientWidth-2:0], fits};
      bits_to_come <= bits_to_come - CountWidth'(1);
    end
    dividing <= start | (dividing & ~done);
    if (rst) dividing <= 1'b0;
  end

  if (DivisorWidth < 1 || QuotientWidth < 2) begin : g_refused
    DivisorWidth_must_be_at_least_1_and_QuotientWidth_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
