// SPDX-License-Identifier: Apache-2.0
// protocol_beat_sums: the weight of a depth that is not above is 0; limits count where something is above.

`default_nettype none

module protocol_beat_sums #(
  parameter int Width = 24,
  parameter int Lanes = 8
) (
  input  logic [Lanes-1:0]       above,
  input  logic [Lanes*Width-1:0] weights,
  input  logic [$clog2(Lanes):0] count,
  output logic                   holds,
  output logic                   counts_least_offset,
  output logic                   counts_greatest_offset
);

  logic [Lanes-1:0] without_weight;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign without_weight[lane] = weights[lane*Width+:Width] == '0;
  end
  assign holds = (above | without_weight) == '1;
  assign {counts_least_offset, counts_greatest_offset} = {2{count != '0}};

endmodule

`default_nettype wire
