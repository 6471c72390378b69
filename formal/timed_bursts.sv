// SPDX-License-Identifier: Apache-2.0
// timed_bursts: every legal stream of bursts, two to a frame, for a core that sends each Latency enabled clocks after
// it came: see burst_source and burst_timing. Each bench begins in reset.

`default_nettype none

module timed_bursts #(
  parameter int Columns = 8,
  parameter int Latency = 23
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic go,
  input  logic restart,
  output logic in_start,
  output logic in_frame_start,
  input  logic out_start,
  input  logic out_frame_start
);

  logic started = 1'b0, active, last_row;
  logic [$clog2(Columns)-1:0] position;
  logic [1:0] row;
  always_ff @(posedge clk) started <= 1'b1;
  always_comb if (!started) assume (rst);
  burst_source #(.Columns(Columns), .Rows(2)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );
  burst_timing #(.Columns(Columns), .Latency(Latency)) u_timing (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .out_frame_start
  );

endmodule

`default_nettype wire
