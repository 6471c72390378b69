// SPDX-License-Identifier: Apache-2.0
// fv_contact_sums: area 2 clocks after the last beat of each frame, sums 3 + log2(Lanes); the area counts the depths above the
// threshold; limits and peak enclose an arbitrary depth above it, and are attained; the first of equal peaks.
//
// `touching` takes any value in any clock. Sums of rows, columns and
// depths are left to simulation against the model.

`default_nettype none

module fv_contact_sums
  import td_types_pkg::*;
#(
  parameter int Width       = 2,
  parameter int Rows        = 2,
  parameter int Columns     = 3,
  parameter int Lanes       = 1,
  parameter int BottomFirst = 0
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    in_valid,
  input depth_position_t         in_position,
  input logic [Lanes*Width-1:0]  in_data,
  input logic signed [Width:0]   on_level,
  input logic signed [Width:0]   off_level,
  input logic                    touching,
  input logic [3:0]              chosen
);

  localparam int Pixels = Rows * Columns;
  localparam int AreaWidth = $clog2(Pixels + 1);
  localparam int ToSums = 3 + $clog2(Lanes);  // clocks from the last beat of a frame
  localparam int Behind = ToSums - 2;         // clocks from the area to the sums

  logic area_valid, sums_valid;
  logic [AreaWidth-1:0] area;
  contact_sums_t sums;
  contact_sums #(
    .Width(Width), .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .BottomFirst(BottomFirst)
  ) dut (.*, .on_threshold(32'(on_level)), .off_threshold(32'(off_level)));

  logic allowed, started;
  logic [$clog2(Pixels/Lanes)-1:0] beat;
  logic [3:0] place;  // of the first depth of a beat
  assign place = 4'(Lanes * 32'(beat));
  protocol_contact_sums #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes)) u_protocol (
    .clk, .rst, .in_valid, .in_position, .area_valid, .sums_valid, .place(beat), .holds(allowed)
  );
  assumed u_assumed (.clk, .rst, .allowed, .started);

  // A beat one clock later, with the thresholds of its frame.
  logic valid_q, first_q;
  logic [Lanes*Width-1:0] data_q;
  logic signed [Width:0] on_q, off_q;
  logic [3:0] place_q;
  logic [15:0] row_q;
  assign row_q = BottomFirst != 0 ? 16'(Rows - 1) - 16'(place_q / 4'(Columns)) : 16'(place_q / 4'(Columns));

  // What the frame should come to; an arbitrary depth, row and column of it.
  logic [ToSums-1:0] due;
  logic [3:0] watched, watched_row, watched_column;
  logic [Lanes-1:0] above, is_watched, in_watched_column;
  logic signed [Width-1:0] depth, depth_now, depth_q;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] of_lane;
    assign of_lane = data_q[lane*Width+:Width];
    assign above[lane] = valid_q & ((Width + 1)'(of_lane) > (touching ? off_q : on_q));
    assign is_watched[lane] = place_q + 4'(lane) == watched;
    assign in_watched_column[lane] = (place_q + 4'(lane)) % 4'(Columns) == watched_column;
  end
  logic [AreaWidth-1:0] above_count, count, count_q;
  logic held, held_q, in_row, in_row_q, in_column, in_column_q;
  always_comb begin
    above_count = '0;
    depth_now = depth;
    for (int lane = 0; lane < Lanes; lane++) begin
      above_count += AreaWidth'(above[lane]);
      if (is_watched[lane]) depth_now = data_q[lane*Width+:Width];
    end
  end
  logic signed [31:0] peak;
  logic [3:0] peak_place;
  assign peak = $signed(sums.peak);
  assign peak_place = 4'((BottomFirst != 0 ? 16'(Rows - 1) - sums.peak_row : sums.peak_row) * 16'(Columns)
      + sums.peak_column);
  assign watched_row = BottomFirst != 0 ? 4'(Rows - 1) - watched / 4'(Columns) : watched / 4'(Columns);
  assign watched_column = watched % 4'(Columns);
  logic [Behind*(AreaWidth+3+Width)-1:0] later;  // what the sums should say, when they come
  assign {count_q, held_q, in_row_q, in_column_q, depth_q} = later[(Behind-1)*(AreaWidth+3+Width)+:AreaWidth+3+Width];

  always_ff @(posedge clk) begin
    if (!started) watched <= chosen;
    if (in_valid && in_position.frame_start) {on_q, off_q} <= {on_level, off_level};
    valid_q <= in_valid & ~rst;
    first_q <= in_position.frame_start;
    data_q <= in_data;
    place_q <= place;
    due <= {due[ToSums-2:0], in_valid & in_position.frame_end};
    if (valid_q) begin
      count <= (first_q ? '0 : count) + above_count;
      held <= is_watched != '0 ? (above & is_watched) != '0 : held & ~first_q;
      in_row <= (above != '0 & row_q == 16'(watched_row)) | (in_row & ~first_q);
      in_column <= ((above & in_watched_column) != '0) | (in_column & ~first_q);
      depth <= depth_now;
    end
    later <= (Behind * (AreaWidth + 3 + Width))'({later, count, held, in_row, in_column, depth});
    if (rst) due <= '0;
  end
  always_comb assume (chosen < 4'(Pixels));

  always_comb begin
    if (started) begin
      area_in_time: assert (area_valid == due[1]);
      sums_in_time: assert (sums_valid == due[ToSums-1]);
      if (area_valid) area_of_frame: assert (area == count);
      if (sums_valid) begin
        none: assert (count_q != 0 || sums == '0);
        if (held_q) begin
          row_within: assert (sums.least_row <= 16'(watched_row) && 16'(watched_row) <= sums.greatest_row);
          column_within: assert (sums.least_column <= 16'(watched_column)
              && 16'(watched_column) <= sums.greatest_column);
          highest: assert (peak > 32'(depth_q) || (peak == 32'(depth_q) && peak_place <= watched));
        end
        if (count_q != 0) begin
          if (peak_place == watched) peak_attained: assert (held_q && peak == 32'(depth_q));
          if (sums.least_row == 16'(watched_row) || sums.greatest_row == 16'(watched_row)) begin
            row_attained: assert (in_row_q);
          end
          if (sums.least_column == 16'(watched_column) || sums.greatest_column == 16'(watched_column)) begin
            column_attained: assert (in_column_q);
          end
        end
      end
      some_above: cover (sums_valid && held_q && count_q == AreaWidth'(3) && peak != 32'(depth_q));
      none_above: cover (sums_valid && count_q == 0);
      next_follows: cover (area_valid && above != '0 && first_q);
    end
  end

endmodule

`default_nettype wire
