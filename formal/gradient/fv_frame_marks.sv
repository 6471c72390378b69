// SPDX-License-Identifier: Apache-2.0
// fv_frame_marks: flags leave one enabled clock behind a frame's last slope, with the clips, the dark and the steep
// pixels of that frame, and the gains that came with its end at the first stage. Ends come in any order: each stage has
// the frame that ended there last.
//
// The specification counts from the reset on, modulo a number that no frame reaches, and takes differences.

parameter int Width = 10, Pixels = 9, CountBits = 3;

localparam int Most = (1 << CountBits) - 1, Wide = CountBits + 2, Drop = Width - 9;
localparam logic [Wide-1:0] One = 1;

function automatic logic is_above(input logic signed [Width-1:0] slope);
  int size;
  size = int'(slope) < 0 ? -int'(slope) - 1 : int'(slope);
  return (size >> Drop) > int'(slope_limit);
endfunction
function automatic logic [15:0] shown(input logic [Wide-1:0] count);
  return int'(count) > Most ? 16'(Most) : 16'(count);
endfunction

// Pixels and clips since the reset, and where the present frame of each stage began; of the frame that ended there.

logic leaves, steep_now, moved, known;
logic [2:0] clips, ends, clip, clip_next, last_clip, ended;
logic [Wide-1:0] dark_total, dark_before, dark_of_frame, steep_total, steep_before, dark_here, steep_here;
logic [3*GainWidth-1:0] gains;
assign clips = {slope_clipped, colour_clipped, relative_clipped};
assign ends = {slope_ends, colour_ends, relative_ends};
assign clip_next = clip | clips;
assign dark_here = dark_total + Wide'(dark) - dark_before;
assign steep_here = steep_total + Wide'(steep_now) - steep_before;
always_ff @(posedge clk) begin
  dark_total <= dark_total + Wide'(dark);
  steep_total <= steep_total + Wide'(steep_now);
  clip <= clip_next;
  steep_now <= en && slope_valid && (is_above(slope_gx) || is_above(slope_gy));
  if (en) begin
    leaves <= slope_ends;
    ended <= ended | ends;
    for (int stage = 0; stage < 3; stage++) begin
      if (ends[stage]) {last_clip[stage], clip[stage]} <= {clip_next[stage], 1'b0};
    end
    if (relative_ends) begin
      {gains, moved} <= {light_gains, light_moves};
      dark_of_frame <= dark_here;
      dark_before <= dark_total + Wide'(dark);
    end
    if (leaves) steep_before <= steep_total + Wide'(steep_now);
  end
  if (rst) {leaves, steep_now, clip, ended, dark_total, dark_before, steep_total, steep_before} <= '0;
end
assign known = ended == '1;
assign allowed = (!dark || dark_here <= Wide'(Pixels)) && steep_here <= Wide'(Pixels);

always_comb begin
  if (started) begin
    leave: assert (out_valid == leaves);
    if (out_valid && known) begin
      clipped: assert (out_flags.colours_clipped == (last_clip != '0));
      light: assert ({out_flags.light_gain_blue, out_flags.light_gain_green, out_flags.light_gain_red} == gains
          && out_flags.light_moves == moved);
      dark_pixels: assert (out_flags.dark == shown(dark_of_frame));
      begun: assert (out_flags.resumed == resumed);
      of_depth: assert ({out_flags.others, out_flags.zero_clipped, out_flags.depth_clipped} == '0);
    end
    if (out_valid) steep_pixels: assert (out_flags.steep == shown(steep_here));
    many: cover (out_valid && known && out_flags.dark == 16'(Most) && out_flags.steep == 16'(Most) && last_clip == 3'b010);
  end
end
