// SPDX-License-Identifier: Apache-2.0
// protocol_auto_zero: whole frames of depths. Bus and capture use the tables one at a time, neither while a change of
// bank is due, except for what the bus reads.

module protocol_auto_zero #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
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
  input  logic [NodeWidth-1:0] capture_write_node,
  input  logic                 in_valid,
  input  logic [2:0]           in_position,  // frame_start, row_end, frame_end
  input  logic                 out_valid,
  output logic [2:0]           given_in_position,
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_position,
  output logic                 counts_out_data,
  output logic                 counts_active,
  output logic                 counts_saturation,
  output logic                 counts_table_in_use,
  output logic                 counts_table_read_floor
);

  logic live = 1'b0;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst | ~holds;
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (
    .clk, .reset(rst | ~holds), .en, .in_valid, .place
  );
  protocol_gain_map #(.Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2)) u_floors (
    .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index({table_index, 2'd0}),
    .capture_write, .capture_write_node, .capture_read(1'b0), .capture_read_node('0), .in_valid,
    .in_frame_start(in_position[2]), .out_valid, .given_in_frame_start(), .holds, .counts_out_valid,
    .counts_out_data(counts_out_data), .counts_out_gains(), .counts_active, .counts_table_in_use,
    .counts_table_read_gain(counts_table_read_floor), .counts_capture_read_gains()
  );
  assign given_in_position = in_valid & ~rst ? {&place[1:0], place[3], &place[3:2]} : in_position;
  assign counts_out_position = counts_out_data;
  assign counts_saturation = live & ~rst & holds;

endmodule
