// SPDX-License-Identifier: Apache-2.0
// protocol_block_weights: any inputs; the outputs count from the first pixel of an axis on.

`default_nettype none

module protocol_block_weights (
  input  logic clk,
  input  logic en,
  input  logic step,
  input  logic restart,
  output logic counts
);

  logic known = 1'b0;
  always_ff @(posedge clk) known <= known | (en & step & restart);
  assign counts = known | restart;

endmodule

`default_nettype wire
