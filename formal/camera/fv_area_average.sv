// SPDX-License-Identifier: Apache-2.0
// fv_area_average: a word leaves 12 enabled clocks behind each block that is complete, and 18 behind each break; it has
// the marks of its position, and a break ends a frame with the mark of a row's end the wrong way round.
//
// Whatever block_totals completes (`complete` is free): that it does so with a block's last pixel, and no break in the
// same slot, is proven of row_sums and block_totals, and of camera_window.

parameter int Rows = 3, Columns = 4;
localparam int Numerator = 1, Denominator = 1, Bits = 8, Bayer = 0;

assign allowed = 1'b1;

assign in_samples = '0;
assign in_colour = '0;
assign in_gains = '0;

localparam int Break = 18, Mean = 12;
logic complete;
logic [Break-1:0] breaks;
logic [Mean-1:0] means;
logic [$clog2(Rows*Columns)-1:0] place;  // words of the frame that have left
logic held;
assign complete = fv_area_average.dut.complete;
kept #(.Width(3)) u_kept (.clk, .rst, .en, .out({out_valid, out_last, out_user}), .held);
always_comb if (breaks[Break-Mean-1]) assume (!complete);
always_ff @(posedge clk) begin
  if (en) begin
    breaks <= {breaks[Break-2:0], in_abort};
    means <= {means[Mean-2:0], complete};
    if (breaks[Break-1]) place <= '0;
    else if (means[Mean-1]) place <= 32'(place) == Rows * Columns - 1 ? '0 : place + 1'b1;
  end
  if (rst) begin
    breaks <= '0;
    means <= '0;
    place <= '0;
  end
end

logic row_ends;
assign row_ends = 32'(place) % Columns == Columns - 1;
always_comb begin
  if (started) begin
    in_time: assert (out_valid == (means[Mean-1] | breaks[Break-1]));
    if (out_valid) begin
      start: assert (out_user == (place == '0));
      end_of_row: assert (out_last == (row_ends ^ breaks[Break-1]));
      broken_at_once: cover (breaks[Break-1] && out_user);
      broken_at_the_end: cover (breaks[Break-1] && !out_last && 32'(place) == Rows * Columns - 1);
      whole: cover (means[Mean-1] && 32'(place) == Rows * Columns - 1);
    end
  end
end

// Protocol: pixels of the window in raster order, from a frame's start on; a break comes without a pixel and ends
// its frame. The colours of the word that a break makes do not count.
module protocol_area_average;
  localparam int Across = (Columns * Numerator + Denominator - 1) / Denominator,
      Height = (Rows * Numerator + Denominator - 1) / Denominator;
  logic pixel_right, last_column, last_row;
  logic [15:0] row = '0, column = '0;
  logic [1:0] origin = '0;  // colour of the frame's first pixel
  logic [15:0] breaks = '0;
  assign last_column = column == 16'(Across - 1);
  assign last_row = row == 16'(Height - 1);
  assign pixel_right = (in_row_start == (column == '0)) & (in_frame_start == (column == '0 && row == '0))
      & (in_frame_start | in_colour == (origin ^ {row[0], column[0]}));
  assign holds = rst | (in_valid ? pixel_right & ~in_abort : 1'b1);
  always_ff @(posedge clk) begin
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
