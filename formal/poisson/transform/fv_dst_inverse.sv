// SPDX-License-Identifier: Apache-2.0
// fv_dst_inverse: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8;
parameter int Latency = 28;
parameter int Width = 2;
localparam int InWidth = Width;
localparam int InputDrop = 0;
localparam int CoeffWidth = 2;
localparam int OutputDrop = 0;
localparam int OutWidth = Width;

burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .started(), .active(), .position(), .row());
