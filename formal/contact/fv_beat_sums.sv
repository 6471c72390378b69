// SPDX-License-Identifier: Apache-2.0
// fv_beat_sums: sums of every beat, Latency clocks later. Each is compared with a loop over the depths of the beat.

parameter int Width = 2, Lanes = 4;
parameter int Latency = 2;  // models/tactile_depth/chip/contact/beat_sums.py

logic [Latency-1:0] known = '0;
logic [Latency*Lanes*Width-1:0] weights_q;
always_ff @(posedge clk) begin
  known <= Latency'({known, 1'b1});
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
    if (of_lane != '0) begin
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
