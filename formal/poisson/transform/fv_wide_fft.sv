// SPDX-License-Identifier: Apache-2.0
// fv_wide_fft: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no others.
// What becomes of the words is the matter of the cores within, each proven by itself.

`default_nettype none

module fv_wide_fft #(
  parameter int Size    = 8,
  parameter int Paths   = 2,
  parameter int Inverse = 0,
  parameter int Latency = 14,
  parameter int Width   = 3
) (
  input logic                   clk,
  input logic                   rst,
  input logic                   en,
  input logic                   in_start,
  input logic                   in_frame_start,
  input logic [Paths*Width-1:0] in_re,
  input logic [Paths*Width-1:0] in_im
);

  logic out_start, out_frame_start;
  logic [Paths*Width-1:0] out_re, out_im;
  logic [$clog2(2*Paths*($clog2(Size)+($clog2(Size)-1)/2)+1)-1:0] saturations;
  wide_fft #(.Width(Width), .CoeffWidth(Paths == 1 ? 2 : 3), .Size(Size), .Paths(Paths), .Inverse(Inverse)) dut (.*);

  wide_timing #(.Beats(Size / Paths), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());

endmodule

`default_nettype wire
