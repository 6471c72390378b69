// SPDX-License-Identifier: Apache-2.0
// protocol_centroid: row_sum and area are held from start to done; no sum is more than that of as many largest
// positions; means count with done.

`default_nettype none

module protocol_centroid #(
  parameter int PositionWidth = 7,
  parameter int AreaWidth     = 15,
  localparam int SumWidth = AreaWidth + PositionWidth - 1,
  localparam int LimitWidth = AreaWidth + PositionWidth
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 start,
  input  logic [SumWidth-1:0]  column_sum,
  input  logic [SumWidth-1:0]  row_sum,
  input  logic [AreaWidth-1:0] area,
  input  logic                 done,
  output logic                 holds,
  output logic                 counts_done,
  output logic                 counts
);

  logic reset, live = 1'b0, dividing = 1'b0;
  logic [SumWidth-1:0] held_sum;
  logic [AreaWidth-1:0] held_area;
  logic [LimitWidth-1:0] limit;
  assign limit = {area, PositionWidth'(0)} - LimitWidth'(area);
  assign reset = rst | ~holds;
  assign holds = rst | (start
      ? area != '0 & LimitWidth'(column_sum) <= limit & LimitWidth'(row_sum) <= limit
      : ~dividing | (row_sum == held_sum & area == held_area));
  assign counts_done = live & ~reset;
  assign counts = counts_done & done;
  always_ff @(posedge clk) begin
    live <= live | reset;
    dividing <= ~reset & (start | (dividing & ~done));
    if (start) begin
      held_sum <= row_sum;
      held_area <= area;
    end
  end

endmodule

`default_nettype wire
