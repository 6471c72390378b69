// SPDX-License-Identifier: Apache-2.0
// lane_places: where the words of each lane are, in bursts of Columns words that begin with `start`, the rows of a frame
// in the lanes in turn.

`default_nettype none

module lane_places #(
  parameter int Columns  = 16,
  parameter int Lanes    = 2,
  parameter int RowWidth = 2,
  localparam int PositionWidth = $clog2(Columns)
) (
  input  logic                           clk,
  input  logic                           reset,
  input  logic                           en,
  input  logic [Lanes-1:0]               start,
  input  logic                           frame_start,
  output logic [Lanes-1:0]               active,
  output logic [Lanes*PositionWidth-1:0] position,
  output logic [Lanes*RowWidth-1:0]      row       // of the frame, counted as they come, up to the largest number
);

  logic [RowWidth-1:0] next_row = '0, begins;
  assign begins = frame_start ? '0 : next_row;
  always_ff @(posedge clk) begin
    if (en && start != '0) next_row <= begins + RowWidth'(begins != '1);
    if (reset) next_row <= '0;
  end

  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic [PositionWidth:0] left = '0;  // words of the burst after this clock's
    logic [RowWidth-1:0] row_q;
    assign active[lane] = start[lane] | left != '0;
    assign position[lane*PositionWidth+:PositionWidth]
        = start[lane] ? '0 : PositionWidth'((PositionWidth + 1)'(Columns) - left);
    assign row[lane*RowWidth+:RowWidth] = start[lane] ? begins : row_q;
    always_ff @(posedge clk) begin
      if (en) left <= start[lane] ? (PositionWidth + 1)'(Columns - 1) : left - (PositionWidth + 1)'(left != '0);
      if (en && start[lane]) row_q <= begins;
      if (reset) left <= '0;
    end
  end

endmodule

`default_nettype wire
