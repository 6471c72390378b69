// SPDX-License-Identifier: Apache-2.0
// protocol_uart_receive: anything on the line; a byte counts while it is there.

`default_nettype none

module protocol_uart_receive (
  input  logic clk,
  input  logic rst,
  input  logic out_valid,
  output logic counts_out_data,
  output logic counts
);

  logic live = 1'b0;
  assign counts = live & ~rst;
  assign counts_out_data = counts & out_valid;
  always_ff @(posedge clk) live <= live | rst;

endmodule

`default_nettype wire
