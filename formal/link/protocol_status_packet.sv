// SPDX-License-Identifier: Apache-2.0
// protocol_status_packet: any inputs; a byte counts while it is valid.

`default_nettype none

module protocol_status_packet (
  input  logic clk,
  input  logic rst,
  input  logic status_valid,
  output logic counts_status_data,
  output logic counts_status_last,
  output logic counts
);

  logic live = 1'b0;
  assign counts = live & ~rst;
  assign {counts_status_data, counts_status_last} = {2{counts & status_valid}};
  always_ff @(posedge clk) live <= live | rst;

endmodule

`default_nettype wire
