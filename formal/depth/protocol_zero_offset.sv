// SPDX-License-Identifier: Apache-2.0
// protocol_zero_offset: whole frames of depths, Lanes of them in a beat. Bus and capture use the tables one at a time, neither while a change of
// bank is due, except for what the bus reads.

`default_nettype none

module protocol_zero_offset #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Lanes     = 1,
  localparam int Side = Lanes >> BlockLog2 > 1 ? Lanes >> BlockLog2 : 1,
  localparam int Nodes = (Rows >> BlockLog2) * (Columns >> BlockLog2),
  localparam int NodeWidth = $clog2(Nodes)
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,
  input  logic                 table_bank,
  input  logic                 table_in_use,
  input  logic                 table_write,
  input  logic                 table_read,
  input  logic [NodeWidth-1:0] table_index,
  input  logic                 capture_write,
  input  logic [NodeWidth-$clog2(Side)-1:0] capture_write_node,
  input  logic                 in_valid,
  input  logic [2:0]           in_position,  // frame_start, row_end, frame_end
  input  logic                 out_valid,
  output logic [2:0]           given_in_position,
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_position,
  output logic                 counts_out_data,
  output logic                 counts_active,
  output logic                 counts_saturations,
  output logic                 counts_table_in_use,
  output logic                 counts_table_read_zero
);

  logic live = 1'b0;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst | ~holds;
  raster_places #(.Rows(Rows), .Columns(Columns / Lanes)) u_places (
    .clk, .reset(rst | ~holds), .en, .in_valid, .place
  );
  // The same for either map, but for the width of a captured node.
  protocol_td_node_map #(.Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Lanes(Lanes)) u_zeros (
    .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index,
    .capture_write, .capture_write_node, .in_valid, .in_frame_start(in_position[2]), .out_valid,
    .given_in_frame_start(), .holds, .counts_out_valid, .counts_out_data, .counts_out_zeros(), .counts_active,
    .counts_table_in_use, .counts_table_read_zero
  );
  assign given_in_position = in_valid & ~rst ? {&place[1:0], place[3], &place[3:2]} : in_position;
  assign counts_out_position = counts_out_data;
  assign counts_saturations = live & ~rst & holds;

endmodule

`default_nettype wire
