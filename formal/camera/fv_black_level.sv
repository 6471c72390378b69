// SPDX-License-Identifier: Apache-2.0
// fv_black_level: out is the sample less the black level, beside the gains, both of those that stood beside the frame's
// first pixel; pixels, marks and breaks leave an enabled clock later.

parameter int Bits = 10, Channels = 1, GainsWidth = 48;

logic valid, abort, held;
logic [3:0] marks;
logic [Bits-1:0] own_level, level_now;
logic [GainsWidth-1:0] own_gains;
logic [Channels*Width-1:0] samples;  // with their black level
logic [Channels*Width+GainsWidth+5:0] out;
assign level_now = in_valid && in_frame_start ? level : own_level;
assign out = {out_valid, out_abort, out_colour, out_row_start, out_frame_start, out_samples, out_gains};
kept #(.Width(Channels * Width + GainsWidth + 6)) u_kept (.clk, .rst, .en, .out, .held);
always_ff @(posedge clk) begin
  if (en) begin
    if (in_valid && in_frame_start) {own_level, own_gains} <= {level, gains};
    {valid, abort, marks} <= {in_valid, in_abort, in_colour, in_row_start, in_frame_start};
    for (int c = 0; c < Channels; c++) samples[c*Width+:Width] <= in_samples[c*Width+:Width] - Width'(level_now);
  end
  if (rst) {valid, abort} <= '0;
end

always_comb begin
  if (started) begin
    in_time: assert (out_valid == valid && out_abort == abort);
    if (out_valid) begin
      marked: assert ({out_colour, out_row_start, out_frame_start} == marks);
      difference: assert (out_samples == samples);
      own: assert (out_gains == own_gains);
      old_settings: cover (out_samples != '0 && !out_frame_start && level == '0 && own_level != '0);
      below_black: cover (out_samples[Width-1] && out_colour == 2'd3);
    end
  end
end
