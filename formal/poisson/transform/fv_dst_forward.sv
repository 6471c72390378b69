// SPDX-License-Identifier: Apache-2.0
// fv_dst_forward: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8, Words = 2, Latency = 20, Width = 3;
localparam int InWidth = Width, CoeffWidth = 3, OutputDrop = 0, OutWidth = Width;

beat_timing #(.Beats(Size / Words), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());
