// SPDX-License-Identifier: Apache-2.0
// raster_counter: where the next pixel is, in raster order and whole frames but for a reset.

`default_nettype none

module raster_counter #(
  parameter int Rows    = 4,
  parameter int Columns = 4
) (
  input  logic       clk,
  input  logic       rst,
  input  logic       en,
  input  logic       in_valid,
  output logic [3:0] row,
  output logic [3:0] column,
  output logic [3:0] position  // in the last column, last row, first column, first row
);

  logic last_column, last_row;
  assign last_column = column == 4'(Columns - 1);
  assign last_row = row == 4'(Rows - 1);
  assign position = {last_column, last_row, column == '0, row == '0};
  always_ff @(posedge clk) begin
    if (en && in_valid) begin
      column <= last_column ? '0 : column + 4'd1;
      if (last_column) row <= last_row ? '0 : row + 4'd1;
    end
    if (rst) begin
      row <= '0;
      column <= '0;
    end
  end

endmodule

`default_nettype wire
