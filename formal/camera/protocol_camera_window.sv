// SPDX-License-Identifier: Apache-2.0
// protocol_camera_window: any source; any pictures, whole or broken, and any settings.

`default_nettype none

module protocol_camera_window (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic out_valid,
  input  logic out_inside,
  output logic counts_out_data,
  output logic counts_out_inside,
  output logic counts_out_odd_row,
  output logic counts_out_odd_column,
  output logic counts_out_row_start,
  output logic counts_out_frame_start,
  output logic counts  // the handshake, the faults, out_valid and out_abort
);

  logic live = 1'b0, pixel;
  always_ff @(posedge clk) live <= live | rst;
  assign counts = live & ~rst;
  assign pixel = counts & out_valid;
  assign {counts_out_data, counts_out_inside, counts_out_odd_row, counts_out_odd_column} = {4{pixel}};
  assign {counts_out_row_start, counts_out_frame_start} = {2{pixel & out_inside}};

endmodule

`default_nettype wire
