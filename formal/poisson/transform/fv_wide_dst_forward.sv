// SPDX-License-Identifier: Apache-2.0
// fv_wide_dst_forward: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8;
parameter int Words = 2;
parameter int Latency = 20;
parameter int Width = 3;
localparam int InWidth = Width;
localparam int CoeffWidth = 3;
localparam int OutputDrop = 0;
localparam int OutWidth = Width;

wide_timing #(.Beats(Size / Words), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());
