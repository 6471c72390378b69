// SPDX-License-Identifier: Apache-2.0
// protocol_flat_field: that of td_node_map, which is inside; here colours go out in place of gains.

`default_nettype none

module protocol_flat_field #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  localparam int NodeWidth = $clog2(td_types_pkg::nodes(Rows, Columns, BlockLog2))
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,
  input  td_types_pkg::table_command_t table_command,
  input  logic                 table_bank,
  input  logic                 table_in_use,
  input  logic                 capture_write,
  input  logic [NodeWidth-1:0] capture_write_node,
  input  logic                 capture_read,
  input  logic [NodeWidth-1:0] capture_read_node,
  input  logic                 in_valid,
  input  logic [3:0]           in_position,
  input  logic                 out_valid,
  output logic [3:0]           given_in_position,
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_position,
  output logic                 counts_out_red,
  output logic                 counts_out_green,
  output logic                 counts_out_blue,
  output logic                 counts_table_in_use,
  output logic                 counts_table_answer,
  output logic                 counts_capture_read_gains,
  output logic                 counts_dark,
  output logic                 counts_saturations
);

  logic live = 1'b0, pixel;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst | ~holds;
  protocol_td_node_map #(
    .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Channels(3),
    .Select(td_register_map_pkg::TableSelectReference)
  ) u_gains (
    .*, .in_frame_start(&in_position[1:0]), .given_in_frame_start(), .row(), .column(), .counts_out_data(pixel),
    .counts_out_words(), .counts_active(), .counts_capture_read_words(counts_capture_read_gains)
  );
  assign given_in_position = in_valid & ~rst ? place : in_position;
  assign {counts_out_position, counts_out_red, counts_out_green, counts_out_blue} = {4{pixel}};
  assign {counts_dark, counts_saturations} = {2{live & ~rst & holds}};

endmodule

`default_nettype wire
