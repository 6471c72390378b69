// SPDX-License-Identifier: Apache-2.0
// fv_sdf_fft: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no others.
// What becomes of the words is the matter of the cores within, each proven by itself.

`default_nettype none

module fv_sdf_fft #(
  parameter int Size    = 8,
  parameter int Inverse = 0,
  parameter int Latency = 16,
  parameter int Width   = 2
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    en,
  input logic                    in_start,
  input logic                    in_frame_start,
  input logic signed [Width-1:0] in_re,
  input logic signed [Width-1:0] in_im
);

  logic out_start, out_frame_start;
  logic signed [Width-1:0] out_re, out_im;
  logic [6:0] saturations;
  sdf_fft #(.Width(Width), .CoeffWidth(2), .Size(Size), .Inverse(Inverse)) dut (.*);

  burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .started(), .active(), .position(), .row());

endmodule

`default_nettype wire
