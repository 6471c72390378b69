// SPDX-License-Identifier: Apache-2.0
// raster_places: the place of each pixel of whole frames in raster order; only a reset cuts a frame short.

`default_nettype none

module raster_places #(
  parameter int Rows    = 4,
  parameter int Columns = 4
) (
  input  logic        clk,
  input  logic        reset,
  input  logic        en,
  input  logic        in_valid,
  output logic [15:0] row,
  output logic [15:0] column,
  output logic [3:0]  place    // in the last column, last row, first column, first row
);

  logic [$clog2(Rows+1)-1:0] at_row = '0;
  logic [$clog2(Columns+1)-1:0] at_column = '0;
  assign {row, column} = {16'(at_row), 16'(at_column)};
  assign place = {column == 16'(Columns - 1), row == 16'(Rows - 1), column == '0, row == '0};
  always_ff @(posedge clk) begin
    if (en && in_valid) begin
      at_column <= place[3] ? '0 : at_column + 1'd1;
      if (place[3]) at_row <= place[2] ? '0 : at_row + 1'd1;
    end
    if (reset) {at_row, at_column} <= '0;
  end

endmodule

`default_nettype wire
