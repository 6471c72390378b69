// SPDX-License-Identifier: Apache-2.0
// protocol_wide_stack: bursts of Columns / InWords clocks as protocol_bursts allows them, no faster in all than a frame
// of them leaves; pairs of rows going out, 6 enabled clocks behind their starts.

`default_nettype none

module protocol_wide_stack #(
  parameter int Columns  = 16,
  parameter int Rows     = 3,
  parameter int InWords  = 2,
  parameter int OutWords = 4,
  localparam int Clocks = Columns / InWords,
  localparam int Beats = Columns / OutWords,
  localparam int PositionWidth = $clog2(Clocks),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     out_start,
  output logic                     active,
  output logic [PositionWidth-1:0] position,
  output logic [RowWidth-1:0]      row,
  output logic                     last_row,
  output logic                     holds,
  output logic                     counts_out_start,
  output logic                     counts_out_frame_start,
  output logic                     counts_out_alone,
  output logic                     counts
);

  // Clocks that a frame of an odd number of rows waits, where rows come as fast as they leave.
  localparam int Wait = (Rows + 1) / 2 * 2 * Beats > Rows * Clocks ? (Rows + 1) / 2 * 2 * Beats - Rows * Clocks : 0;

  logic bursts, unused_saturations, unused_counts;
  logic [15:0] wait_left = '0, out_left = '0;
  logic [5:0] start_q = '0;
  assign holds = bursts & ~(in_start & in_frame_start & wait_left != '0);
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[5] | out_left != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row,
    .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations(unused_saturations),
    .counts(unused_counts)
  );
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start & last_row) wait_left <= 16'(Clocks + Wait - 1);
      else wait_left <= wait_left - 16'(wait_left != '0);
      start_q <= 6'({start_q, out_start});
      out_left <= start_q[5] ? 16'(2 * Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (rst | ~holds) begin
      wait_left <= '0;
      start_q <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
