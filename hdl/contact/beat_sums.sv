// SPDX-License-Identifier: Apache-2.0
// beat_sums: count, weight, moment and limits of the depths of one beat that are above a threshold.
//
// The depths of a beat are neighbours in a row; an offset is the position of a depth in it, from 0. Its weight is what
// it is above the threshold. A moment counts offsets from the last depth. Stream in: a beat in every cycle. Stream out:
// its sums, Latency = log2(Lanes) cycles later, by a tree with a register in each level. Where nothing is above, count,
// weight and moment are 0, and the limits have no meaning.
// Bit-accurate model: models/tactile_depth/chip/contact/beat_sums.py.

`default_nettype none

module beat_sums #(
  parameter int Width = 24,
  parameter int Lanes = 8,  // a power of two
  localparam int OffsetWidth = $clog2(Lanes),
  localparam int WeightWidth = Width + OffsetWidth,
  localparam int MomentWidth = WeightWidth + OffsetWidth
) (
  input  wire                    clk,
  input  wire  [Lanes*Width-1:0] weights,        // depth codes, unsigned; 0 where not above
  output logic [OffsetWidth:0]   count,          // depths above
  output logic [WeightWidth-1:0] weight,         // sum
  output logic [MomentWidth-1:0] moment,         // sum of each weight times Lanes - 1 - offset
  output logic [OffsetWidth-1:0] least_offset,
  output logic [OffsetWidth-1:0] greatest_offset
);

  // Node n has the nodes 2 n and 2 n + 1 below it, each of Half depths; below the lowest nodes are the depths.
  for (genvar n = 1; n < Lanes; n++) begin : g_node
    localparam int HalfLog2 = OffsetWidth - $clog2(n + 1);
    logic left_none, right_none;
    logic [OffsetWidth:0] total, left_total, right_total;
    logic [WeightWidth-1:0] sum, left_sum, right_sum;
    logic [MomentWidth-1:0] turn, left_turn, right_turn;  // moments
    logic [OffsetWidth-1:0] first, left_first, right_first, last, left_last, right_last;
    if (2 * n >= Lanes) begin : g_depths
      localparam int Left = 2 * n - Lanes;
      assign left_total = (OffsetWidth + 1)'(weights[Left*Width+:Width] != '0);
      assign right_total = (OffsetWidth + 1)'(weights[(Left+1)*Width+:Width] != '0);
      assign left_sum = WeightWidth'(weights[Left*Width+:Width]);
      assign right_sum = WeightWidth'(weights[(Left+1)*Width+:Width]);
      assign {left_turn, right_turn} = '0;
      assign {left_first, left_last} = {2{OffsetWidth'(Left)}};
      assign {right_first, right_last} = {2{OffsetWidth'(Left + 1)}};
    end else begin : g_nodes
      assign {left_total, right_total} = {g_node[2*n].total, g_node[2*n+1].total};
      assign {left_sum, right_sum} = {g_node[2*n].sum, g_node[2*n+1].sum};
      assign {left_turn, right_turn} = {g_node[2*n].turn, g_node[2*n+1].turn};
      assign {left_first, left_last} = {g_node[2*n].first, g_node[2*n].last};
      assign {right_first, right_last} = {g_node[2*n+1].first, g_node[2*n+1].last};
    end

    assign left_none = left_total == '0;
    assign right_none = right_total == '0;
    always_ff @(posedge clk) begin
      total <= left_total + right_total;
      sum <= left_sum + right_sum;
      turn <= left_turn + right_turn + (MomentWidth'(left_sum) << HalfLog2);
      first <= left_none ? right_first : left_first;
      last <= right_none ? left_last : right_last;
    end
  end

  assign count = g_node[1].total;
  assign weight = g_node[1].sum;
  assign moment = g_node[1].turn;
  assign least_offset = g_node[1].first;
  assign greatest_offset = g_node[1].last;

endmodule

`default_nettype wire
