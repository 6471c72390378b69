// SPDX-License-Identifier: Apache-2.0
// fv_sdf_fft: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no others.
// What becomes of the words is the matter of the cores within, each proven by itself.

parameter int Size = 8, Inverse = 0, Latency = 16, Width = 2;
localparam int CoeffWidth = 2;

burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .started(), .active(), .position(), .row());
