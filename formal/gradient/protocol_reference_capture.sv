// SPDX-License-Identifier: Apache-2.0
// protocol_reference_capture: whole frames in raster order, whatever the memory answers.

`default_nettype none

module protocol_reference_capture #(
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        en,
  input  logic        in_valid,
  input  logic [3:0]  in_position,
  input  logic        map_write,
  input  logic        map_read,
  output logic [15:0] row,
  output logic [15:0] column,
  output logic [3:0]  given_in_position,
  output logic        counts_map_write_node,
  output logic        counts_map_write_gains,
  output logic        counts_map_read_node,
  output logic        counts
);

  logic live = 1'b0;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst;
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.*, .reset(rst));
  assign given_in_position = in_valid & ~rst ? place : in_position;
  assign counts = live & ~rst;
  assign {counts_map_write_node, counts_map_write_gains} = {2{counts & map_write}};
  assign counts_map_read_node = counts & map_read;

endmodule

`default_nettype wire
