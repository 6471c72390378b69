// SPDX-License-Identifier: Apache-2.0
// fv_dst_forward: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8, Latency = 23, Width = 2;
localparam int InWidth = Width, InputDrop = 0, CoeffWidth = 2, OutputDrop = 0, OutWidth = Width;

burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .started(), .active(), .position(), .row());
