// SPDX-License-Identifier: Apache-2.0
// beat_peak: largest depth of a beat.
//
// The depths of a beat are neighbours in a row; an offset is the position of a depth in it, from 0. Stream in: a beat
// in every cycle. Stream out: its peak, Latency = log2(Lanes) cycles later, by a tree with a register in each level.
// Bit-accurate model: models/tactile_depth/chip/contact/beat_peak.py.

`default_nettype none

module beat_peak #(
  parameter int Width = 24,
  parameter int Lanes = 8,  // a power of two
  localparam int OffsetWidth = $clog2(Lanes)
) (
  input  wire                     clk,
  input  wire  [Lanes*Width-1:0]  data,        // depth codes, signed
  output logic signed [Width-1:0] peak,
  output logic [OffsetWidth-1:0]  peak_offset  // of equal peaks the first
);

  // Node n has the nodes 2 n and 2 n + 1 below it; below the lowest nodes are the depths.
  for (genvar n = 1; n < Lanes; n++) begin : g_node
    logic right_higher;
    logic signed [Width-1:0] top, left_top, right_top;
    logic [OffsetWidth-1:0] top_at, left_top_at, right_top_at;
    if (2 * n >= Lanes) begin : g_depths
      localparam int Left = 2 * n - Lanes;
      assign left_top = data[Left*Width+:Width];
      assign right_top = data[(Left+1)*Width+:Width];
      assign left_top_at = OffsetWidth'(Left);
      assign right_top_at = OffsetWidth'(Left + 1);
    end else begin : g_nodes
      assign {left_top, left_top_at} = {g_node[2*n].top, g_node[2*n].top_at};
      assign {right_top, right_top_at} = {g_node[2*n+1].top, g_node[2*n+1].top_at};
    end

    assign right_higher = right_top > left_top;
    always_ff @(posedge clk) begin
      {top, top_at} <= right_higher ? {right_top, right_top_at} : {left_top, left_top_at};
    end
  end

  assign peak = g_node[1].top;
  assign peak_offset = g_node[1].top_at;

endmodule

`default_nettype wire
