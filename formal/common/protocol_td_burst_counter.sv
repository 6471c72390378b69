// SPDX-License-Identifier: Apache-2.0
// protocol_td_burst_counter: any inputs; the position counts while a burst is active.

`default_nettype none

module protocol_td_burst_counter (
  input  logic clk,
  input  logic rst,
  input  logic active,
  output logic counts_position,
  output logic counts_active
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign counts_active = live;
  assign counts_position = live & active;

endmodule

`default_nettype wire
