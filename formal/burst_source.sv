// SPDX-License-Identifier: Apache-2.0
// burst_source: every legal stream of bursts, for a bench: Columns words in successive enabled clocks, Rows bursts a
// frame, any gaps between bursts. It takes its choices from free inputs, so a bench needs no assumptions about its
// stream.
//
// `restart` lets a frame begin before the last one is whole, as behind an upset. A frame is whole once its last burst
// begins.

`default_nettype none

module burst_source #(
  parameter int Columns = 8,
  parameter int Rows    = 4,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     go,       // begin a burst, if none is present
  input  logic                     restart,  // and a frame with it
  output logic                     start,
  output logic                     frame_start,
  output logic                     active,
  output logic [PositionWidth-1:0] position,
  output logic [RowWidth-1:0]      row,
  output logic                     last_row
);

  logic [PositionWidth:0] left;  // words of the burst after this clock's
  logic [RowWidth-1:0] next_row, row_q;
  assign start = go & (left == '0);
  assign frame_start = start & (restart | (next_row == '0));
  assign active = start | (left != '0);
  assign position = start ? '0 : PositionWidth'((PositionWidth + 1)'(Columns) - left);
  assign row = !start ? row_q : frame_start ? '0 : next_row;
  assign last_row = row == RowWidth'(Rows - 1);

  always_ff @(posedge clk) begin
    if (en) begin
      if (start) begin
        left <= (PositionWidth + 1)'(Columns - 1);
        row_q <= row;
        next_row <= last_row ? '0 : row + RowWidth'(1);
      end else if (left != '0) begin
        left <= left - (PositionWidth + 1)'(1);
      end
    end
    if (rst) begin
      left <= '0;
      next_row <= '0;
    end
  end

endmodule

`default_nettype wire
