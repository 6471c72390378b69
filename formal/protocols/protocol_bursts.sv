// SPDX-License-Identifier: Apache-2.0
// protocol_bursts: Columns words in successive enabled clocks, the first with in_start; the same going out.
//
// A frame begins with in_frame_start, at any burst, after less than a frame too; after a reset none has begun. Rows is
// the most bursts of a frame, 0 if they are not counted. A reset changes nothing of this in its first clock.

`default_nettype none

module protocol_bursts #(
  parameter int Columns = 8,
  parameter int Rows    = 0,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = Rows > 0 ? $clog2(Rows + 1) : 1
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     out_start,
  output logic                     active,  // a word is present, with this position in its burst
  output logic [PositionWidth-1:0] position,
  output logic [RowWidth-1:0]      row,     // of the burst in its frame
  output logic                     last_row,
  output logic                     holds,
  output logic                     counts_out_start,
  output logic                     counts_out_frame_start,
  output logic                     counts_saturations,
  output logic                     counts
);

  logic reset, live = 1'b0;
  logic [PositionWidth:0] left = '0;      // words of the burst after this clock's
  logic [RowWidth-1:0] next_row = '0, row_q;  // next_row: 0 if a frame must begin
  logic [15:0] out_left = '0;
  assign reset = rst | ~holds;
  assign active = in_start | left != '0;
  assign position = in_start ? '0 : PositionWidth'((PositionWidth + 1)'(Columns) - left);
  assign row = ~in_start ? row_q : in_frame_start ? '0 : next_row;
  assign last_row = Rows != 0 & row == RowWidth'(Rows - 1);
  assign holds = (~in_start | left == '0) & (~in_frame_start | in_start) & (~in_start | in_frame_start | next_row != '0);
  assign counts_out_start = live & ~reset & en;
  assign counts_out_frame_start = counts_out_start;
  assign counts_saturations = live & ~reset;
  assign counts = counts_out_start & (out_start | out_left != '0);

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      left <= in_start ? (PositionWidth + 1)'(Columns - 1) : left - (PositionWidth + 1)'(left != '0);
      out_left <= out_start ? 16'(Columns - 1) : out_left - 16'(out_left != '0);
      if (in_start) row_q <= row;
      if (in_start) next_row <= last_row ? '0 : Rows == 0 ? RowWidth'(1) : row + RowWidth'(1);
    end
    if (reset) begin
      left <= '0;
      out_left <= '0;
      next_row <= '0;
    end
  end

endmodule

`default_nettype wire
