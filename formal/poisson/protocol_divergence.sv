// SPDX-License-Identifier: Apache-2.0
// protocol_divergence: pixels in raster order, in a reset too; how many rows a frame has is left open.

`default_nettype none

module protocol_divergence #(
  parameter int Columns = 128,
  localparam int ColumnWidth = $clog2(Columns)
) (
  input  logic                   clk,
  input  logic                   rst,
  input  logic                   en,
  input  logic                   in_valid,
  input  logic [3:0]             in_position,  // in the last column, last row, first column, first row
  input  logic                   out_valid,
  output logic                   holds,
  output logic [ColumnWidth-1:0] column,
  output logic                   counts_out_valid,
  output logic                   counts_out_frame_start,
  output logic                   counts_out_data
);

  logic reset, live = 1'b0, first_row = 1'b1, last_row_before, marks_right;
  logic in_first_row, in_first_column, in_last_row, in_last_column;
  assign {in_last_column, in_last_row, in_first_column, in_first_row} = in_position;
  assign reset = rst | ~holds;
  assign marks_right = (in_first_column == (column == '0)) & (in_last_column == (column == ColumnWidth'(Columns - 1)))
      & (in_first_row == first_row) & (column == '0 | in_last_row == last_row_before);
  assign holds = ~in_valid | marks_right;
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (reset) begin
      column <= '0;
      first_row <= 1'b1;
    end else if (en && in_valid) begin
      column <= in_last_column ? '0 : column + ColumnWidth'(1);
      if (in_last_column) first_row <= in_last_row;
      last_row_before <= in_last_row;
    end
  end
  assign {counts_out_valid, counts_out_frame_start} = {2{live & ~reset & en}};
  assign counts_out_data = counts_out_valid & out_valid;

endmodule

`default_nettype wire
