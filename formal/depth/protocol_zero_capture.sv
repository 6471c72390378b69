// SPDX-License-Identifier: Apache-2.0
// protocol_zero_capture: whole frames of depths.

`default_nettype none

module protocol_zero_capture #(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  parameter int Lanes   = 1
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        en,
  input  logic        in_valid,
  input  logic        in_frame_start,
  input  logic        in_frame_end,
  input  logic        map_write,
  output logic [15:0] row,
  output logic [15:0] column,
  output logic        given_in_frame_start,
  output logic        given_in_frame_end,
  output logic        counts_busy,
  output logic        counts_done,
  output logic        counts_map_write,
  output logic        counts_map_write_node,
  output logic        counts_map_write_zero
);

  logic live = 1'b0;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst;
  raster_places #(.Rows(Rows), .Columns(Columns / Lanes)) u_places (.*, .reset(rst));
  assign given_in_frame_start = in_valid & ~rst ? &place[1:0] : in_frame_start;
  assign given_in_frame_end = in_valid & ~rst ? &place[3:2] : in_frame_end;
  assign {counts_busy, counts_done} = {2{live & ~rst}};
  assign counts_map_write = live;
  assign {counts_map_write_node, counts_map_write_zero} = {2{live & map_write}};

endmodule

`default_nettype wire
