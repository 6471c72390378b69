// SPDX-License-Identifier: Apache-2.0
// frame_output: side-band signals for the depth stream; frames marked bad do not leave.
//
// Stream in: bursts of Columns words, Rows of them a frame. in_bad belongs to the frame whose first word is present.
// Stream out: the words of good frames with user (first of a frame), last (last of a row), frame_end. Combinational.
// Bit-accurate model: models/frame_output.py.

module frame_output #(
  parameter int Width   = 24,
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_start,
  input  logic [Width-1:0] in_data,
  input  logic             in_bad,
  output logic             frame_start,  // the first word of a frame is present, good or bad
  output logic             frame_end,    // the last one
  output logic             out_valid,
  output logic [Width-1:0] out_data,
  output logic             out_last,
  output logic             out_user
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows);

  logic [ColumnWidth-1:0] column;
  logic [RowWidth-1:0] row;
  logic active, bad, bad_q;
  burst_counter #(.Size(Columns)) u_counter (
    .clk, .rst, .en, .start(in_start), .position(column), .active
  );

  assign frame_start = in_start & (row == '0);
  assign bad = frame_start ? in_bad : bad_q;
  assign out_last = column == ColumnWidth'(Columns - 1);
  assign out_user = frame_start;
  assign frame_end = active & out_last & (row == RowWidth'(Rows - 1));
  assign out_valid = active & ~bad;
  assign out_data = in_data;

  always_ff @(posedge clk) begin
    if (en) begin
      bad_q <= bad;
      if (active && out_last) row <= frame_end ? '0 : row + RowWidth'(1);
    end
    if (rst) row <= '0;
  end

endmodule
