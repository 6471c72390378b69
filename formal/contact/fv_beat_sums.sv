// SPDX-License-Identifier: Apache-2.0
// fv_beat_sums: sums of every beat, Latency clocks later. Each is compared with a loop over the depths of the beat.

parameter int Width = 2, Lanes = 4;
parameter int Latency = 2;  // models/tactile_depth/chip/contact/beat_sums.py

always_comb assume (u_protocol.allowed);

logic [Latency-1:0] known = '0;
logic [Latency*Lanes-1:0] above_q;
logic [Latency*Lanes*Width-1:0] weights_q;
always_ff @(posedge clk) begin
  known <= Latency'({known, 1'b1});
  above_q <= (Latency * Lanes)'({above_q, above});
  weights_q <= (Latency * Lanes * Width)'({weights_q, weights});
end

logic any;
logic [OffsetWidth:0] total;
logic [WeightWidth-1:0] sum;
logic [MomentWidth-1:0] turn, of_lane;
logic [OffsetWidth-1:0] first, last;
always_comb begin
  any = 1'b0;
  total = '0;
  sum = '0;
  turn = '0;
  {first, last} = '0;
  for (int lane = 0; lane < Lanes; lane++) begin
    of_lane = MomentWidth'(weights_q[((Latency-1)*Lanes+lane)*Width+:Width]);
    sum = sum + WeightWidth'(of_lane);
    turn = turn + of_lane * MomentWidth'(Lanes - 1 - lane);
    if (above_q[(Latency-1)*Lanes+lane]) begin
      total = total + (OffsetWidth + 1)'(1);
      if (!any) first = OffsetWidth'(lane);
      last = OffsetWidth'(lane);
      any = 1'b1;
    end
  end
end

always_comb begin
  if (known[Latency-1]) begin
    sums: assert (count == total && weight == sum && moment == turn);
    if (any) limits: assert (least_offset == first && greatest_offset == last);
    some: cover (count == (OffsetWidth + 1)'(Lanes - 1) && moment != '0);
    none: cover (count == '0);
  end
end

// Protocol: the weight of a depth that is not above is 0; limits count where something is above.
module protocol_beat_sums;
  logic [Lanes-1:0] without_weight;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign without_weight[lane] = weights[lane*Width+:Width] == '0;
  end
  assign holds = (above | without_weight) == '1;
  assign {counts_least_offset, counts_greatest_offset} = {2{count != '0}};
endmodule
