// SPDX-License-Identifier: Apache-2.0
// protocol_cobs_decode: a byte, or a broken one, or none; a byte counts while it is valid, out_bad at an end.

`default_nettype none

module protocol_cobs_decode (
  input  logic clk,
  input  logic rst,
  input  logic in_valid,
  input  logic in_broken,
  input  logic out_valid,
  input  logic out_end,
  output logic holds,
  output logic counts_out_data,
  output logic counts_out_bad,
  output logic counts
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign holds = ~(in_valid & in_broken);
  assign counts = live;
  assign counts_out_data = live & out_valid;
  assign counts_out_bad = live & out_end;

endmodule

`default_nettype wire
