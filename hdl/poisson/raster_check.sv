// SPDX-License-Identifier: Apache-2.0
// raster_check: whether positions are those of whole frames in raster order.
//
// `wrong` is high in the cycle after an enabled one whose position is not that of the pixel which is due. A start of a
// frame is taken as it is, due or not: the next pixels are due behind it. Bit-accurate model:
// models/tactile_depth/chip/poisson/raster_check.py.

`default_nettype none

module raster_check
  import td_types_pkg::*;
#(
  parameter int Rows    = 128,  // at least 2
  parameter int Columns = 128   // at least 2
) (
  input  wire            clk,
  input  wire            rst,
  input  wire            en,
  input  wire            in_valid,
  input  wire position_t in_position,
  output logic           wrong
);

  localparam int RowWidth = $clog2(Rows);
  localparam int ColumnWidth = $clog2(Columns);

  logic [RowWidth-1:0] row_due, row;  // of the pixel
  logic [ColumnWidth-1:0] column_due, column;
  position_t place;  // of what is due
  logic starts, row_ends;
  assign starts = in_position.first_row & in_position.first_column;
  assign row = starts ? '0 : row_due;
  assign column = starts ? '0 : column_due;
  assign row_ends = column == ColumnWidth'(Columns - 1);
  assign place.first_row = row_due == '0;
  assign place.first_column = column_due == '0;
  assign place.last_row = row_due == RowWidth'(Rows - 1);
  assign place.last_column = column_due == ColumnWidth'(Columns - 1);

  always_ff @(posedge clk) begin
    wrong <= en & in_valid & (in_position != place);
    if (en && in_valid) begin
      column_due <= row_ends ? '0 : column + ColumnWidth'(1);
      if (row_ends) row_due <= row == RowWidth'(Rows - 1) ? '0 : row + RowWidth'(1);
      else row_due <= row;
    end
    if (rst) {wrong, row_due, column_due} <= '0;
  end

endmodule

`default_nettype wire
