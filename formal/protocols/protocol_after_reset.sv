// SPDX-License-Identifier: Apache-2.0
// protocol_after_reset: anything on the inputs; outputs count once there was a reset.

`default_nettype none

module protocol_after_reset (
  input  logic clk,
  input  logic rst,
  output logic holds,
  output logic counts
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign holds = 1'b1;
  assign counts = live;

endmodule

`default_nettype wire
