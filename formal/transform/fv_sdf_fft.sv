// SPDX-License-Identifier: Apache-2.0
// fv_sdf_fft: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no others.
// What becomes of the words is the matter of the cores within, each proven by itself.

module fv_sdf_fft #(
  parameter int Size    = 8,
  parameter int Inverse = 0,
  parameter int Latency = 16,
  parameter int Width   = 2
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    en,
  input logic                    go,
  input logic                    restart,
  input logic signed [Width-1:0] in_re,
  input logic signed [Width-1:0] in_im
);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_start, in_frame_start, active, last_row;
  logic [$clog2(Size)-1:0] position;
  logic [1:0] row;
  burst_source #(.Size(Size), .Rows(2)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );

  logic out_start, out_frame_start;
  logic signed [Width-1:0] out_re, out_im;
  logic [6:0] saturations;
  sdf_fft #(.Width(Width), .CoeffWidth(2), .Size(Size), .Inverse(Inverse)) dut (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_re, .in_im,
    .out_start, .out_frame_start, .out_re, .out_im, .saturations
  );

  logic [Latency-1:0] start_q, frame_start_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    if (en) begin
      start_q <= Latency'({start_q, in_start});
      frame_start_q <= Latency'({frame_start_q, in_frame_start});
    end
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
    end
  end

  always_comb begin
    if (started) begin
      start_when_due: assert (out_start == start_q[Latency-1]);
      frame_start_when_due: assert (out_frame_start == frame_start_q[Latency-1]);
      next_burst_behind: cover (out_start && !out_frame_start && start_q[Size-1] && en);
      next_frame: cover (out_frame_start && start_q[Size-1:0] == '0);
    end
  end

endmodule
