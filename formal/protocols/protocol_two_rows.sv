// SPDX-License-Identifier: Apache-2.0
// protocol_two_rows: protocol_bursts of Beats beats with the words of two rows, or (in_alone) of one, no faster than
// the rows leave, which are bursts of OutBeats beats whose starts come with their words.

`default_nettype none

module protocol_two_rows #(
  parameter int Beats    = 4,
  parameter int OutBeats = 2,
  localparam int PositionWidth = $clog2(Beats)
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     in_alone,
  input  logic                     out_start,
  output logic                     active,  // a beat comes in 2 enabled clocks, with this position in its burst
  output logic [PositionWidth-1:0] position,
  output logic                     holds,
  output logic                     counts_out_start,
  output logic                     counts_out_frame_start,
  output logic                     counts
);

  logic bursts;
  logic [15:0] wait_left = '0, out_left = '0;  // enabled clocks until rows may come, in which a row leaves
  assign holds = bursts & ~(in_start & wait_left != '0);
  assign counts = counts_out_start & (out_start | out_left != '0);
  protocol_bursts #(.Columns(Beats)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row(), .last_row(),
    .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations(), .counts()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      wait_left <= in_start ? 16'((in_alone ? 1 : 2) * OutBeats - 1) : wait_left - 16'(wait_left != '0);
      out_left <= out_start ? 16'(OutBeats - 1) : out_left - 16'(out_left != '0);
    end
    if (rst | ~holds) begin
      wait_left <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
