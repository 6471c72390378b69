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
  input  logic                 in_user,
  input  logic                 in_last,
  input  logic                 in_frame_end,
  input  logic                 out_valid,
  output logic                 given_in_user,
  output logic                 given_in_last,
  output logic                 given_in_frame_end,
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_user,
  output logic                 counts_out_last,
  output logic                 counts_out_frame_end,
  output logic                 counts_out_data,
  output logic                 counts_active,
  output logic                 counts_saturation,
  output logic                 counts_table_in_use,
  output logic                 counts_table_read_floor
);

  localparam logic [NodeWidth:0] End = Nodes;
  logic reset, live = 1'b0, bus_idle, read_stands;
  logic [3:0] place;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) live <= live | reset;
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.clk, .reset, .en, .in_valid, .place);
  table_reads u_reads (.clk, .reset, .table_read, .idle(bus_idle), .stands(read_stands));
  assign given_in_user = in_valid & ~rst ? &place[1:0] : in_user;
  assign given_in_last = in_valid & ~rst ? place[3] : in_last;
  assign given_in_frame_end = in_valid & ~rst ? &place[3:2] : in_frame_end;
  assign holds = (~(table_write | capture_write) | (table_bank == table_in_use & ~rst & ~table_read & bus_idle))
      & (~table_read | (~rst & bus_idle)) & (~table_write | ~capture_write)
      & {1'b0, table_index} < End & {1'b0, capture_write_node} < End;
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_user, counts_out_last, counts_out_frame_end, counts_out_data} = {4{counts_out_valid & out_valid}};
  assign {counts_active, counts_saturation} = {2{live & ~reset}};
  assign counts_table_in_use = live;
  assign counts_table_read_floor = live & read_stands;

endmodule
