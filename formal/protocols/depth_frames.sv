// SPDX-License-Identifier: Apache-2.0
// depth_frames: rows of Columns depths, Rows of them in a frame.
//
// A frame may begin inside another; none but the first after a reset may lack its start.

`default_nettype none

module depth_frames #(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  localparam int PlaceWidth = $clog2(Rows * Columns),
  localparam int ColumnWidth = $clog2(Columns)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  reset,
  input  logic                  in_valid,
  input  logic [2:0]            in_position,  // frame_start, row_end, frame_end
  output logic [PlaceWidth-1:0] place,
  output logic                  holds
);

  logic frame_start, row_end, frame_end;
  logic [PlaceWidth-1:0] next_place = '0;  // of the next depth; 0: the first of a frame
  logic [ColumnWidth-1:0] next_column = '0, column;
  assign {frame_start, row_end, frame_end} = in_position;
  assign place = frame_start ? '0 : next_place;
  assign column = frame_start ? '0 : next_column;
  assign holds = ~in_valid | rst | ((frame_start | next_place != '0)
      & (row_end == (column == ColumnWidth'(Columns - 1))) & (frame_end == (place == PlaceWidth'(Rows * Columns - 1))));
  always_ff @(posedge clk) begin
    if (reset) begin
      next_place <= '0;
    end else if (in_valid) begin
      next_place <= frame_end ? '0 : place + PlaceWidth'(1);
      next_column <= row_end ? '0 : column + ColumnWidth'(1);
    end
  end

endmodule

`default_nettype wire
