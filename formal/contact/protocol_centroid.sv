// SPDX-License-Identifier: Apache-2.0
// protocol_centroid: row_moment and weight are held from start to done; no moment is more than the weight times the
// largest position; means count with done.

`default_nettype none

module protocol_centroid #(
  parameter int PositionWidth = 7,
  parameter int WeightWidth   = 38,
  localparam int MomentWidth = WeightWidth + PositionWidth
) (
  input  logic                   clk,
  input  logic                   rst,
  input  logic                   start,
  input  logic [MomentWidth-1:0] column_moment,
  input  logic [MomentWidth-1:0] row_moment,
  input  logic [WeightWidth-1:0] weight,
  input  logic                   done,
  output logic                   holds,
  output logic                   counts_done,
  output logic                   counts
);

  logic reset, live = 1'b0, dividing = 1'b0;
  logic [MomentWidth-1:0] held_moment, limit;
  logic [WeightWidth-1:0] held_weight;
  assign limit = {weight, PositionWidth'(0)} - MomentWidth'(weight);
  assign reset = rst | ~holds;
  assign holds = rst | (start
      ? weight != '0 & column_moment <= limit & row_moment <= limit
      : ~dividing | (row_moment == held_moment & weight == held_weight));
  assign counts_done = live & ~reset;
  assign counts = counts_done & done;
  always_ff @(posedge clk) begin
    live <= live | reset;
    dividing <= ~reset & (start | (dividing & ~done));
    if (start) begin
      held_moment <= row_moment;
      held_weight <= weight;
    end
  end

endmodule

`default_nettype wire
