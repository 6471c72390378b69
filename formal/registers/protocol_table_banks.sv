// SPDX-License-Identifier: Apache-2.0
// protocol_table_banks: no write in a reset.

`default_nettype none

module protocol_table_banks (
  input  logic clk,
  input  logic rst,
  input  logic write,
  output logic given_write,
  output logic holds,
  output logic counts
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign given_write = write & ~rst;
  assign holds = 1'b1;
  assign counts = live;

endmodule

`default_nettype wire
