// SPDX-License-Identifier: Apache-2.0
// frame_guard: whatever arrives, only whole frames of Rows x Columns pixels leave.
//
//   fault                                        what happens to the frame
//   row_short      tlast before the last column  marked, filled up
//   row_long       no tlast in the last column   marked, filled up
//   start_early    tuser inside a frame          marked, filled up; the early start waits, then begins the next frame
//   timed_out      silence of `timeout` cycles   marked, filled up                           (timeout 0: wait for ever)
//   start_missing  no tuser where a frame begins dropped up to the next tuser
//
// A fault is high for one cycle, once for each broken frame. What is left of a broken frame on the input is dropped;
// the filler repeats the last pixel. The frame of a self-test (s_test) is marked too, and does not change `hunting`.
// Stream in: AXI4-Stream Video, ready/valid. Stream out: pixels in raster order; with the last of a frame
// out_frame_end, and out_bad if it is marked. Latency: 1 cycle; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/video/frame_guard.py.

`default_nettype none

module frame_guard
  import td_types_pkg::*;
#(
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  wire         clk,
  input  wire         rst,
  input  wire         en,
  input  wire  [31:0] timeout,   // cycles; counts a cycle later
  input  wire         s_valid,
  output logic        s_ready,
  input  wire  [23:0] s_data,    // three codes of 8 bits
  input  wire         s_last,
  input  wire         s_user,
  input  wire         s_test,    // the word is of a self-test
  output logic        between,     // no frame is open, nor filled up; from registers, as the next two
  output logic        row_ends,    // the pixel that is taken next is the last of a row
  output logic        frame_ends,  // .. of a frame
  output logic        out_valid,
  output logic [23:0] out_data,  // as s_data
  output position_t   out_position,
  output logic        out_frame_start,
  output logic        out_frame_end,
  output logic        out_bad,   // with out_frame_end: the frame was malformed, or of a self-test
  output logic        out_test,  // with out_frame_end: the frame was of a self-test
  output faults_t     faults,    // each for one cycle
  output logic        hunting    // words are dropped up to the next start of frame
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows);

  logic [ColumnWidth-1:0] column;
  logic [RowWidth-1:0] row;
  position_t place;  // of the pixel that comes, as row and column: in registers, since s_ready depends on it
  logic [31:0] silence;  // cycles of it, this one too
  logic silent, expired;  // expired: before this cycle
  logic filling;  // completing a broken frame

  logic origin, take, emit;
  logic row_short, row_long, start_missing, start_early, timed_out, fault_in_frame;
  assign origin = place.first_column & place.first_row;
  assign row_ends = place.last_column;
  assign frame_ends = row_ends & place.last_row;

  // A start of frame is taken only where a frame begins; all else is taken at once, as a pixel or to be dropped.
  logic accept;
  assign accept = between | ~s_user;
  assign s_ready = en & accept;
  assign take = s_valid & accept & ~filling & (~origin | s_user);  // this word is a pixel

  assign row_short = en & take & s_last & ~row_ends;
  assign row_long = en & take & ~s_last & row_ends;
  assign start_missing = en & s_valid & between & ~s_user & ~hunting;
  assign start_early = en & s_valid & ~origin & ~filling & s_user;
  assign silent = ~s_valid & ~origin & ~filling;
  assign timed_out = en & silent & expired;
  assign fault_in_frame = row_short | row_long | start_early | timed_out;
  assign faults.timed_out = timed_out;
  assign faults.start_early = start_early;
  assign faults.start_missing = start_missing;
  assign faults.row_long = row_long;
  assign faults.row_short = row_short;
  assign emit = take | filling;

  always_ff @(posedge clk) begin
    if (en) begin
      out_valid <= emit;
      if (take) out_data <= s_data;
      out_position <= place;
      out_frame_start <= take & origin;
      out_frame_end <= emit & frame_ends;
      out_bad <= filling | row_long | s_test;  // at the end of a frame nothing else can be wrong
      out_test <= s_test;
      if (emit) begin
        between <= frame_ends;
        column <= row_ends ? '0 : column + ColumnWidth'(1);
        place.first_column <= row_ends;
        place.last_column <= ~row_ends & (column == ColumnWidth'(Columns - 2));
        if (row_ends) begin
          row <= frame_ends ? '0 : row + RowWidth'(1);
          place.first_row <= frame_ends;
          place.last_row <= ~frame_ends & (row == RowWidth'(Rows - 2));
        end
      end
      silence <= silent ? silence + 32'd1 : 32'd1;
      expired <= silent & (timeout != '0) & (silence >= timeout);
      filling <= (filling | fault_in_frame) & ~(emit & frame_ends);
      if (s_test) hunting <= hunting;
      else if (emit & frame_ends) hunting <= filling | row_long;
      else if (start_missing) hunting <= 1'b1;
      else if (take) hunting <= 1'b0;
    end
    if (rst) begin
      out_valid <= 1'b0;
      out_frame_start <= 1'b0;
      out_frame_end <= 1'b0;
      between <= 1'b1;
      column <= '0;
      row <= '0;
      {place.first_column, place.first_row, place.last_column, place.last_row} <= 4'b1100;
      silence <= 32'd1;
      expired <= 1'b0;
      filling <= 1'b0;
      hunting <= 1'b0;
    end
  end

endmodule

`default_nettype wire
