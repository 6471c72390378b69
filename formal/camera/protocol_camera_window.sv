// SPDX-License-Identifier: Apache-2.0
// protocol_camera_window: the source keeps to AXI4-Stream; any pictures, whole or broken, and any settings.

`default_nettype none

module protocol_camera_window (
  input  logic        clk,
  input  logic        rst,
  input  logic        en,
  input  logic        s_valid,
  input  logic        s_ready,
  input  logic [23:0] s_data,
  input  logic        s_last,
  input  logic        s_user,
  input  logic        out_valid,
  input  logic        out_inside,
  output logic        holds,
  output logic        counts_out_data,
  output logic        counts_out_inside,
  output logic        counts_out_odd_row,
  output logic        counts_out_odd_column,
  output logic        counts_out_row_start,
  output logic        counts_out_frame_start,
  output logic        counts  // the handshake, the faults, out_valid and out_abort
);

  logic reset, live = 1'b0, pixel;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) live <= live | reset;
  axis_source #(.Width(26)) u_source (
    .clk, .rst, .reset, .valid(s_valid), .ready(s_ready), .word({s_user, s_last, s_data}), .holds
  );
  assign counts = live & ~reset;
  assign pixel = counts & out_valid;
  assign {counts_out_data, counts_out_inside, counts_out_odd_row, counts_out_odd_column} = {4{pixel}};
  assign {counts_out_row_start, counts_out_frame_start} = {2{pixel & out_inside}};

endmodule

`default_nettype wire
