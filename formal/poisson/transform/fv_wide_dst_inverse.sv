// SPDX-License-Identifier: Apache-2.0
// fv_wide_dst_inverse: the first row of a burst leaves Latency enabled clocks behind its start, the second one behind
// it unless the first came alone; frame_start with the first row of a frame; no other row leaves. What becomes of the
// words is the matter of the cores within, each proven by itself.

parameter int Size = 8, Words = 4, Latency = 32, Width = 3;
localparam int InWidth = Width, InputDrop = 0, CoeffWidth = 3, OutputDrop = 0, OutWidth = Width;

row_pair_timing #(.Beats(2 * Size / Words), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());
