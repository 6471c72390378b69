// SPDX-License-Identifier: Apache-2.0
// contact_peak: count and peak of the depths above the threshold, once a frame.
//
//   above = as in_above says while not touching; a depth greater than off_threshold while touching
//
// Stream in: depth codes that are never held back, Lanes neighbours in a beat with the first in the lowest bits, in
// raster order or, BottomFirst, bottom row first. A frame that begins inside another begins afresh. off_threshold is
// read with each beat. `touching` is read in the cycle of count_valid at the earliest, so it may be decided in that
// cycle from `count`. Latency: count_valid comes 2 cycles after the last beat of a frame, peak_valid 3 + log2(Lanes);
// `count` and the peak are those of the frame in that cycle alone. Gaps change nothing.
// Bit-accurate model: models/tactile_depth/chip/contact/contact_peak.py.

`default_nettype none

module contact_peak
  import td_types_pkg::*;
#(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Lanes       = 1,  // depths in a beat
  parameter int BottomFirst = 0,  // 1: the bottom row comes first
  localparam int CountWidth = $clog2(Rows * Columns + 1)
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     in_valid,
  input  wire depth_position_t    in_position,
  input  wire  [Lanes*Width-1:0]  in_data,        // depth codes, signed
  input  wire  [Lanes-1:0]        in_above,       // depths of the beat above a threshold
  input  wire  signed [Width:0]   off_threshold,  // depth code
  input  wire                     touching,       // the threshold in force is off_threshold
  output logic                    count_valid,
  output logic [CountWidth-1:0]   count,          // depths above
  output logic                    peak_valid,
  output logic                    any_above,
  output logic signed [Width-1:0] peak,           // depth code; 0 with nothing above, as the position
  output logic [15:0]             peak_row,       // from the top of the picture; of equal peaks the first
  output logic [15:0]             peak_column
);

  localparam int RowWidth = $clog2(Rows);
  localparam int ColumnWidth = $clog2(Columns);
  localparam int OffsetWidth = Lanes > 1 ? $clog2(Lanes) : 1;  // of a depth in its beat
  localparam int BeatWidth = $clog2(Lanes + 1);
  localparam int PeakDelay = $clog2(Lanes) + 1;  // cycles from the comparison to the peak of a beat

  function automatic logic [BeatWidth-1:0] ones(input logic [Lanes-1:0] bits);
    ones = '0;
    for (int lane = 0; lane < Lanes; lane++) ones = ones + BeatWidth'(bits[lane]);
  endfunction

  // Row and first column of each beat, and which of its depths are above either threshold.

  logic frame_start;
  logic [ColumnWidth-1:0] column, next_column, column_q;
  logic [RowWidth-1:0] row, next_row, row_q;
  assign frame_start = in_position.frame_start;
  assign column = frame_start ? '0 : next_column;
  assign row = ~frame_start ? next_row : BottomFirst != 0 ? RowWidth'(Rows - 1) : '0;

  logic [1:0][Lanes*Width-1:0] data_q;
  logic [Lanes-1:0] above_on, above_off;
  logic valid_q, frame_start_q, frame_end_q;
  always_ff @(posedge clk) begin
    if (in_valid) begin
      next_column <= in_position.row_end ? '0 : column + ColumnWidth'(Lanes);
      next_row <= ~in_position.row_end ? row : BottomFirst != 0 ? row - RowWidth'(1) : row + RowWidth'(1);
    end
    column_q <= column;
    row_q <= row;
    data_q <= {data_q[0], in_data};
    above_on <= in_above;
    valid_q <= in_valid;
    frame_start_q <= frame_start;
    frame_end_q <= in_position.frame_end;
    if (rst) valid_q <= 1'b0;
  end
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] depth;
    assign depth = in_data[lane*Width+:Width];
    always_ff @(posedge clk) above_off[lane] <= (Width + 1)'(depth) > off_threshold;
  end

  // Count. The first beat of the next frame may be here in the cycle of count_valid. `touching` comes late, from the
  // count itself: it chooses behind the sums.

  logic [CountWidth-1:0] count_before, count_on, count_off;
  logic [PeakDelay-1:0] valid_delayed, start_delayed, end_delayed, above_delayed;  // a depth is above
  logic [PeakDelay-1:0][ColumnWidth-1:0] column_delayed;
  logic [PeakDelay-1:0][RowWidth-1:0] row_delayed;
  assign count_before = frame_start_q ? '0 : count;
  assign count_on = count_before + CountWidth'(ones(above_on));
  assign count_off = count_before + CountWidth'(ones(above_off));
  always_ff @(posedge clk) begin
    if (valid_q) count <= touching ? count_off : count_on;
    column_delayed <= (PeakDelay * ColumnWidth)'({column_delayed, column_q});
    row_delayed <= (PeakDelay * RowWidth)'({row_delayed, row_q});
    valid_delayed <= PeakDelay'({valid_delayed, valid_q});
    start_delayed <= PeakDelay'({start_delayed, frame_start_q});
    end_delayed <= PeakDelay'({end_delayed, valid_q & frame_end_q});
    above_delayed <= PeakDelay'({above_delayed, touching ? above_off != '0 : above_on != '0});
    peak_valid <= end_delayed[PeakDelay-1];
    if (rst) begin
      valid_delayed <= '0;
      end_delayed <= '0;
      peak_valid <= 1'b0;
    end
  end
  assign count_valid = end_delayed[0];

  // Peak of a beat: for one lane its depth. It is above if any depth of the beat is.

  logic any_in_beat;
  logic signed [Width-1:0] highest_in_beat;
  logic [ColumnWidth-1:0] first_column, column_in_beat;
  assign any_in_beat = above_delayed[PeakDelay-1];
  assign first_column = column_delayed[PeakDelay-1];
  if (Lanes == 1) begin : g_one_lane
    assign highest_in_beat = data_q[1];
    assign column_in_beat = first_column;
  end else begin : g_lanes
    logic [OffsetWidth-1:0] peak_offset;
    beat_peak #(.Width(Width), .Lanes(Lanes)) u_beat (
      .clk, .data(data_q[1]), .peak(highest_in_beat), .peak_offset
    );
    assign column_in_beat = first_column + ColumnWidth'(peak_offset);
  end

  // Peak of the frame.

  logic signed [Width-1:0] highest;
  logic [RowWidth-1:0] highest_row;
  logic [ColumnWidth-1:0] highest_column;
  logic first_above;  // this beat would be the first with a depth above
  assign first_above = start_delayed[PeakDelay-1] | ~any_above;
  always_ff @(posedge clk) begin
    if (valid_delayed[PeakDelay-1]) begin
      any_above <= any_in_beat | ~first_above;
      if (any_in_beat && (first_above || highest_in_beat > highest)) begin
        highest <= highest_in_beat;
        {highest_row, highest_column} <= {row_delayed[PeakDelay-1], column_in_beat};
      end
    end
  end
  assign peak = any_above ? highest : '0;
  assign peak_row = any_above ? 16'(highest_row) : '0;
  assign peak_column = any_above ? 16'(highest_column) : '0;

endmodule

`default_nettype wire
