// SPDX-License-Identifier: Apache-2.0
// protocol_frame_output: any inputs.

`default_nettype none

module protocol_frame_output (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic out_valid,
  output logic counts_out_data,
  output logic counts
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign counts = live & ~rst & en;
  assign counts_out_data = counts & out_valid;

endmodule

`default_nettype wire
