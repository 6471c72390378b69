// SPDX-License-Identifier: Apache-2.0
// protocol_back_substitution: bursts of Columns words, the rows of a frame in the lanes in turn.
//
// With one lane a row may come at any time after the row before, with several exactly Columns / Lanes enabled clocks
// behind its start. in_frame_start is high with the first burst of a frame in each lane. A frame begins in lane 0, when
// no row is coming in, after less than a frame too; after a reset none has begun.

`default_nettype none

module protocol_back_substitution #(
  parameter int Columns = 8,
  parameter int Rows    = 3,
  parameter int Lanes   = 1,
  parameter int Width   = 3  // of a word
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic [Lanes-1:0] in_start,
  input  logic [Lanes-1:0] in_frame_start,
  input  logic [Lanes-1:0] out_start,
  output logic             holds,
  output logic             counts_out_start,
  output logic             counts_out_frame_start,
  output logic [Lanes*Width-1:0] counts_out_data,  // a word of its lane leaves
  output logic             counts_saturations
);

  localparam int Step = Columns / Lanes;

  logic reset, live = 1'b0, due, in_turn, begins;
  logic [Lanes-1:0] next_lane = Lanes'(1), first_round = '0;
  logic [15:0] rows_left = '0, step_left = '0, in_left = '0;
  logic [Lanes*16-1:0] out_left = '0;
  assign reset = rst | ~holds;
  assign begins = in_frame_start[0];
  assign due = step_left == '0 & rows_left != '0 & (Lanes == 1 | in_left != '0);
  assign in_turn = due & in_start == next_lane & in_frame_start == (next_lane & first_round);
  assign holds = rst | (begins ? in_left == '0 & in_start == Lanes'(1) & in_frame_start == Lanes'(1)
      : (in_start == '0 & in_frame_start == '0) | in_turn);
  assign counts_out_start = live & ~reset & en;
  assign counts_out_frame_start = counts_out_start;
  assign counts_saturations = live & ~reset;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign counts_out_data[lane*Width+:Width]
        = {Width{counts_out_start & (out_start[lane] | out_left[lane*16+:16] != '0)}};
  end

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      step_left <= step_left - 16'(step_left != '0);
      in_left <= in_left - 16'(in_left != '0);
      if (in_start != '0) begin
        step_left <= 16'(Step - 1);
        // With several lanes a step passes between frames.
        in_left <= 16'(Lanes == 1 ? Columns - 1 : Columns + Step - 1);
        rows_left <= (begins ? 16'(Rows) : rows_left) - 16'd1;
        first_round <= (begins ? '1 : first_round) & ~in_start;
        next_lane <= Lanes'({in_start, in_start} >> (Lanes - 1));
      end else if (due && Lanes > 1) rows_left <= '0;  // a row that does not come ends the frame
      for (int lane = 0; lane < Lanes; lane++) begin
        if (out_start[lane]) out_left[lane*16+:16] <= 16'(Columns - 1);
        else if (out_left[lane*16+:16] != '0) out_left[lane*16+:16] <= out_left[lane*16+:16] - 16'd1;
      end
    end
    if (reset) begin
      rows_left <= '0;
      in_left <= '0;
      step_left <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
