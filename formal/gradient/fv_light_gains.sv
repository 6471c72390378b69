// SPDX-License-Identifier: Apache-2.0
// fv_light_gains: every pixel of a frame has the gains that stood when its first pixel came, and leaves 2 enabled
// clocks later as sat(round(ratio gain - 1)), or 0 if all its ratios are 0; a gain stays within its limits, and changes
// only by a reset, by a write, and by the last pixel of a good frame while `follow` is high, which takes the move off.
//
// In a second part (Moves 1), with deviations of any value in place of those of the ratios: the move that the last
// pixel takes off is the rule of the header, applied to all rows of that frame but the last, whatever the gaps.

parameter int Moves = 0, Rows = 2, Columns = 10, RatioWidth = 4, RatioFraction = 2, GainWidth = 5, OutWidth = 6,
    OutFraction = 4;

wire [15:0] row = u_protocol.row, column = u_protocol.column;
assign allowed = !in_valid || in_position == u_protocol.place;

// Part 1.

localparam int GainFraction = GainWidth - 1, Drop = RatioFraction + GainFraction - OutFraction,
    Least = 1 << (GainWidth - 2), Most = (1 << GainWidth) - 1,
    Lowest = -(1 << (OutWidth - 1)), Highest = (1 << (OutWidth - 1)) - 1;

logic first, last, commits, in_frame, bad;
logic [3*RatioWidth-1:0] ratios;
logic [3*GainWidth-1:0] in_force, frame_gains, gains_q;
assign ratios = {in_blue, in_green, in_red};
assign first = in_valid && (&in_position[1:0]);
assign last = in_valid && (&in_position[3:2]);
assign in_force = first ? gains : frame_gains;
assign commits = en && last && follow && !bad && !in_bad;

logic [1:0] valid;
logic [7:0] position;
logic [6*OutWidth-1:0] expected;  // {blue, green, red} of the last two
logic [3*OutWidth-1:0] results;
logic [2:0] clips, clips_q;
logic [1:0] expected_clips;
always_comb begin
  for (int c = 0; c < 3; c++) begin
    int product, rounded;
    product = int'(ratios[c*RatioWidth+:RatioWidth]) * int'(in_force[c*GainWidth+:GainWidth])
        - (1 << (RatioFraction + GainFraction));
    rounded = product >>> Drop;
    if (product[Drop-1:0] > Drop'(1 << (Drop - 1)) || (product[Drop-1:0] == Drop'(1 << (Drop - 1)) && rounded[0])) begin
      rounded = rounded + 1;
    end
    clips[c] = ratios != '0 && (rounded < Lowest || rounded > Highest);
    if (rounded < Lowest) rounded = Lowest;
    if (rounded > Highest) rounded = Highest;
    results[c*OutWidth+:OutWidth] = ratios == '0 ? '0 : OutWidth'(rounded);
  end
end

logic [2:0] write_q;
logic [GainWidth-1:0] write_gain_q;
logic reset_q, commits_q;
always_ff @(posedge clk) begin
  gains_q <= gains;
  write_q <= write;
  write_gain_q <= write_gain;
  reset_q <= rst;
  commits_q <= commits;
  expected_clips <= en && valid[0] && !rst ? 2'(clips_q[0]) + 2'(clips_q[1]) + 2'(clips_q[2]) : '0;
  if (en) begin
    valid <= {valid[0], in_valid};
    position <= {position[3:0], in_position};
    expected <= {expected[3*OutWidth-1:0], results};
    clips_q <= clips;
    if (in_valid) frame_gains <= in_force;
    bad <= (bad || in_bad) && !last;
  end
  if (rst) begin
    valid <= '0;
    bad <= 1'b0;
  end
end

logic [2:0] in_limits, is_expected;  // by colour
always_comb begin
  for (int c = 0; c < 3; c++) begin
    int gain, wanted;
    gain = int'(gains[c]);
    wanted = int'(gains_q[c*GainWidth+:GainWidth]);
    if (write_q[c]) wanted = int'(write_gain_q) < Least ? Least : int'(write_gain_q);
    if (reset_q) wanted = 2 * Least;
    in_limits[c] = gain >= Least && gain <= Most;
    is_expected[c] = gain == wanted || (commits_q && !reset_q && !write_q[c]);
  end
end

if (Moves == 0) begin : g_pixels
  always_comb begin
    if (started) begin
      valid_travels: assert (out_valid == valid[1]);
      if (out_valid) begin
        position_travels: assert (out_position == position[7:4]);
        deviations: assert ({out_blue, out_green, out_red} == expected[6*OutWidth-1-:3*OutWidth]);
      end
      clipped_counted: assert (saturations == expected_clips);
      within_limits: assert (in_limits == '1);
      if (in_valid && !first) used_are_those: assert (used == frame_gains);
      gains_stay_or_are_set: assert (is_expected == '1);
      clipped: cover (saturations == 2'd2 && out_valid);
      uses_what_was_written: cover (out_valid && out_position == 4'b0011 && frame_gains[0+:GainWidth] == GainWidth'(2 * Least + 1));
    end
  end
end else begin : g_moves
  bind dut light_gains_move #(
    .Rows(Rows), .Columns(Columns), .GainWidth(GainWidth), .OutWidth(OutWidth), .OutFraction(OutFraction)
  ) u_move (
    .*, .above_q({g_colour[2].is_above, g_colour[1].is_above, g_colour[0].is_above}),
    .below_q({g_colour[2].is_below, g_colour[1].is_below, g_colour[0].is_below}),
    .deviations_q({g_colour[2].near_deviation, g_colour[1].near_deviation, g_colour[0].near_deviation}),
    .few_sums({g_colour[2].few_sum_q, g_colour[1].few_sum_q, g_colour[0].few_sum_q}),
    .few_nets({g_colour[2].few_net_q, g_colour[1].few_net_q, g_colour[0].few_net_q}),
    .moved({g_colour[2].move_q, g_colour[1].move_q, g_colour[0].move_q}),
    .row(fv_light_gains.row), .column(fv_light_gains.column)
  );
end
