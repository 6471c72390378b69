// SPDX-License-Identifier: Apache-2.0
// contact_sums: area, limits, weight and moments of the depths above a threshold, once a frame.
//
//   weight of a depth = what it is above the threshold
//   moment = sum of each weight times its distance from the last row, or the last column, in pixels
//
// No multiplier: the weight so far, added at the end of each row, makes the moment of rows; within a row the same makes
// that of columns. Stream in: depth codes that are never held back, Lanes neighbours in a beat with the first in the
// lowest bits. The last row is the last to come. A frame that begins inside another begins afresh. The threshold is
// taken with a frame's first beat. A row has two beats or more. Latency: sums_valid comes 2 + log2(Lanes) cycles after
// the last beat of a frame; `sums` are those of the frame from that cycle until the next, limits in that cycle alone.
// Gaps change nothing.
// Bit-accurate model: models/tactile_depth/chip/contact/contact_sums.py.

`default_nettype none

module contact_sums
  import td_types_pkg::*;
#(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Lanes       = 1,  // depths in a beat
  parameter int BottomFirst = 0   // 1: the bottom row comes first
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     in_valid,
  input  wire depth_position_t    in_position,
  input  wire  [Lanes*Width-1:0]  in_data,     // depth codes, signed
  input  wire  signed [Width-1:0] threshold,   // depth code
  output logic                    sums_valid,
  output contact_sums_t           sums
);

  localparam int RowWidth = $clog2(Rows);
  localparam int ColumnWidth = $clog2(Columns);
  localparam int LanesLog2 = $clog2(Lanes);
  localparam int AreaWidth = $clog2(Rows * Columns + 1);
  localparam int RowWeightWidth = Width + ColumnWidth;
  localparam int WeightWidth = Width + $clog2(Rows * Columns);
  localparam int RowMomentWidth = WeightWidth + RowWidth;
  localparam int ColumnMomentWidth = WeightWidth + ColumnWidth;

  localparam int OffsetWidth = Lanes > 1 ? LanesLog2 : 1;  // of a depth in its beat
  localparam int CountWidth = $clog2(Lanes + 1);
  localparam int BeatWeightWidth = Width + LanesLog2;
  localparam int Delay = LanesLog2 + 1;  // cycles from a beat to its sums

  // Row and first column of each beat, and the weight of its depths.

  logic frame_start;
  logic [ColumnWidth-1:0] column, next_column;
  logic [RowWidth-1:0] row, next_row;
  logic signed [Width-1:0] threshold_q, threshold_now;
  assign frame_start = in_position.frame_start;
  assign column = frame_start ? '0 : next_column;
  assign row = ~frame_start ? next_row : BottomFirst != 0 ? RowWidth'(Rows - 1) : '0;
  assign threshold_now = frame_start ? threshold : threshold_q;

  logic [Lanes*Width-1:0] weights;  // 0 where not above
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] depth;
    logic signed [Width:0] excess;
    assign depth = in_data[lane*Width+:Width];
    assign excess = (Width + 1)'(depth) - (Width + 1)'(threshold_now);
    always_ff @(posedge clk) weights[lane*Width+:Width] <= excess[Width] ? '0 : excess[Width-1:0];
  end

  logic valid, ends;  // of the beat whose sums these are
  logic clears, clears_row;  // the next beat is the first of a frame, of a row
  logic [Delay-1:0] valid_delayed, start_delayed, end_delayed;
  logic [Delay-1:0][ColumnWidth-1:0] column_delayed;
  logic [Delay-1:0][RowWidth-1:0] row_delayed;
  always_ff @(posedge clk) begin
    if (in_valid) begin
      next_column <= in_position.row_end ? '0 : column + ColumnWidth'(Lanes);
      next_row <= ~in_position.row_end ? row : BottomFirst != 0 ? row - RowWidth'(1) : row + RowWidth'(1);
      threshold_q <= threshold_now;
    end
    column_delayed <= (Delay * ColumnWidth)'({column_delayed, column});
    row_delayed <= (Delay * RowWidth)'({row_delayed, row});
    valid_delayed <= Delay'({valid_delayed, in_valid});
    start_delayed <= Delay'({start_delayed, in_valid & frame_start});
    end_delayed <= Delay'({end_delayed, in_valid & in_position.frame_end});
    sums_valid <= end_delayed[Delay-1];
    if (rst) begin
      valid_delayed <= '0;
      end_delayed <= '0;
      sums_valid <= 1'b0;
    end
  end
  assign valid = valid_delayed[Delay-1];
  assign ends = end_delayed[Delay-1];

  // Sums of a beat: for one lane those of its depth.

  logic [CountWidth-1:0] beat_count;
  logic [BeatWeightWidth-1:0] beat_weight;
  logic [BeatWeightWidth+LanesLog2-1:0] beat_moment;
  logic [ColumnWidth-1:0] first_column, beat_least, beat_greatest;
  logic [RowWidth-1:0] beat_row;
  assign first_column = column_delayed[Delay-1];
  assign beat_row = row_delayed[Delay-1];
  if (Lanes == 1) begin : g_one_lane
    assign {beat_count, beat_weight, beat_moment} = {weights != '0, weights, Width'(0)};
    assign {beat_least, beat_greatest} = {2{first_column}};
    assign {clears, clears_row} = {in_valid & frame_start, in_valid & column == '0};
  end else begin : g_lanes
    logic [OffsetWidth-1:0] least_offset, greatest_offset;
    beat_sums #(.Width(Width), .Lanes(Lanes)) u_beat (
      .clk, .weights, .count(beat_count), .weight(beat_weight), .moment(beat_moment), .least_offset, .greatest_offset
    );
    assign beat_least = first_column + ColumnWidth'(least_offset);
    assign {clears, clears_row} = {start_delayed[Delay-2], valid_delayed[Delay-2] & column_delayed[Delay-2] == '0};
    assign beat_greatest = first_column + ColumnWidth'(greatest_offset);
  end

  // Sums and limits of the frame. Sums are cleared in the cycle before its first beat, those of a row before its first.

  logic row_starts;
  logic [AreaWidth-1:0] area, next_area, last_area;  // last_: of the last frame
  logic [WeightWidth-1:0] weight, next_weight, last_weight;
  logic [RowWeightWidth-1:0] row_weight;
  logic [RowMomentWidth-1:0] row_moment, last_row_moment;
  logic [ColumnMomentWidth-1:0] column_moment, next_column_moment, last_column_moment;
  logic [RowWidth-1:0] first_row, last_row, least_row, greatest_row;
  logic [ColumnWidth-1:0] least_column, greatest_column;
  assign row_starts = first_column == '0;
  assign next_area = area + AreaWidth'(beat_count);
  assign next_weight = weight + WeightWidth'(beat_weight);
  assign next_column_moment = column_moment + ColumnMomentWidth'(beat_moment)
      + (ColumnMomentWidth'(row_weight) << LanesLog2);
  always_ff @(posedge clk) begin
    if (valid) begin
      area <= next_area;
      weight <= next_weight;
      row_weight <= row_weight + RowWeightWidth'(beat_weight);
      if (row_starts) row_moment <= row_moment + RowMomentWidth'(weight);
      column_moment <= next_column_moment;
      if (beat_count != '0) begin
        last_row <= beat_row;
        if (area == '0) first_row <= beat_row;
        if (area == '0 || beat_least < least_column) least_column <= beat_least;
        if (area == '0 || beat_greatest > greatest_column) greatest_column <= beat_greatest;
      end
    end
    if (clears) {area, weight, row_moment, column_moment} <= '0;
    if (clears_row) row_weight <= '0;
    if (ends) begin
      {last_area, last_weight} <= {next_area, next_weight};
      {last_row_moment, last_column_moment} <= {row_moment, next_column_moment};
    end
  end
  assign least_row = BottomFirst != 0 ? last_row : first_row;
  assign greatest_row = BottomFirst != 0 ? first_row : last_row;
  assign sums.area = 32'(last_area);
  assign sums.weight = 64'(last_weight);
  assign sums.row_moment = 64'(last_row_moment);
  assign sums.column_moment = 64'(last_column_moment);
  assign {sums.least_row, sums.least_column} = {16'(least_row), 16'(least_column)};
  assign {sums.greatest_row, sums.greatest_column} = {16'(greatest_row), 16'(greatest_column)};

endmodule

`default_nettype wire
