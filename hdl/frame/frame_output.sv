// SPDX-License-Identifier: Apache-2.0
// frame_output: side-band signals for the depth stream; frames that are bad, or not where they are due, do not leave.
//
// Stream in: bursts of Columns words, Rows of them a frame, one after another. in_due: now a frame's first word is due;
// in_bad belongs to that frame. Stream out: the words of good frames with user (first of a frame), last (last of a
// row). The side-bands count from in_due, so a frame has its form whatever comes in; where bursts and frames do not
// begin as they should, out_of_step is high. Combinational. Bit-accurate model:
// models/tactile_depth/frame/frame_output.py.

module frame_output #(
  parameter int Width   = 24,
  parameter int Rows    = 128,
  parameter int Columns = 128  // a power of two
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_start,
  input  logic             in_frame_start,  // with in_start: the first burst of a frame
  input  logic [Width-1:0] in_data,
  input  logic             in_due,
  input  logic             in_bad,
  output logic             active,          // a word of a frame is present, good or bad
  output logic             frame_end,       // the last one
  output logic             out_of_step,
  output logic             out_valid,
  output logic [Width-1:0] out_data,
  output logic             out_last,
  output logic             out_user
);

  localparam int Pixels = Rows * Columns;
  localparam int ColumnWidth = $clog2(Columns);
  localparam int PositionWidth = $clog2(Pixels);

  logic [PositionWidth-1:0] position;
  logic bad, bad_q, row_due;
  burst_counter #(.Size(Pixels)) u_counter (
    .clk, .rst, .en, .start(in_due), .position, .active
  );

  assign row_due = active & (position[ColumnWidth-1:0] == '0);
  assign out_of_step = (in_frame_start != in_due) | (in_start != row_due);

  assign bad = in_due ? in_bad | ~in_frame_start : bad_q;
  assign frame_end = active & (position == PositionWidth'(Pixels - 1));
  assign out_valid = active & ~bad;
  assign out_data = in_data;
  assign out_last = position[ColumnWidth-1:0] == ColumnWidth'(Columns - 1);
  assign out_user = in_due;

  always_ff @(posedge clk) if (en) bad_q <= bad;

`ifndef SYNTHESIS
  initial begin
    if (Rows < 2) $fatal(1, "%m: Rows must be at least 2");
    if (Columns < 2 || Columns != (1 << $clog2(Columns))) $fatal(1, "%m: Columns must be a power of two, at least 2");
  end
`endif

endmodule
