// SPDX-License-Identifier: Apache-2.0
// fv_contact_sums: sums 2 + log2(Lanes) clocks after the last beat of each frame: area, weight and moments of the depths above
// the threshold, by multiplication; limits enclose an arbitrary depth above it, and are attained.

parameter int Width = 2, Rows = 2, Columns = 3, Lanes = 1, BottomFirst = 0;
input logic [3:0] chosen;

localparam int Pixels = Rows * Columns;
localparam int SumWidth = Width + 6;        // of a sum or a moment in so small a frame
localparam int ToSums = 2 + $clog2(Lanes);  // clocks from the last beat of a frame
localparam int Behind = ToSums - 1;         // clocks from what the frame should come to, to the sums

wire [$clog2(Pixels/Lanes)-1:0] beat = u_protocol.u_depth_frames.place;
logic [3:0] place;  // of the first depth of a beat
assign place = 4'(Lanes * 32'(beat));

// What the frame should come to; an arbitrary depth, row and column of it.
typedef struct packed {
  logic [3:0] area;
  logic [SumWidth-1:0] weight;
  logic [SumWidth-1:0] rows;     // moments
  logic [SumWidth-1:0] columns;
  logic held;                    // the watched depth is above
  logic in_row;                  // a depth of the watched row is above
  logic in_column;
} wanted_t;

logic first;
logic [ToSums-1:0] due;
logic signed [Width-1:0] threshold_q, threshold_now;
logic [3:0] watched, watched_row, watched_column, row, column;
wanted_t so_far, wanted, now;
wanted_t [Behind-1:0] later;
assign first = in_position.frame_start;
assign threshold_now = first ? threshold : threshold_q;
assign so_far = first ? '0 : wanted;
assign row = place / 4'(Columns);  // in the order of the stream
assign watched_row = watched / 4'(Columns);
assign watched_column = watched % 4'(Columns);
logic signed [Width-1:0] depth;
logic [SumWidth-1:0] excess;
always_comb begin
  now = so_far;
  column = place % 4'(Columns);
  for (int lane = 0; lane < Lanes; lane++) begin
    depth = in_data[lane*Width+:Width];
    excess = SumWidth'($signed((Width + 1)'(depth) - (Width + 1)'(threshold_now)));
    if (depth > threshold_now) begin
      now.area = now.area + 4'd1;
      now.weight = now.weight + excess;
      now.rows = now.rows + excess * SumWidth'(4'(Rows - 1) - row);
      now.columns = now.columns + excess * SumWidth'(4'(Columns - 1) - column);
      now.held = now.held | (row == watched_row & column == watched_column);
      now.in_row = now.in_row | row == watched_row;
      now.in_column = now.in_column | column == watched_column;
    end
    column = column + 4'd1;
  end
end
always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  due <= {due[ToSums-2:0], in_valid & in_position.frame_end};
  if (in_valid) {threshold_q, wanted} <= {threshold_now, now};
  later <= (Behind * $bits(wanted_t))'({later, wanted});
  if (rst) due <= '0;
end
always_comb assume (chosen < 4'(Pixels));

wanted_t want;
logic [15:0] upright_row;
assign want = later[Behind-1];
assign upright_row = BottomFirst != 0 ? 16'(Rows - 1) - 16'(watched_row) : 16'(watched_row);
always_comb begin
  if (started) begin
    in_time: assert (sums_valid == due[ToSums-1]);
    if (sums_valid) begin
      area: assert (sums.area == 32'(want.area));
      weight: assert (sums.weight == 64'(want.weight));
      moments: assert (sums.row_moment == 64'(want.rows) && sums.column_moment == 64'(want.columns));
      if (want.held) begin
        row_within: assert (sums.least_row <= upright_row && upright_row <= sums.greatest_row);
        column_within: assert (sums.least_column <= 16'(watched_column)
            && 16'(watched_column) <= sums.greatest_column);
      end
      if (want.area != '0) begin
        if (sums.least_row == upright_row || sums.greatest_row == upright_row) row_attained: assert (want.in_row);
        if (sums.least_column == 16'(watched_column) || sums.greatest_column == 16'(watched_column)) begin
          column_attained: assert (want.in_column);
        end
      end
    end
    some_above: cover (sums_valid && want.held && want.area == 4'd3 && want.rows != want.columns);
    none_above: cover (sums_valid && want.area == '0);
    next_follows: cover (sums_valid && in_valid);
  end
end
