// SPDX-License-Identifier: Apache-2.0
// protocol_td_gain_map: whole frames in raster order. Bus and capture use the tables one at a time, neither while a change
// of bank is due, except for what the bus reads.

`default_nettype none

module protocol_td_gain_map #(
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
  input  logic [NodeWidth+1:0] table_index,
  input  logic                 capture_write,
  input  logic [NodeWidth-1:0] capture_write_node,
  input  logic                 capture_read,
  input  logic [NodeWidth-1:0] capture_read_node,
  input  logic                 in_valid,
  input  logic                 in_frame_start,
  input  logic                 out_valid,
  output logic                 given_in_frame_start,
  output logic                 holds,
  output logic                 counts_out_valid,
  output logic                 counts_out_data,
  output logic                 counts_out_gains,
  output logic                 counts_active,
  output logic                 counts_table_in_use,
  output logic                 counts_table_read_gain,
  output logic                 counts_capture_read_gains
);

  localparam logic [NodeWidth:0] End = Nodes;
  logic reset, live = 1'b0, captured = 1'b0, named = 1'b0, bus_idle, read_stands;
  logic [3:0] place;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) begin
    live <= live | reset;
    captured <= capture_read & holds;
    if (reset || (en && in_valid && &place[1:0])) named <= table_bank;
  end
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.clk, .reset, .en, .in_valid, .place);
  table_reads u_reads (.clk, .reset, .table_read, .idle(bus_idle), .stands(read_stands));
  assign given_in_frame_start = in_valid & ~rst ? &place[1:0] : in_frame_start;
  assign holds = (~(table_write | capture_write | capture_read)
          | (table_bank == table_in_use & named == table_in_use & ~rst & ~table_read & bus_idle))
      & (~table_read | (~rst & bus_idle))
      & (~table_write | (~capture_write & ~capture_read))
      & (~capture_write | ~capture_read | capture_write_node != capture_read_node)
      & {1'b0, table_index[NodeWidth+1:2]} < End
      & {1'b0, capture_write_node} < End & {1'b0, capture_read_node} < End;
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_data, counts_out_gains} = {2{counts_out_valid & out_valid}};
  assign counts_active = live & ~reset;
  assign counts_table_in_use = live;
  assign counts_table_read_gain = live & read_stands;
  assign counts_capture_read_gains = captured;

endmodule

`default_nettype wire
