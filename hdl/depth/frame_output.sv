// SPDX-License-Identifier: Apache-2.0
// frame_output: gives depth its position; frames that are malformed, or not where they are due, do not leave.
//
// Stream in: bursts of Columns words, Rows of them a frame, one after another. in_due: now a frame's first word is due;
// in_bad belongs to that frame. Stream out: the words of good frames, each with its position. Positions count from
// in_due, so a frame has its form whatever comes in; where bursts and frames do not begin as they should, out_of_step
// is high. Latency: 0 cycles. Bit-accurate model: models/tactile_depth/chip/depth/frame_output.py.

`default_nettype none

module frame_output
  import td_types_pkg::*;
#(
  parameter int Width   = 24,
  parameter int Rows    = 128,
  parameter int Columns = 128  // a power of two
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              en,
  input  wire              in_start,
  input  wire              in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Width-1:0] in_data,         // depth code
  input  wire              in_due,
  input  wire              in_bad,
  output logic             active,          // a word of a frame is present, good or bad
  output logic             out_of_step,
  output logic             out_valid,
  output depth_position_t  out_position,    // of bad frames too; 0 between frames
  output logic [Width-1:0] out_data         // depth code
);

  localparam int Pixels = Rows * Columns;
  localparam int ColumnWidth = $clog2(Columns);
  localparam int PositionWidth = $clog2(Pixels);

  logic [PositionWidth-1:0] position;
  logic bad, bad_q, row_due;
  td_burst_counter #(.Words(Pixels)) u_counter (
    .clk, .rst, .en, .start(in_due), .position, .active
  );

  assign row_due = active & (position[ColumnWidth-1:0] == '0);
  assign out_of_step = (in_frame_start != in_due) | (in_start != row_due);

  assign bad = in_due ? in_bad | ~in_frame_start : bad_q;
  assign out_valid = active & ~bad;
  assign out_data = in_data;
  assign out_position.frame_start = active & in_due;
  assign out_position.row_end = active & position[ColumnWidth-1:0] == ColumnWidth'(Columns - 1);
  assign out_position.frame_end = active & position == PositionWidth'(Pixels - 1);

  always_ff @(posedge clk) if (en) bad_q <= bad;

endmodule

`default_nettype wire
