// SPDX-License-Identifier: Apache-2.0
// fv_dst_inverse: start, frame_start and alone leave with the burst they came with, Latency enabled clocks later, and no
// others. What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8, Paths = 2, Latency = 32, Width = 3;
localparam int InWidth = Width, InputDrop = 0, CoeffWidth = 3, OutputDrop = 0, OutWidth = Width;

logic started;
beat_timing #(.Beats(Size / Paths), .Latency(Latency)) u_timing (.*, .active(), .beat());
logic [Latency-1:0] alone_q;
always_ff @(posedge clk) if (en) alone_q <= {alone_q[Latency-2:0], in_alone};
always_comb if (started && out_start) alone_when_due: assert (out_alone == alone_q[Latency-1]);
