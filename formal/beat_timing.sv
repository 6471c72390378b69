// SPDX-License-Identifier: Apache-2.0
// beat_timing: burst_timing of Beats beats whose words come 2 enabled clocks behind their start; `active` and `beat`
// are those of the words.

`default_nettype none

module beat_timing #(
  parameter int Beats   = 4,
  parameter int Latency = 2,
  localparam int BeatWidth = $clog2(Beats)
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,
  input  logic                 in_start,
  input  logic                 in_frame_start,
  input  logic                 out_start,
  input  logic                 out_frame_start,
  output logic                 started,
  output logic                 active,
  output logic [BeatWidth-1:0] beat
);

  logic coming;
  logic [BeatWidth-1:0] position;
  logic [1:0] active_q;
  logic [1:0][BeatWidth-1:0] beat_q;
  burst_timing #(.Columns(Beats), .Latency(Latency)) u_timing (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .out_frame_start, .started, .active(coming), .position,
    .row()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      active_q <= {active_q[0], coming};
      beat_q <= {beat_q[0], position};
    end
    if (rst) active_q <= '0;
  end
  assign active = active_q[1];
  assign beat = beat_q[1];

endmodule

`default_nettype wire
