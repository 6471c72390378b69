// SPDX-License-Identifier: Apache-2.0
// fv_depth_flags: out_flags are those that came in one enabled clock behind the frame's first beat; the solver's clip is
// set if the tag was marked or a clip came since; that of the zero offset if one came since the last beat of the frame
// before; a frame that enters is clipped if a clip came since its first pixel.

logic begun, known, entered, left, zeroed;
logic entering_clip, leaving_clip, zero_clip;
frame_flags_t flags, expected;
assign entered = entering_clip | solver_clipped;
assign left = leaving_clip | solver_clipped;
assign zeroed = zero_clip | zero_clipped;
always_ff @(posedge clk) begin
  entering_clip <= en && frame_start ? 1'b0 : entered;
  zero_clip <= en && depth_ends ? 1'b0 : zeroed;
  leaving_clip <= left;
  if (en) begun <= depth_starts;
  if (en && begun) begin
    known <= 1'b1;
    flags <= in_flags;
    leaving_clip <= marked | solver_clipped;
  end
  if (rst) {begun, entering_clip, leaving_clip, zero_clip, known} <= '0;
end
always_comb begin
  expected = flags;
  expected.depth_clipped = left;
  expected.zero_clipped = zeroed;
end

always_comb begin
  if (started) begin
    enters: assert (entering_clipped == entered);
    if (known) leaves: assert (out_flags == expected);
    all_at_once: cover (known && out_flags == '1 && depth_ends && !solver_clipped && !zero_clipped);
  end
end
