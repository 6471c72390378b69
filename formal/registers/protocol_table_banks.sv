// SPDX-License-Identifier: Apache-2.0
// protocol_table_banks: no write in a reset, and none that is refused.

`default_nettype none

module protocol_table_banks (
  input  logic clk,
  input  logic rst,
  input  logic write,
  input  logic write_refused,
  output logic given_write,
  output logic holds,
  output logic counts
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign given_write = write & ~(rst | write_refused);
  assign holds = 1'b1;
  assign counts = live;

endmodule

`default_nettype wire
