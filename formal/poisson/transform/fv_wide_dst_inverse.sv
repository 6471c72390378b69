// SPDX-License-Identifier: Apache-2.0
// fv_wide_dst_inverse: the first row of a burst leaves Latency enabled clocks behind its start, the second one behind
// it unless the first came alone; frame_start with the first row of a frame; no other row leaves. What becomes of the
// words is the matter of the cores within, each proven by itself.

parameter int Size = 8;
parameter int Words = 4;
parameter int Latency = 32;
parameter int Width = 3;
localparam int InWidth = Width;
localparam int InputDrop = 0;
localparam int CoeffWidth = 3;
localparam int OutputDrop = 0;
localparam int OutWidth = Width;

row_pair_timing #(.Beats(2 * Size / Words), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());
