// SPDX-License-Identifier: Apache-2.0
// protocol_node_map: whole frames of beats in raster order. Bus and capture use the tables one at a time, neither while
// a change of bank is due, except for what the bus reads.

`default_nettype none

module protocol_node_map #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Lanes     = 1,
  parameter int Channels  = 1,
  parameter int Select    = 0,
  localparam int Nodes = td_types_pkg::nodes(Rows, Columns, BlockLog2),
  localparam int Words = Nodes / td_types_pkg::side(Lanes, BlockLog2),
  localparam int NodeWidth = $clog2(Words)
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 reset,  // rst, or inputs that are not allowed
  input  logic                 live,   // there was a reset
  input  logic                 en,
  input  td_types_pkg::table_command_t table_command,
  input  logic                 table_bank,
  input  logic                 table_in_use,
  input  logic                 capture_write,
  input  logic [NodeWidth-1:0] capture_write_node,
  input  logic                 capture_read,
  input  logic [NodeWidth-1:0] capture_read_node,
  input  logic                 in_valid,
  input  logic                 in_frame_start,
  input  logic                 out_valid,
  output logic                 given_in_frame_start,
  output logic [15:0]          row,
  output logic [15:0]          column,
  output logic [3:0]           place,
  output logic                 captured,  // the capture read in the clock before
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_data,
  output logic                 counts_out_words,
  output logic                 counts_active,
  output logic                 counts_table_in_use,
  output logic                 counts_table_answer,
  output logic                 counts_capture_read_words
);

  localparam logic [NodeWidth:0] End = Words;
  logic named = 1'b0, was_captured = 1'b0, settled, write, read, idle, legal, known;
  always_ff @(posedge clk) begin
    was_captured <= capture_read & holds;
    if (reset || (en && in_valid && &place[1:0])) named <= table_bank;
  end
  raster_places #(.Rows(Rows), .Columns(Columns / Lanes)) u_places (.*);
  table_accesses #(.Select(Select), .Entries(Nodes << $clog2(Channels))) u_accesses (.*, .index());
  assign given_in_frame_start = in_valid & ~rst ? &place[1:0] : in_frame_start;
  assign settled = table_bank == table_in_use & named == table_in_use;
  assign holds = legal
      & (rst | ~write | (settled & idle)) & (rst | ~read | idle)
      & (~(capture_write | capture_read) | (~rst & settled & ~write & ~read & idle))
      & (~capture_write | ~capture_read | capture_write_node != capture_read_node)
      & {1'b0, capture_write_node} < End & {1'b0, capture_read_node} < End;
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_data, counts_out_words} = {2{counts_out_valid & out_valid}};
  assign counts_active = live & ~reset;
  assign counts_table_in_use = live;
  assign counts_table_answer = live & known;
  assign captured = was_captured;
  assign counts_capture_read_words = captured;

endmodule

`default_nettype wire
