// SPDX-License-Identifier: Apache-2.0
// lane_source: every legal stream of lanes, for a bench: frames of Rows bursts of Columns words, row b in lane b mod
// Lanes, each Columns / Lanes clocks behind the row before. At least as many clocks lie between two frames, and any
// gaps.

`default_nettype none

module lane_source #(
  parameter int Columns = 16,
  parameter int Rows    = 3,
  parameter int Lanes   = 2,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input  logic                           clk,
  input  logic                           rst,
  input  logic                           en,
  input  logic                           go,  // begin a frame, if none is present
  output logic [Lanes-1:0]               start,
  output logic [Lanes-1:0]               frame_start,  // with start: the first burst of a frame in this lane
  output logic [Lanes-1:0]               active,
  output logic [Lanes*PositionWidth-1:0] position,
  output logic [Lanes*RowWidth-1:0]      row           // of the frame, counted as they come
);

  localparam int Step = Columns / Lanes;
  localparam int Length = (Rows - 1) * Step + Columns + Step;  // to the earliest start of the next frame
  localparam int TimeWidth = $clog2(Length + 1);

  logic [TimeWidth-1:0] left, now;
  logic present;
  assign present = go | (left != '0);
  assign now = left == '0 ? '0 : TimeWidth'(Length) - left;

  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic [TimeWidth-1:0] since;
    logic [31:0] burst;
    assign since = now - TimeWidth'(lane * Step);
    assign burst = 32'(since) / Columns * Lanes + lane;
    assign active[lane] = present && 32'(now) >= lane * Step && burst < Rows;
    assign position[lane*PositionWidth+:PositionWidth] = PositionWidth'(since % TimeWidth'(Columns));
    assign row[lane*RowWidth+:RowWidth] = RowWidth'(burst);
    assign start[lane] = active[lane] && position[lane*PositionWidth+:PositionWidth] == '0;
    assign frame_start[lane] = start[lane] && burst == lane;
  end

  always_ff @(posedge clk) begin
    if (en && present) left <= left == '0 ? TimeWidth'(Length - 1) : left - TimeWidth'(1);
    if (rst) left <= '0;
  end

endmodule

`default_nettype wire
