// SPDX-License-Identifier: Apache-2.0
// fv_threshold_comparator: contact rises in the clock after a beat with a depth above the threshold leaves, and at no other time.
// While hold is high it does not fall. Otherwise it is high from such a depth on until the clock after the first depth of
// the next frame, so it falls in the clock after hold is cleared if this frame has had no depth above the threshold.
// The threshold is any code of 32 bits, as near_depths gives it to the core.

parameter int Width = 24, Lanes = 1;
input logic signed [31:0] code;
always_comb assume (threshold == (Width + 1)'(td_types_pkg::near_depths(code, Width)));

logic signed [31:0] of_frame, in_force;  // threshold when the frame began; that which counts now
assign in_force = in_valid & in_frame_start ? code : of_frame;
logic [Lanes-1:0] exceeds;  // depths of the beat above the threshold
for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
  logic signed [Width-1:0] depth;
  logic signed [33:0] excess;
  assign depth = in_data[lane*Width+:Width];
  assign excess = 34'(depth) - 34'(in_force);
  assign exceeds[lane] = excess > 0;
end

logic began, fired, of_this_frame, contact_q, hold_q, beat_q, within_frame;
always_ff @(posedge clk) begin
  began <= ~rst & (began | (in_valid & in_frame_start));
  of_frame <= in_force;
  fired <= ~rst & in_valid & (exceeds != '0);
  of_this_frame <= ~rst & (in_valid ? exceeds != '0 | (of_this_frame & ~in_frame_start) : of_this_frame);
  within_frame <= in_valid & ~in_frame_start;
  contact_q <= contact & ~rst;
  hold_q <= hold;
  beat_q <= in_valid;
end

always_comb begin
  if (started) begin
    if (in_valid && (began || in_frame_start)) compares: assert (above == exceeds);
    if (fired) fires_in_one_clock: assert (contact);
    else if (hold_q && contact_q) keeps: assert (contact);
    else follows_this_frame: assert (contact == of_this_frame);
    if (contact && !contact_q) rises_for_a_depth: assert (fired);
    fires_late: cover (fired && within_frame && !contact_q && of_frame < 0);
    refires: cover (fired && contact_q && !within_frame);
    holds: cover (contact && !fired && !within_frame && in_valid && in_frame_start);
    falls: cover (contact_q && !contact);
    falls_as_hold_is_cleared: cover (contact_q && !contact && !beat_q);
  end
end
