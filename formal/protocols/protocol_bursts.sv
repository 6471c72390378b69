// SPDX-License-Identifier: Apache-2.0
// protocol_bursts: Columns words in successive enabled clocks, the first with in_start; the same going out.
//
// A frame begins with in_frame_start, at any burst, after less than a frame too; after a reset none has begun. Rows is
// the most bursts of a frame, 0 if they are not counted. Inputs stay while en is low.

`default_nettype none

module protocol_bursts #(
  parameter int Columns = 8,
  parameter int Rows    = 0
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_start,
  input  logic in_frame_start,
  input  logic out_start,
  output logic holds,
  output logic counts_out_start,
  output logic counts_out_frame_start,
  output logic counts_saturations,
  output logic counts
);

  logic reset, live = 1'b0, still = 1'b0, start_before, frame_start_before;
  logic [15:0] in_left = '0, out_left = '0;
  logic [15:0] rows_left = '0;  // bursts of the frame to come; 1 in any frame where they are not counted
  assign reset = rst | ~holds;
  assign holds = (~in_start | in_left == '0) & (~in_frame_start | in_start)
      & (~in_start | rst | in_frame_start | rows_left != '0)
      & (~still | rst | (in_start == start_before & in_frame_start == frame_start_before));
  assign counts_out_start = live & ~reset & en;
  assign counts_out_frame_start = counts_out_start;
  assign counts_saturations = live & ~reset;
  assign counts = counts_out_start & (out_start | out_left != '0);

  always_ff @(posedge clk) begin
    live <= live | reset;
    still <= ~en & ~reset;
    start_before <= in_start;
    frame_start_before <= in_frame_start;
    if (en) begin
      in_left <= in_start ? 16'(Columns - 1) : in_left - 16'(in_left != '0);
      out_left <= out_start ? 16'(Columns - 1) : out_left - 16'(out_left != '0);
      if (in_frame_start) rows_left <= Rows == 0 ? 16'd1 : 16'(Rows - 1);
      else if (in_start && Rows != 0) rows_left <= rows_left - 16'd1;
    end
    if (reset) begin
      in_left <= '0;
      out_left <= '0;
      rows_left <= '0;
    end
  end

endmodule

`default_nettype wire
