// SPDX-License-Identifier: Apache-2.0
// fv_wide_dst_forward: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

`default_nettype none

module fv_wide_dst_forward #(
  parameter int Size    = 8,
  parameter int Words   = 2,
  parameter int Latency = 20,
  parameter int Width   = 3
) (
  input logic                   clk,
  input logic                   rst,
  input logic                   en,
  input logic                   in_start,
  input logic                   in_frame_start,
  input logic [Words*Width-1:0] in_data
);

  logic out_start, out_frame_start;
  logic [Words*Width-1:0] out_data;
  logic [8+$clog2(Words)-1:0] saturations;
  wide_dst_forward #(
    .Size(Size), .Words(Words), .InWidth(Width), .Width(Width), .CoeffWidth(3), .OutputDrop(0), .OutWidth(Width)
  ) dut (.*);

  wide_timing #(.Beats(Size / Words), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());

endmodule

`default_nettype wire
