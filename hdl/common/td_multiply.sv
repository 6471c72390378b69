// SPDX-License-Identifier: Apache-2.0
// td_multiply: a b, exact and signed. Latency: 1 cycle.
//
// Replace this file to use a multiplier of the technology: every product of two variables in the design is one of
// these.
// The product register has no reset and one enable, as a DSP block asks; operands may come from a register, a memory or
// logic, and either may be the wider one.
// Bit-accurate model: models/tactile_depth/chip/common/td_multiply.py.

`default_nettype none

module td_multiply #(
  parameter int AWidth = 27,
  parameter int BWidth = 18
) (
  input  wire                             clk,
  input  wire                             en,
  input  wire  signed [AWidth-1:0]        a,       // signed code, F fraction bits
  input  wire  signed [BWidth-1:0]        b,       // signed code, G fraction bits
  output logic signed [AWidth+BWidth-1:0] product  // F + G fraction bits
);

  always_ff @(posedge clk) if (en) product <= a * b;

endmodule

`default_nettype wire
