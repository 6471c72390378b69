// SPDX-License-Identifier: Apache-2.0
// beat_sums: count, sums, limits and peak of the depths of one beat that are above a threshold.
//
// The depths of a beat are neighbours in a row; an offset is the position of a depth in it, from 0. Stream in: a beat
// in every cycle. Stream out: its sums, Latency = log2(Lanes) cycles later, by a tree with a register in each level.
// Where nothing is above, count, offset_sum and volume are 0, and the others have no meaning. Bit-accurate model:
// models/tactile_depth/contact/beat_sums.py.

`default_nettype none

module beat_sums #(
  parameter int Width = 24,
  parameter int Lanes = 8,
  localparam int OffsetWidth = $clog2(Lanes),
  localparam int VolumeWidth = Width + OffsetWidth
) (
  input  wire                           clk,
  input  wire  [Lanes-1:0]              above,
  input  wire  [Lanes*Width-1:0]        data,             // depth codes, signed
  output logic [OffsetWidth:0]          count,            // depths above
  output logic [2*OffsetWidth-1:0]      offset_sum,
  output logic signed [VolumeWidth-1:0] volume,           // sum of the depths
  output logic signed [Width-1:0]       peak,
  output logic [OffsetWidth-1:0]        peak_offset,      // of equal peaks the first
  output logic [OffsetWidth-1:0]        least_offset,
  output logic [OffsetWidth-1:0]        greatest_offset
);

  // Node n has the nodes 2 n and 2 n + 1 below it; below the lowest nodes are the depths.
  for (genvar n = 1; n < Lanes; n++) begin : g_node
    logic [OffsetWidth:0] total, left_total, right_total;
    logic [2*OffsetWidth-1:0] offsets, left_offsets, right_offsets;
    logic signed [VolumeWidth-1:0] sum, left_sum, right_sum;
    logic signed [Width-1:0] top, left_top, right_top;
    logic [OffsetWidth-1:0] top_at, left_top_at, right_top_at, first, left_first, right_first;
    logic [OffsetWidth-1:0] last, left_last, right_last;
    if (2 * n >= Lanes) begin : g_depths
      localparam int Left = 2 * n - Lanes;
      assign left_total = (OffsetWidth + 1)'(above[Left]);
      assign right_total = (OffsetWidth + 1)'(above[Left+1]);
      assign left_offsets = above[Left] ? (2 * OffsetWidth)'(Left) : '0;
      assign right_offsets = above[Left+1] ? (2 * OffsetWidth)'(Left + 1) : '0;
      assign left_top = data[Left*Width+:Width];
      assign right_top = data[(Left+1)*Width+:Width];
      assign left_sum = above[Left] ? VolumeWidth'(left_top) : '0;
      assign right_sum = above[Left+1] ? VolumeWidth'(right_top) : '0;
      assign {left_top_at, left_first, left_last} = {3{OffsetWidth'(Left)}};
      assign {right_top_at, right_first, right_last} = {3{OffsetWidth'(Left + 1)}};
    end else begin : g_nodes
      assign left_total = g_node[2*n].total;
      assign right_total = g_node[2*n+1].total;
      assign left_offsets = g_node[2*n].offsets;
      assign right_offsets = g_node[2*n+1].offsets;
      assign left_sum = g_node[2*n].sum;
      assign right_sum = g_node[2*n+1].sum;
      assign left_top = g_node[2*n].top;
      assign right_top = g_node[2*n+1].top;
      assign {left_top_at, left_first, left_last} = {g_node[2*n].top_at, g_node[2*n].first, g_node[2*n].last};
      assign {right_top_at, right_first, right_last} = {g_node[2*n+1].top_at, g_node[2*n+1].first, g_node[2*n+1].last};
    end

    logic left_none, right_none, right_higher;
    assign left_none = left_total == '0;
    assign right_none = right_total == '0;
    assign right_higher = left_none | (~right_none & (right_top > left_top));
    always_ff @(posedge clk) begin
      total <= left_total + right_total;
      offsets <= left_offsets + right_offsets;
      sum <= left_sum + right_sum;
      {top, top_at} <= right_higher ? {right_top, right_top_at} : {left_top, left_top_at};
      first <= left_none ? right_first : left_first;
      last <= right_none ? left_last : right_last;
    end
  end

  assign count = g_node[1].total;
  assign offset_sum = g_node[1].offsets;
  assign volume = g_node[1].sum;
  assign peak = g_node[1].top;
  assign peak_offset = g_node[1].top_at;
  assign least_offset = g_node[1].first;
  assign greatest_offset = g_node[1].last;

  if (Lanes < 2 || Lanes != (1 << $clog2(Lanes))) begin : g_refused
    Lanes_must_be_a_power_of_two_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
