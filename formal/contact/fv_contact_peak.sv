// SPDX-License-Identifier: Apache-2.0
// fv_contact_peak: count 2 clocks after the last beat of each frame, peak 3 + log2(Lanes); the count is that of the depths
// above the threshold; the peak is none below an arbitrary depth above it, and is attained; the first of equal peaks.
//
// `touching` takes any value in any clock; thresholds stay the same within a frame.

parameter int Width = 2, Rows = 2, Columns = 3, Lanes = 1, BottomFirst = 0;
input logic [3:0] chosen;
input logic signed [Width:0] on_threshold;  // that of in_above

localparam int Pixels = Rows * Columns;
localparam int ToPeak = 3 + $clog2(Lanes);  // clocks from the last beat of a frame
localparam int Behind = ToPeak - 2;         // clocks from the count to the peak

wire [$clog2(Pixels/Lanes)-1:0] beat = u_protocol.u_depth_frames.place;
logic [3:0] place;  // of the first depth of a beat
assign place = 4'(Lanes * 32'(beat));

// A beat one clock later, with its thresholds.
logic valid_q, first_q;
logic [Lanes*Width-1:0] data_q;
logic signed [Width:0] on_q, off_q;
logic [3:0] place_q;

// What the frame should come to; an arbitrary depth of it.
logic [ToPeak-1:0] due;
logic [3:0] watched;
logic [Lanes-1:0] above, is_watched;
logic signed [Width-1:0] depth, depth_now, depth_q;
for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
  logic signed [Width-1:0] of_lane, in_lane;
  assign of_lane = data_q[lane*Width+:Width];
  assign in_lane = in_data[lane*Width+:Width];
  always_comb assume (in_above[lane] == ((Width + 1)'(in_lane) > on_threshold));
  assign above[lane] = valid_q & ((Width + 1)'(of_lane) > (touching ? off_q : on_q));
  assign is_watched[lane] = place_q + 4'(lane) == watched;
end
logic [CountWidth-1:0] above_count, total, total_q;
logic held, held_q;
always_comb begin
  above_count = '0;
  depth_now = depth;
  for (int lane = 0; lane < Lanes; lane++) begin
    above_count += CountWidth'(above[lane]);
    if (is_watched[lane]) depth_now = data_q[lane*Width+:Width];
  end
end
logic [3:0] peak_place;
assign peak_place = 4'((BottomFirst != 0 ? 16'(Rows - 1) - peak_row : peak_row) * 16'(Columns) + peak_column);
logic [Behind*(CountWidth+1+Width)-1:0] later;  // what the peak should say, when it comes
assign {total_q, held_q, depth_q} = later[(Behind-1)*(CountWidth+1+Width)+:CountWidth+1+Width];

always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  if (in_valid) {on_q, off_q} <= {on_threshold, off_threshold};
  valid_q <= in_valid & ~rst;
  first_q <= in_position.frame_start;
  data_q <= in_data;
  place_q <= place;
  due <= {due[ToPeak-2:0], in_valid & in_position.frame_end};
  if (valid_q) begin
    total <= (first_q ? '0 : total) + above_count;
    held <= is_watched != '0 ? (above & is_watched) != '0 : held & ~first_q;
    depth <= depth_now;
  end
  later <= (Behind * (CountWidth + 1 + Width))'({later, total, held, depth});
  if (rst) due <= '0;
end
always_comb assume (chosen < 4'(Pixels));

always_comb begin
  if (started) begin
    count_in_time: assert (count_valid == due[1]);
    peak_in_time: assert (peak_valid == due[ToPeak-1]);
    if (count_valid) count_of_frame: assert (count == total);
    if (peak_valid) begin
      finds: assert (any_above == (total_q != 0));
      none: assert (any_above || (peak == '0 && peak_row == '0 && peak_column == '0));
      if (held_q) highest: assert (peak > depth_q || (peak == depth_q && peak_place <= watched));
      if (any_above && peak_place == watched) attained: assert (held_q && peak == depth_q);
    end
    some_above: cover (peak_valid && held_q && total_q == CountWidth'(3) && peak != depth_q);
    none_above: cover (peak_valid && total_q == 0);
    next_follows: cover (count_valid && above != '0 && first_q);
  end
end
