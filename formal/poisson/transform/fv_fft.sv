// SPDX-License-Identifier: Apache-2.0
// fv_fft: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no others.
// What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8, Paths = 2, Inverse = 0, Latency = 14, Width = 3;
localparam int CoeffWidth = Paths == 1 ? 2 : 3;

beat_timing #(.Beats(Size / Paths), .Latency(Latency)) u_timing (.*, .started(), .active(), .beat());
