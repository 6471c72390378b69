// SPDX-License-Identifier: Apache-2.0
// fv_beat_peak: the peak of every beat, Latency clocks later, compared with a loop over the depths of the beat.

parameter int Width = 2, Lanes = 4;
parameter int Latency = 2;  // models/tactile_depth/chip/contact/beat_peak.py

logic [Latency-1:0] known = '0;
logic [Latency*Lanes-1:0] above_q;
logic [Latency*Lanes*Width-1:0] data_q;
always_ff @(posedge clk) begin
  known <= Latency'({known, 1'b1});
  above_q <= (Latency * Lanes)'({above_q, above});
  data_q <= (Latency * Lanes * Width)'({data_q, data});
end

logic some;
logic signed [Width-1:0] depth, highest;
logic [OffsetWidth-1:0] highest_at;
always_comb begin
  some = 1'b0;
  highest = '0;
  highest_at = '0;
  for (int lane = 0; lane < Lanes; lane++) begin
    depth = data_q[((Latency-1)*Lanes+lane)*Width+:Width];
    if (above_q[(Latency-1)*Lanes+lane]) begin
      if (!some || depth > highest) {highest, highest_at} = {depth, OffsetWidth'(lane)};
      some = 1'b1;
    end
  end
end

always_comb begin
  if (known[Latency-1]) begin
    finds: assert (any == some);
    if (some) top: assert (peak == highest && peak_offset == highest_at);
    tie: cover (any && peak_offset == OffsetWidth'(1) && peak == '0);
    none: cover (!any);
  end
end
