// SPDX-License-Identifier: Apache-2.0
// fv_dst_inverse: start and frame_start leave with the burst they came with, Latency enabled clocks later, and no others; what a
// burst becomes depends on its own words alone.
//
// For the second there are two transforms. They start from any state, each its own, and get the same bursts at the same
// times, but words of their own, save in an arbitrary burst, where the words are the same. That burst leaves both alike.

module fv_dst_inverse #(
  parameter int Size    = 8,
  parameter int Latency = 16,
  parameter int Width   = 2
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    en,
  input logic                    go,
  input logic                    restart,
  input logic                    pick,
  input logic signed [Width-1:0] in_data[2]
);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_start, in_frame_start, active, last_row;
  logic [$clog2(Size)-1:0] position;
  logic [1:0] row;
  burst_source #(.Size(Size), .Rows(2)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );

  logic same, same_q;  // the burst whose word is present has the same words in both
  assign same = active & (in_start ? pick : same_q);

  logic out_start[2], out_frame_start[2];
  logic signed [Width-1:0] out_data[2];
  logic [7:0] saturations[2];
  for (genvar i = 0; i < 2; i++) begin : g_copy
    dst_inverse #(
      .Size(Size), .InWidth(Width), .InputDrop(0), .Width(Width), .CoeffWidth(2), .OutputDrop(0), .OutWidth(Width)
    ) dut (
      .clk, .rst, .en, .in_start, .in_frame_start,
      .in_data(same ? in_data[0] : in_data[i]),
      .out_start(out_start[i]), .out_frame_start(out_frame_start[i]), .out_data(out_data[i]),
      .saturations(saturations[i])
    );
  end

  logic [Latency-1:0] start_q, frame_start_q, marked;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    if (en) begin
      start_q <= Latency'({start_q, in_start});
      frame_start_q <= Latency'({frame_start_q, in_frame_start});
      marked <= Latency'({marked, same});
      same_q <= same;
    end
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
      marked <= '0;
    end
  end

  always_comb begin
    if (started) begin
      start_when_due: assert (out_start[0] == start_q[Latency-1]);
      frame_start_when_due: assert (out_frame_start[0] == frame_start_q[Latency-1]);
      if (marked[Latency-1]) own_words_alone: assert (out_data[0] == out_data[1]);
      next_burst_behind: cover (out_start[0] && !out_frame_start[0] && start_q[Size-1] && en);
      next_frame: cover (out_frame_start[0] && start_q[Size-1:0] == '0);
      others_differ: cover (marked[Latency-1] && out_start[0] && out_data[0] != '0);
      differs: cover (started && !marked[Latency-1] && out_start[0] && out_data[0] != out_data[1]);
    end
  end

endmodule
