// SPDX-License-Identifier: Apache-2.0
// fv_beat_sums: sums of every beat, Latency clocks later. Each is compared with a loop over the depths of the beat.

`default_nettype none

module fv_beat_sums #(
  parameter int Width   = 2,
  parameter int Lanes   = 4,
  parameter int Latency = 2,  // models/tactile_depth/contact/beat_sums.py
  localparam int OffsetWidth = $clog2(Lanes),
  localparam int VolumeWidth = Width + OffsetWidth
) (
  input logic                   clk,
  input logic [Lanes-1:0]       above,
  input logic [Lanes*Width-1:0] data
);

  logic [OffsetWidth:0] count;
  logic [2*OffsetWidth-1:0] offset_sum;
  logic signed [VolumeWidth-1:0] volume;
  logic signed [Width-1:0] peak;
  logic [OffsetWidth-1:0] peak_offset, least_offset, greatest_offset;
  beat_sums #(.Width(Width), .Lanes(Lanes)) dut (.*);

  logic [Latency-1:0] known = '0;
  logic [Latency*Lanes-1:0] above_q;
  logic [Latency*Lanes*Width-1:0] data_q;
  always_ff @(posedge clk) begin
    known <= Latency'({known, 1'b1});
    above_q <= (Latency * Lanes)'({above_q, above});
    data_q <= (Latency * Lanes * Width)'({data_q, data});
  end

  logic any;
  logic [OffsetWidth:0] total;
  logic [2*OffsetWidth-1:0] offsets;
  logic signed [VolumeWidth-1:0] sum;
  logic signed [Width-1:0] depth, highest;
  logic [OffsetWidth-1:0] highest_at, first, last;
  always_comb begin
    any = 1'b0;
    total = '0;
    offsets = '0;
    sum = '0;
    highest = '0;
    {highest_at, first, last} = '0;
    for (int lane = 0; lane < Lanes; lane++) begin
      depth = data_q[((Latency-1)*Lanes+lane)*Width+:Width];
      if (above_q[(Latency-1)*Lanes+lane]) begin
        total = total + (OffsetWidth + 1)'(1);
        offsets = offsets + (2 * OffsetWidth)'(lane);
        sum = sum + VolumeWidth'(depth);
        if (!any || depth > highest) {highest, highest_at} = {depth, OffsetWidth'(lane)};
        if (!any) first = OffsetWidth'(lane);
        last = OffsetWidth'(lane);
        any = 1'b1;
      end
    end
  end

  always_comb begin
    if (known[Latency-1]) begin
      sums: assert (count == total && offset_sum == offsets && volume == sum);
      if (any) limits: assert (least_offset == first && greatest_offset == last);
      if (any) top: assert (peak == highest && peak_offset == highest_at);
      tie: cover (count == (OffsetWidth + 1)'(Lanes - 1) && peak_offset == OffsetWidth'(1) && peak == '0);
      none: cover (count == '0);
    end
  end

endmodule

`default_nettype wire
