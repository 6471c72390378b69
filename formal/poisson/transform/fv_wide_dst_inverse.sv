// SPDX-License-Identifier: Apache-2.0
// fv_wide_dst_inverse: the first row of a burst leaves Latency enabled clocks behind its start, the second one behind
// it unless the first came alone; frame_start with the first row of a frame; no other row leaves. What becomes of the
// words is the matter of the cores within, each proven by itself.

`default_nettype none

module fv_wide_dst_inverse #(
  parameter int Size    = 8,
  parameter int Words   = 4,
  parameter int Latency = 32,
  parameter int Width   = 3
) (
  input logic                   clk,
  input logic                   rst,
  input logic                   en,
  input logic                   in_start,
  input logic                   in_frame_start,
  input logic                   in_alone,
  input logic [Words*Width-1:0] in_data
);

  logic out_start, out_frame_start;
  logic [Words*Width-1:0] out_data;
  logic [8+$clog2(Words)-1:0] saturations;
  wide_dst_inverse #(
    .Size(Size), .Words(Words), .InWidth(Width), .InputDrop(0), .Width(Width), .CoeffWidth(3), .OutputDrop(0),
    .OutWidth(Width)
  ) dut (.*);

  row_pair_timing #(.Beats(2 * Size / Words), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());

endmodule

`default_nettype wire
