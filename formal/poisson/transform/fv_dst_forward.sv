// SPDX-License-Identifier: Apache-2.0
// fv_dst_forward: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

`default_nettype none

module fv_dst_forward #(
  parameter int Size    = 8,
  parameter int Latency = 23,
  parameter int Width   = 2
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    en,
  input logic                    in_start,
  input logic                    in_frame_start,
  input logic signed [Width-1:0] in_data
);

  logic out_start, out_frame_start;
  logic signed [Width-1:0] out_data;
  logic [7:0] saturations;
  dst_forward #(
    .Size(Size), .InWidth(Width), .InputDrop(0), .Width(Width), .CoeffWidth(2), .OutputDrop(0), .OutWidth(Width)
  ) dut (.*);

  burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .started(), .active(), .position(), .row());

endmodule

`default_nettype wire
