// SPDX-License-Identifier: Apache-2.0
// protocol_packet_check: a byte, or the end of a packet, or none; a byte counts while it is valid, out_good at an end.

`default_nettype none

module protocol_packet_check (
  input  logic clk,
  input  logic rst,
  input  logic in_valid,
  input  logic in_end,
  input  logic out_valid,
  input  logic out_end,
  output logic holds,
  output logic counts_out_data,
  output logic counts_out_good,
  output logic counts
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign holds = ~(in_valid & in_end);
  assign counts = live;
  assign counts_out_data = live & out_valid;
  assign counts_out_good = live & out_end;

endmodule

`default_nettype wire
