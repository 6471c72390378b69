// SPDX-License-Identifier: Apache-2.0
// row_pair_timing: bursts of two rows come as protocol_two_rows allows them. The first row of a burst leaves Latency
// enabled clocks behind its start, the second one OutBeats later unless the first came alone; frame_start with the
// first row of a frame; no other row leaves. `active` and `beat` are those of the words, 2 enabled clocks behind it.

`default_nettype none

module row_pair_timing #(
  parameter int Beats    = 4,
  parameter int OutBeats = 2,
  parameter int Latency  = 8,
  localparam int BeatWidth = $clog2(Beats)
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,
  input  logic                 in_start,
  input  logic                 in_frame_start,
  input  logic                 in_alone,
  input  logic                 out_start,
  input  logic                 out_frame_start,
  output logic                 started,
  output logic                 active,
  output logic [BeatWidth-1:0] beat
);

  localparam int Longest = Latency + OutBeats;

  logic allowed, coming;
  logic [BeatWidth-1:0] position;
  protocol_two_rows #(.Beats(Beats), .OutBeats(OutBeats)) u_protocol (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_alone, .out_start, .active(coming), .position, .holds(allowed)
  );
  assumed u_assumed (.*);

  logic [Longest-1:0] start_q, second_q;
  logic [Latency-1:0] frame_start_q;
  logic [1:0] active_q;
  logic [1:0][BeatWidth-1:0] beat_q;
  assign active = active_q[1];
  assign beat = beat_q[1];
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= Longest'({start_q, in_start});
      second_q <= Longest'({second_q, in_start & ~in_alone});
      frame_start_q <= Latency'({frame_start_q, in_frame_start});
      active_q <= {active_q[0], coming};
      beat_q <= {beat_q[0], position};
    end
    if (rst) begin
      start_q <= '0;
      second_q <= '0;
      frame_start_q <= '0;
      active_q <= '0;
    end
  end

  always_comb begin
    if (started) begin
      row_when_due: assert (out_start == (start_q[Latency-1] | second_q[Longest-1]));
      frame_start_when_due: assert (out_frame_start == frame_start_q[Latency-1]);
      next_burst_behind: cover (second_q[Longest-1] && start_q[Longest-2*OutBeats-1] && en);
      row_alone: cover (out_frame_start && !second_q[Latency-1] && en);
    end
  end

endmodule

`default_nettype wire
