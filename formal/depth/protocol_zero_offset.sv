// SPDX-License-Identifier: Apache-2.0
// protocol_zero_offset: that of td_node_map, which is inside, for whole frames of depths, Lanes of them in a beat.

`default_nettype none

module protocol_zero_offset #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Lanes     = 1,
  localparam int NodeWidth =
    $clog2(td_types_pkg::nodes(Rows, Columns, BlockLog2) / td_types_pkg::side(Lanes, BlockLog2))
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,
  input  td_types_pkg::table_command_t table_command,
  input  logic                 table_bank,
  input  logic                 table_in_use,
  input  logic                 capture_write,
  input  logic [NodeWidth-1:0] capture_write_node,
  input  logic                 in_valid,
  input  logic [2:0]           in_position,  // frame_start, row_end, frame_end
  input  logic                 out_valid,
  output logic [15:0]          row,
  output logic [15:0]          column,            // of the beat
  output logic [2:0]           given_in_position,
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_position,
  output logic                 counts_out_data,
  output logic                 counts_active,
  output logic                 counts_saturations,
  output logic                 counts_table_in_use,
  output logic                 counts_table_answer
);

  logic live = 1'b0;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst | ~holds;
  protocol_td_node_map #(
    .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Lanes(Lanes),
    .Select(td_register_map_pkg::TableSelectZero)
  ) u_zeros (
    .*, .capture_read(1'b0), .capture_read_node('0), .in_frame_start(in_position[2]), .given_in_frame_start(),
    .counts_out_words(), .counts_capture_read_words()
  );
  assign given_in_position = in_valid & ~rst ? {&place[1:0], place[3], &place[3:2]} : in_position;
  assign counts_out_position = counts_out_data;
  assign counts_saturations = live & ~rst & holds;

endmodule

`default_nettype wire
