// SPDX-License-Identifier: Apache-2.0
// protocol_wide_elimination: bursts of Columns / Words clocks as protocol_bursts allows them; words leave 2 enabled
// clocks behind the starts going out. out_last counts in the last row of a frame, out_ahead in all but the first.

`default_nettype none

module protocol_wide_elimination #(
  parameter int Columns = 16,
  parameter int Words   = 2,
  parameter int Rows    = 3,
  localparam int Clocks = Columns / Words,
  localparam int PositionWidth = $clog2(Clocks),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     out_start,
  input  logic                     out_frame_start,
  output logic                     active,  // a clock of a burst comes in 2 enabled clocks, with this position in it
  output logic [PositionWidth-1:0] position,
  output logic [RowWidth-1:0]      row,     // of the burst in its frame
  output logic                     last_row,
  output logic                     holds,
  output logic                     counts_out_start,
  output logic                     counts_out_frame_start,
  output logic                     counts_out_last,
  output logic                     counts_out_ahead,
  output logic                     counts_saturations
);

  logic [15:0] out_left = '0;
  logic [1:0] start_q = '0, frame_start_q;
  logic [RowWidth-1:0] out_row, out_row_q;
  logic words, unused_counts;
  assign words = counts_out_start & (start_q[1] | out_left != '0);
  assign out_row = ~start_q[1] ? out_row_q : frame_start_q[1] ? '0 : out_row_q + RowWidth'(1);
  assign counts_out_last = words & (out_row == RowWidth'(Rows - 1));
  assign counts_out_ahead = words & (out_row != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations, .counts(unused_counts)
  );
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[0], out_start};
      frame_start_q <= {frame_start_q[0], out_frame_start};
      out_left <= start_q[1] ? 16'(Clocks - 1) : out_left - 16'(out_left != '0);
      out_row_q <= out_row;
    end
    if (rst | ~holds) begin
      start_q <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
