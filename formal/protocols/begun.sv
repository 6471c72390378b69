// SPDX-License-Identifier: Apache-2.0
// begun: since the last reset something has begun, before this clock.

`default_nettype none

module begun (
  input  logic clk,
  input  logic reset,
  input  logic begins,
  output logic begun
);

  logic known = 1'b0;
  assign begun = known;
  always_ff @(posedge clk) known <= ~reset & (known | begins);

endmodule

`default_nettype wire
