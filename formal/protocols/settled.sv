// SPDX-License-Identifier: Apache-2.0
// settled: high once so many clocks with en have passed.

`default_nettype none

module settled #(
  parameter int Clocks = 1
) (
  input  logic clk,
  input  logic en,
  input  logic holds,  // of the protocol: in a clock without, the core sees none
  output logic settled
);

  logic [7:0] passed = '0;
  assign settled = passed == 8'(Clocks);
  always_ff @(posedge clk) if (en && holds && !settled) passed <= passed + 8'd1;

endmodule

`default_nettype wire
