// SPDX-License-Identifier: Apache-2.0
// contact_sums: area, sums, limits and peak of the depths above the threshold, once a frame.
//
//   above = a depth greater than the threshold in force: on_threshold while not touching, off_threshold while touching
//
// Stream in: depth codes that are never held back, Lanes neighbours in a beat with the first in the lowest bits, in
// raster order or, BottomFirst, bottom row first. A frame that begins inside another begins afresh. Thresholds are
// taken with a frame's first beat. `touching` is read in the cycle of area_valid at the earliest, so it may be decided
// in that cycle from `area`. Latency: area_valid comes 2 cycles after the last beat of a frame, sums_valid
// 3 + log2(Lanes); `area` and `sums` are those of the frame in that cycle alone. Gaps change nothing. Bit-accurate
// model: models/tactile_depth/contact/contact_sums.py.

`default_nettype none

module contact_sums
  import td_types_pkg::*;
#(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Lanes       = 1,  // depths in a beat
  parameter int BottomFirst = 0,  // 1: the bottom row comes first
  localparam int AreaWidth = $clog2(Rows * Columns + 1)
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     in_valid,
  input  wire depth_position_t    in_position,
  input  wire  [Lanes*Width-1:0]  in_data,        // depth codes, signed
  input  wire  signed [31:0]      on_threshold,   // depth code
  input  wire  signed [31:0]      off_threshold,  // depth code
  input  wire                     touching,       // the threshold in force is off_threshold
  output logic                    area_valid,
  output logic [AreaWidth-1:0]    area,           // depths above, pixels
  output logic                    sums_valid,
  output contact_sums_t           sums
);

  localparam int Pixels = Rows * Columns;
  localparam int RowWidth = $clog2(Rows);
  localparam int ColumnWidth = $clog2(Columns);
  localparam int ColumnSumWidth = $clog2(Pixels * (Columns - 1) / 2 + 1);
  localparam int RowSumWidth = $clog2(Pixels * (Rows - 1) / 2 + 1);
  localparam int VolumeWidth = Width + $clog2(Pixels);

  localparam int OffsetWidth = Lanes > 1 ? $clog2(Lanes) : 1;  // of a depth in its beat
  localparam int CountWidth = $clog2(Lanes + 1);
  localparam int SumDelay = $clog2(Lanes) + 1;  // cycles from the comparison to the sums of a beat

  function automatic logic [CountWidth-1:0] ones(input logic [Lanes-1:0] bits);
    ones = '0;
    for (int lane = 0; lane < Lanes; lane++) ones = ones + CountWidth'(bits[lane]);
  endfunction

  // A count of depths times their row, or times the first column of their beat.
  function automatic logic [31:0] times(input logic [CountWidth-1:0] count, input logic [15:0] position);
    times = '0;
    for (int b = 0; b < CountWidth; b++) if (count[b]) times = times + (32'(position) << b);
  endfunction

  // Row and first column of each beat, and which of its depths are above either threshold.

  logic frame_start;
  logic [ColumnWidth-1:0] column, next_column, column_q;
  logic [RowWidth-1:0] row, next_row, row_q;
  assign frame_start = in_position.frame_start;
  assign column = frame_start ? '0 : next_column;
  assign row = ~frame_start ? next_row : BottomFirst != 0 ? RowWidth'(Rows - 1) : '0;

  logic signed [31:0] on_q, off_q;
  logic [1:0][Lanes*Width-1:0] data_q;
  logic [Lanes-1:0] above_on, above_off;
  logic valid_q, frame_start_q, frame_end_q;
  always_ff @(posedge clk) begin
    if (in_valid) begin
      next_column <= in_position.row_end ? '0 : column + ColumnWidth'(Lanes);
      next_row <= ~in_position.row_end ? row : BottomFirst != 0 ? row - RowWidth'(1) : row + RowWidth'(1);
      if (frame_start) begin
        on_q <= on_threshold;
        off_q <= off_threshold;
      end
    end
    column_q <= column;
    row_q <= row;
    data_q <= {data_q[0], in_data};
    valid_q <= in_valid;
    frame_start_q <= frame_start;
    frame_end_q <= in_position.frame_end;
    if (rst) valid_q <= 1'b0;
  end
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] depth;
    assign depth = in_data[lane*Width+:Width];
    always_ff @(posedge clk) begin
      above_on[lane] <= 32'(depth) > (frame_start ? on_threshold : on_q);
      above_off[lane] <= 32'(depth) > (frame_start ? off_threshold : off_q);
    end
  end

  // Area. The first beat of the next frame may be here in the cycle of area_valid.

  logic [Lanes-1:0] above, above_q;
  logic [SumDelay-1:0] valid_delayed, start_delayed, end_delayed;
  logic [SumDelay-1:0][ColumnWidth-1:0] column_delayed;
  logic [SumDelay-1:0][RowWidth-1:0] row_delayed;
  assign above = touching ? above_off : above_on;
  always_ff @(posedge clk) begin
    if (valid_q) area <= (frame_start_q ? '0 : area) + AreaWidth'(ones(above));
    above_q <= above;
    column_delayed <= (SumDelay * ColumnWidth)'({column_delayed, column_q});
    row_delayed <= (SumDelay * RowWidth)'({row_delayed, row_q});
    valid_delayed <= SumDelay'({valid_delayed, valid_q});
    start_delayed <= SumDelay'({start_delayed, frame_start_q});
    end_delayed <= SumDelay'({end_delayed, valid_q & frame_end_q});
    sums_valid <= end_delayed[SumDelay-1];
    if (rst) begin
      valid_delayed <= '0;
      end_delayed <= '0;
      sums_valid <= 1'b0;
    end
  end
  assign area_valid = end_delayed[0];

  // Sums of a beat: for one lane those of its depth.

  logic [CountWidth-1:0] beat_count;
  logic [ColumnSumWidth-1:0] beat_columns;
  logic [RowSumWidth-1:0] beat_rows;
  logic signed [VolumeWidth-1:0] beat_volume;
  logic signed [Width-1:0] beat_peak;
  logic [ColumnWidth-1:0] first_column, beat_peak_column, beat_least, beat_greatest;
  logic [RowWidth-1:0] beat_row;
  assign first_column = column_delayed[SumDelay-1];
  assign beat_row = row_delayed[SumDelay-1];
  if (Lanes == 1) begin : g_one_lane
    assign beat_count = above_q;
    assign beat_columns = ColumnSumWidth'(first_column);
    assign beat_rows = RowSumWidth'(beat_row);
    assign beat_peak = data_q[1];
    assign beat_volume = VolumeWidth'(beat_peak);
    assign {beat_peak_column, beat_least, beat_greatest} = {3{first_column}};
  end else begin : g_lanes
    logic [2*OffsetWidth-1:0] offset_sum;
    logic [OffsetWidth-1:0] peak_offset, least_offset, greatest_offset;
    logic signed [Width+OffsetWidth-1:0] volume_of_beat;
    beat_sums #(.Width(Width), .Lanes(Lanes)) u_beat (
      .clk, .above(above_q), .data(data_q[1]), .count(beat_count), .offset_sum, .volume(volume_of_beat),
      .peak(beat_peak), .peak_offset, .least_offset, .greatest_offset
    );
    assign beat_columns = ColumnSumWidth'(times(beat_count, 16'(first_column))) + ColumnSumWidth'(offset_sum);
    assign beat_rows = RowSumWidth'(times(beat_count, 16'(beat_row)));
    assign beat_volume = VolumeWidth'(volume_of_beat);
    assign beat_peak_column = first_column + ColumnWidth'(peak_offset);
    assign beat_least = first_column + ColumnWidth'(least_offset);
    assign beat_greatest = first_column + ColumnWidth'(greatest_offset);
  end

  // Sums, limits and peak of the frame.

  logic any_above, any_in_beat, first_above;  // in this frame so far; in this beat; this beat would be the first
  logic [ColumnSumWidth-1:0] column_sum;
  logic [RowSumWidth-1:0] row_sum;
  logic signed [VolumeWidth-1:0] volume;
  logic signed [Width-1:0] peak;
  logic [RowWidth-1:0] peak_row, first_row, last_row, least_row, greatest_row;
  logic [ColumnWidth-1:0] peak_column, least_column, greatest_column;
  assign any_in_beat = beat_count != '0;
  assign first_above = start_delayed[SumDelay-1] | ~any_above;
  always_ff @(posedge clk) begin
    if (valid_delayed[SumDelay-1]) begin
      any_above <= any_in_beat | ~first_above;
      if (any_in_beat) begin
        column_sum <= (first_above ? '0 : column_sum) + beat_columns;
        row_sum <= (first_above ? '0 : row_sum) + beat_rows;
        volume <= (first_above ? VolumeWidth'(0) : volume) + beat_volume;
        if (first_above || beat_peak > peak) {peak, peak_row, peak_column} <= {beat_peak, beat_row, beat_peak_column};
        if (first_above) first_row <= beat_row;
        last_row <= beat_row;
        if (first_above || beat_least < least_column) least_column <= beat_least;
        if (first_above || beat_greatest > greatest_column) greatest_column <= beat_greatest;
      end
    end
  end
  assign least_row = BottomFirst != 0 ? last_row : first_row;
  assign greatest_row = BottomFirst != 0 ? first_row : last_row;
  contact_sums_t frame_sums;
  assign frame_sums.volume = 64'(volume);
  assign frame_sums.row_sum = 32'(row_sum);
  assign frame_sums.column_sum = 32'(column_sum);
  assign frame_sums.greatest_row = 16'(greatest_row);
  assign frame_sums.greatest_column = 16'(greatest_column);
  assign frame_sums.least_row = 16'(least_row);
  assign frame_sums.least_column = 16'(least_column);
  assign frame_sums.peak_row = 16'(peak_row);
  assign frame_sums.peak_column = 16'(peak_column);
  assign frame_sums.peak = 32'(peak);
  assign sums = any_above ? frame_sums : '0;

  if (Width < 2 || Width > 32) begin : g_refused_0
    Width_must_be_2_to_32 u_refused ();
  end
  if (Rows < 2 || Rows > 1024) begin : g_refused_1
    Rows_must_be_2_to_1024 u_refused ();
  end
  if (Columns < 2 || Columns > 1024) begin : g_refused_2
    Columns_must_be_2_to_1024 u_refused ();
  end
  if (Lanes < 1 || Lanes > 32 || Lanes != (1 << $clog2(Lanes)) || Columns % Lanes != 0) begin : g_refused_3
    Lanes_must_be_a_power_of_two_up_to_32_that_divides_Columns u_refused ();
  end

endmodule

`default_nettype wire
