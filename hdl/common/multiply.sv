// SPDX-License-Identifier: Apache-2.0
// multiply: a b, exact and signed. Latency: 1 cycle.
//
// The one place to put a multiplier of the technology: every product of the design is one of these, its operands and
// what becomes of it stand in registers without reset, under the same enable.
// Bit-accurate model: models/tactile_depth/common/multiply.py.

module multiply #(
  parameter int AWidth = 27,
  parameter int BWidth = 18
) (
  input  logic                            clk,
  input  logic                            en,
  input  logic signed [AWidth-1:0]        a,
  input  logic signed [BWidth-1:0]        b,
  output logic signed [AWidth+BWidth-1:0] product
);

  always_ff @(posedge clk) if (en) product <= a * b;

endmodule
