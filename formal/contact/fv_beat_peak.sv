// SPDX-License-Identifier: Apache-2.0
// fv_beat_peak: the peak of every beat, Latency clocks later, compared with a loop over the depths of the beat.

parameter int Width = 2, Lanes = 4;
parameter int Latency = 2;  // models/tactile_depth/chip/contact/beat_peak.py

logic [Latency-1:0] known = '0;
logic [Latency*Lanes*Width-1:0] data_q;
always_ff @(posedge clk) begin
  known <= Latency'({known, 1'b1});
  data_q <= (Latency * Lanes * Width)'({data_q, data});
end

logic signed [Width-1:0] depth, highest;
logic [OffsetWidth-1:0] highest_at;
always_comb begin
  highest = data_q[(Latency-1)*Lanes*Width+:Width];
  highest_at = '0;
  for (int lane = 1; lane < Lanes; lane++) begin
    depth = data_q[((Latency-1)*Lanes+lane)*Width+:Width];
    if (depth > highest) {highest, highest_at} = {depth, OffsetWidth'(lane)};
  end
end

always_comb begin
  if (known[Latency-1]) begin
    top: assert (peak == highest && peak_offset == highest_at);
    tie: cover (peak_offset == OffsetWidth'(1) && peak == '0);
  end
end
