// SPDX-License-Identifier: Apache-2.0
// protocol_frame_guard: any source; any frames, whole or broken.

`default_nettype none

module protocol_frame_guard (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic out_valid,
  input  logic out_frame_end,
  output logic counts_out_valid,
  output logic counts_out_frame_start,
  output logic counts_out_frame_end,
  output logic counts_out_data,
  output logic counts_out_position,
  output logic counts_out_bad,
  output logic counts  // the handshake and the faults
);

  logic live = 1'b0, pixel;
  always_ff @(posedge clk) live <= live | rst;
  assign counts = live & ~rst;
  assign {counts_out_valid, counts_out_frame_start, counts_out_frame_end} = {3{counts & en}};
  assign pixel = counts & en & out_valid;
  assign {counts_out_data, counts_out_position} = {2{pixel}};
  assign counts_out_bad = pixel & out_frame_end;

endmodule

`default_nettype wire
