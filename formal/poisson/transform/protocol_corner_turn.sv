// SPDX-License-Identifier: Apache-2.0
// protocol_corner_turn: rows of Columns words in the lanes in turn, each Columns / Lanes enabled clocks behind the row
// before.
//
// A frame begins with in_frame_start in lane 0, when no row of the frame before is coming in; after a reset none has
// begun. It ends with the first step in which no row begins.

`default_nettype none

module protocol_corner_turn #(
  parameter int Columns = 8,
  parameter int Lanes   = 2
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic [Lanes-1:0] in_start,
  input  logic             in_frame_start,
  input  logic             out_start,
  output logic             holds,
  output logic             counts_out_start,
  output logic             counts_out_frame_start,
  output logic             counts
);

  localparam int Step = Columns / Lanes;

  logic reset, live = 1'b0, running = 1'b0, due, allowed;
  logic [Lanes-1:0] next_lane = '0;
  logic [15:0] step_left = '0, in_left = '0, out_left = '0;
  assign reset = rst | ~holds;
  assign due = running & step_left == '0;
  always_comb begin
    allowed = in_start == '0;
    if (in_frame_start) allowed = in_start == Lanes'(1) & in_left == '0;
    else if (due) allowed = in_start == '0 | in_start == next_lane;
  end
  assign holds = allowed & (~in_frame_start | in_start[0]);
  assign counts_out_start = live & ~reset & en;
  assign counts_out_frame_start = counts_out_start;
  assign counts = counts_out_start & (out_start | out_left != '0);

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      if (in_start != '0) begin
        running <= 1'b1;
        step_left <= 16'(Step - 1);
        in_left <= 16'(Columns + Step - 1);
        next_lane <= {in_start[Lanes-2:0], in_start[Lanes-1]};
      end else begin
        if (due) running <= 1'b0;
        step_left <= step_left - 16'(step_left != '0);
        in_left <= in_left - 16'(in_left != '0);
      end
      out_left <= out_start ? 16'(Step - 1) : out_left - 16'(out_left != '0);
    end
    if (reset) begin
      running <= 1'b0;
      in_left <= '0;
      out_left <= '0;
      step_left <= '0;
    end
  end

endmodule

`default_nettype wire
