// SPDX-License-Identifier: Apache-2.0
// protocol_area_average: pixels of the window in raster order, from a frame's start on; a break comes without a pixel and
// ends its frame. The colours of the word that a break makes do not count.

`default_nettype none

module protocol_area_average #(
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Numerator   = 15,
  parameter int Denominator = 4
) (
  input  logic       clk,
  input  logic       rst,
  input  logic       en,
  input  logic       in_valid,
  input  logic [1:0] in_colour,
  input  logic       in_row_start,
  input  logic       in_frame_start,
  input  logic       in_abort,
  input  logic       out_valid,
  output logic       holds,
  output logic       counts_out_valid,
  output logic       counts_out_last,
  output logic       counts_out_user,
  output logic       counts_out_pixel
);

  localparam int Width = (Columns * Numerator + Denominator - 1) / Denominator;  // of the window
  localparam int Height = (Rows * Numerator + Denominator - 1) / Denominator;
  logic reset, live = 1'b0, pixel_right, last_column, last_row;
  logic [15:0] row = '0, column = '0;
  logic [1:0] origin = '0;  // colour of the frame's first pixel
  logic [15:0] breaks = '0;
  assign last_column = column == 16'(Width - 1);
  assign last_row = row == 16'(Height - 1);
  assign pixel_right = (in_row_start == (column == '0)) & (in_frame_start == (column == '0 && row == '0))
      & (in_frame_start | in_colour == (origin ^ {row[0], column[0]}));
  assign holds = rst | (in_valid ? pixel_right & ~in_abort : 1'b1);
  assign reset = rst | ~holds;
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      breaks <= {breaks[14:0], in_abort};
      if (in_valid) begin
        if (in_frame_start) origin <= in_colour;
        column <= last_column ? '0 : column + 16'd1;
        if (last_column) row <= last_row ? '0 : row + 16'd1;
      end
      if (in_abort) begin
        column <= '0;
        row <= '0;
      end
    end
    if (reset) begin
      column <= '0;
      row <= '0;
      breaks <= '0;
    end
  end
  assign counts_out_valid = live & ~reset;
  assign {counts_out_last, counts_out_user} = {2{counts_out_valid & out_valid}};
  assign counts_out_pixel = counts_out_valid & out_valid & ~breaks[15];

endmodule

`default_nettype wire
