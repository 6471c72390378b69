// SPDX-License-Identifier: Apache-2.0
// camera_window: the pixels of whole pictures, those of a window marked; a malformed picture ends in out_abort.
//
//   fault           what arrives                             what happens to the picture
//   row_short       tlast before the last column             broken
//   row_long        no tlast in the last column              broken
//   start_early     tuser inside a picture                   broken; the early start waits a cycle, then begins another
//   start_missing   no tuser where a picture begins          dropped up to the next tuser
//   window_outside  the window is not inside the picture     dropped up to the next tuser
//
// Each fault is one cycle of its output, once for a broken picture, and out_abort follows in place of a pixel. What is
// left of a broken picture is dropped. Faults behind the last pixel of the window harm nothing: they are not flagged.
// A picture has the settings of the cycle before its start: columns, rows, and the window's first column x and row y.
// Stream in: AXI4-Stream Video, WordsPerPixel words for a pixel, of which the lowest bytes are then put together, the
// first below. PixelPairs 1: the other pixel of a pair that the window cuts counts as one of the window's.
// Stream out: pixels of the picture in raster order, out_inside with those of the window, their marks, and whether row
// and column are odd. Latency: 1 cycle; en low: nothing moves. Model:
// models/tactile_depth/chip/camera/camera_window.py.

`default_nettype none

module camera_window #(
  parameter int WindowColumns = 480,
  parameter int WindowRows    = 480,
  parameter int WordsPerPixel = 1,
  parameter int PixelPairs    = 0,
  parameter int CountWidth    = 13  // of the numbers of columns and rows
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  en,
  input  wire [CountWidth-1:0] columns,
  input  wire [CountWidth-1:0] rows,
  input  wire [CountWidth-1:0] window_x,
  input  wire [CountWidth-1:0] window_y,
  input  wire                  s_valid,
  output logic                 s_ready,
  input  wire [23:0]           s_data,
  input  wire                  s_last,
  input  wire                  s_user,
  output logic                 out_valid,
  output logic [23:0]          out_data,
  output logic                 out_inside,
  output logic                 out_odd_row,
  output logic                 out_odd_column,
  output logic                 out_row_start,
  output logic                 out_frame_start,
  output logic                 out_abort,
  output logic                 row_short,
  output logic                 row_long,
  output logic                 start_missing,
  output logic                 start_early,
  output logic                 window_outside,
  output logic                 hunting  // words up to the next start are dropped and not flagged
);

  localparam logic [CountWidth:0] Width = (CountWidth + 1)'($unsigned(WindowColumns));
  localparam logic [CountWidth:0] Height = (CountWidth + 1)'($unsigned(WindowRows));

  // Settings of a picture that starts now, and of the present one. The window ends with column `right`, row `bottom`.

  logic [CountWidth-1:0] next_last_column, next_last_row, next_x, next_y, next_right, next_bottom;
  logic [CountWidth-1:0] last_column, last_row, x, y, right, bottom;
  logic [CountWidth-1:0] last_column_q, last_row_q, x_q, y_q, right_q, bottom_q;
  logic [CountWidth:0] usable_columns;
  logic outside;
  assign usable_columns = PixelPairs != 0 ? {1'b0, columns[CountWidth-1:1], 1'b0} : {1'b0, columns};
  always_ff @(posedge clk) begin
    next_last_column <= columns - CountWidth'(1);
    next_last_row <= rows - CountWidth'(1);
    next_x <= window_x;
    next_y <= window_y;
    next_right <= window_x + CountWidth'(Width - 1);
    next_bottom <= window_y + CountWidth'(Height - 1);
    outside <= {1'b0, window_x} + Width > usable_columns | {1'b0, window_y} + Height > {1'b0, rows};
  end

  logic open;     // inside a picture
  logic passed;   // the window's last pixel was taken
  logic half;     // the first byte of a pixel was taken
  logic [CountWidth-1:0] column, row;  // of the pixel that comes next; 0 between pictures
  assign last_column = open ? last_column_q : next_last_column;
  assign last_row = open ? last_row_q : next_last_row;
  assign x = open ? x_q : next_x;
  assign y = open ? y_q : next_y;
  assign right = open ? right_q : next_right;
  assign bottom = open ? bottom_q : next_bottom;

  // A start is taken only where a picture begins; all else is taken at once, as a word of a picture or to be dropped.
  logic starts, accept, word, pixel_ends, row_ends, misplaced, early, needed_last, fault;
  logic [CountWidth-1:0] needed_right;
  assign accept = ~open | ~s_user;
  assign s_ready = en & accept;
  assign starts = s_valid & ~open & s_user;
  assign word = s_valid & (open ^ s_user);
  assign pixel_ends = WordsPerPixel == 1 | half;
  assign row_ends = pixel_ends & column == last_column;
  assign misplaced = word & s_last != row_ends;
  assign early = s_valid & open & s_user;
  assign needed_right = PixelPairs != 0 ? {right[CountWidth-1:1], 1'b1} : right;
  assign needed_last = pixel_ends & column == needed_right & row == bottom;

  assign window_outside = en & starts & outside;
  assign row_short = en & misplaced & s_last & ~passed & ~window_outside;
  assign row_long = en & misplaced & ~s_last & ~passed & ~window_outside;
  assign start_early = en & early & ~passed;
  assign start_missing = en & s_valid & ~open & ~s_user & ~hunting;
  assign fault = row_short | row_long | start_early | start_missing | window_outside;

  always_ff @(posedge clk) begin
    if (en) begin
      out_valid <= word & pixel_ends & ~misplaced & ~window_outside;
      out_inside <= column >= x & column <= right & row >= y & row <= bottom;
      out_odd_row <= row[0];
      out_odd_column <= column[0];
      out_row_start <= column == x;
      out_frame_start <= column == x & row == y;
      out_abort <= fault;
      last_column_q <= last_column;
      last_row_q <= last_row;
      x_q <= x;
      y_q <= y;
      right_q <= right;
      bottom_q <= bottom;

      if (word) begin
        open <= 1'b1;
        hunting <= 1'b0;
        half <= ~pixel_ends;
        passed <= passed | needed_last;
        if (pixel_ends) column <= row_ends ? '0 : column + CountWidth'(1);
        if (row_ends) row <= row + CountWidth'(1);
      end
      if (start_missing) hunting <= 1'b1;
      if (misplaced | early | window_outside) hunting <= 1'b1;
      if (misplaced | early | window_outside | (word & row_ends & row == last_row)) begin
        open <= 1'b0;
        half <= 1'b0;
        passed <= 1'b0;
        column <= '0;
        row <= '0;
      end
    end
    if (rst) {out_valid, out_abort, open, hunting, half, passed, column, row} <= '0;
  end

  if (WordsPerPixel == 1) begin : g_word
    always_ff @(posedge clk) if (en) out_data <= s_data;
  end else begin : g_bytes
    logic [7:0] first;
    always_ff @(posedge clk) begin
      if (en) begin
        if (word) first <= s_data[7:0];
        if (pixel_ends) out_data <= {8'd0, s_data[7:0], first};
      end
    end
  end

endmodule

`default_nettype wire
