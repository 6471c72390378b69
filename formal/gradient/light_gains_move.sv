// SPDX-License-Identifier: Apache-2.0
// light_gains_move: inside the core, counts of a frame as its pixels leave, and the move when its last pixel comes. What
// else is asserted are the steps of the induction: where in the core a pixel is counted, and by which clock behind the
// last row but one each register of the move is that of its colour.

`default_nettype none

module light_gains_move #(
  parameter int Rows        = 2,
  parameter int Columns     = 10,
  parameter int GainWidth   = 5,
  parameter int OutWidth    = 6,
  parameter int OutFraction = 4,
  localparam int Pixels = (Rows - 1) * Columns,
  localparam int CountWidth = $clog2(Pixels + 1),
  localparam int NearWidth = OutFraction - 2,
  localparam int FewWidth = NearWidth + 2,
  localparam int SumWidth = OutFraction - 2 + CountWidth,
  localparam int Drop = $clog2((2 * Pixels + 2) / 3) + OutFraction - (GainWidth - 1),
  localparam int HighWidth = SumWidth - Drop + 1
) (
  input logic                        clk,
  input logic                        rst,
  input logic                        en,
  input logic [2:0]                  rate,
  input logic [2:0]                  write,
  input logic                        commits,
  input logic [3*GainWidth-1:0]      gains,
  input logic [3*GainWidth-1:0]      used,
  input logic                        in_valid,
  input logic                        free,
  input logic                        in_frame,
  input logic                        valid_q,
  input logic [3:0]                  position_q,
  input logic                        out_valid,
  input logic [3:0]                  out_position,
  input logic [3*OutWidth-1:0]       out,
  input logic                        near,
  input logic [CountWidth-1:0]       near_count,
  input logic                        near_enough,
  input logic [2:0]                  above_q,
  input logic [2:0]                  below_q,
  input logic [3*NearWidth-1:0]      deviations_q,  // of the core, by colour, as what follows
  input logic [3*FewWidth-1:0]       few_sums,
  input logic [8:0]                  few_nets,
  input logic [2:0]                  turn,
  input logic [2:0]                  clears,
  input logic signed [FewWidth-1:0]  sum_in_turn,
  input logic signed [2:0]           net_in_turn,
  input logic [3*SumWidth-1:0]       sums,
  input logic [3*CountWidth+2:0]     nets,
  input logic [2:0]                  rate_q,
  input logic [3:0]                  slow_q,
  input logic [1:0]                  slow_qq,
  input logic [SumWidth-1:0]         from_slow,
  input logic signed [HighWidth-1:0] high_q,
  input logic signed [HighWidth-1:0] high_qq,
  input logic                        rest_q,
  input logic                        rest_qq,
  input logic                        up_q,
  input logic                        up_qq,
  input logic                        down_q,
  input logic                        down_qq,
  input logic [3*(GainWidth+1)-1:0]  moved,
  input logic [2:0]                  moves_far,
  input logic                        moves,
  input logic [15:0]                 row,
  input logic [15:0]                 column
);

  localparam int Near = 1 << (OutFraction - 3);
  localparam int Least = 1 << (GainWidth - 2), Most = (1 << GainWidth) - 1;
  localparam int Step = 1 << (GainWidth - 4);
  localparam int Quiet = GainWidth > 6 ? GainWidth - 6 : 0;  // 1/32, or the last bit

  logic started = 1'b0;
  always_ff @(posedge clk) started <= 1'b1;

  // Counts of the pixels that have left, and clocks with en: since one of them counted, since gains and rate changed.

  logic [2:0] is_above, is_below, rate_before, frame_rate;
  logic is_near, begins, counts, known;
  logic [CountWidth-1:0] near_left;
  logic signed [CountWidth:0] net[3];
  logic signed [SumWidth-1:0] sum[3];
  logic [2:0] quiet, steady;
  assign begins = out_valid && (&out_position[1:0]);
  assign counts = out_valid && !out_position[2];
  assign is_near = {is_above, is_below} == '0;
  always_comb begin
    for (int c = 0; c < 3; c++) begin
      is_above[c] = int'($signed(out[c*OutWidth+:OutWidth])) >= Near;
      is_below[c] = int'($signed(out[c*OutWidth+:OutWidth])) <= -Near;
    end
  end
  always_ff @(posedge clk) begin
    rate_before <= rate;
    if (en && in_valid && row == '0 && column == '0) frame_rate <= rate_before;
    if (en) quiet <= counts ? '0 : quiet + 3'(quiet != '1);
    steady <= free || !started ? '0 : steady + 3'(en && steady != '1);
    if (en && counts) begin
      if (begins) known <= 1'b1;
      near_left <= (begins ? '0 : near_left) + CountWidth'(is_near);
      for (int c = 0; c < 3; c++) begin
        net[c] <= (begins ? '0 : net[c]) + (CountWidth + 1)'(is_above[c]) - (CountWidth + 1)'(is_below[c]);
        sum[c] <= (begins ? '0 : sum[c]) + (is_near ? SumWidth'($signed(out[c*OutWidth+:OutWidth])) : '0);
      end
    end
    if (rst || !started) {known, quiet} <= '0;
  end

  // The same in the core: pixels since a colour's last turn, the word in turn, and the ring, where a frame's first pixel
  // leaves nothing of what was before.

  logic [2:0] counted, few_fit;
  logic in_turn_fits;
  function automatic logic fits(input int value, input int pixels, input int each);
    return value >= -pixels * each && value <= pixels * each;
  endfunction
  always_comb begin
    for (int c = 0; c < 3; c++) begin
      int since, most;  // clocks since its turn, pixels since then
      logic signed [SumWidth-1:0] core_sum;
      logic signed [CountWidth:0] core_net;
      logic signed [NearWidth-1:0] deviation;
      since = turn[c] ? 3 : turn[(c+1)%3] ? 1 : 2;
      most = since - (quiet > 3'd1 ? int'(quiet) : 1);
      if (most < 0) most = 0;
      deviation = $signed(deviations_q[c*NearWidth+:NearWidth]);
      few_fit[c] = fits(int'($signed(few_sums[c*FewWidth+:FewWidth])), most, Near - 1)
          && fits(int'($signed(few_nets[3*c+:3])), most, 1) && !(above_q[c] && below_q[c])
          && fits(int'(deviation), quiet == '0 ? 1 : 0, Near - 1) && (quiet == '0 || !(above_q[c] || below_q[c]));
      core_sum = SumWidth'($signed(few_sums[c*FewWidth+:FewWidth])) + SumWidth'(deviation);
      core_net = (CountWidth + 1)'($signed(few_nets[3*c+:3])) + (CountWidth + 1)'(above_q[c])
          - (CountWidth + 1)'(below_q[c]);
      if (since == 1 && !clears[0]) begin
        core_sum = core_sum + $signed(sums[2*SumWidth+:SumWidth]) + SumWidth'(sum_in_turn);
        core_net = core_net + $signed(nets[2*(CountWidth+1)+:CountWidth+1]) + (CountWidth + 1)'(net_in_turn);
      end
      if (since == 2 && clears[1:0] == '0) begin
        core_sum = core_sum + $signed(sums[0+:SumWidth]);
        core_net = core_net + $signed(nets[0+:CountWidth+1]);
      end
      if (since == 3 && clears == '0) begin
        core_sum = core_sum + $signed(sums[SumWidth+:SumWidth]);
        core_net = core_net + $signed(nets[CountWidth+1+:CountWidth+1]);
      end
      counted[c] = core_sum == sum[c] && core_net == net[c];
    end
    in_turn_fits = fits(int'(sum_in_turn), quiet >= 3'd4 ? 0 : 3, Near - 1)
        && fits(int'(net_in_turn), quiet >= 3'd4 ? 0 : 3, 1);
  end

  // The move by the rule, and that of the core on its way: of a colour in its turn, a clock later, and when it is kept.

  int move[3], wanted[3];
  logic [2:0] move_q, in_limits, differs, far, slow_fits, begun, ready, is_kept;
  logic [3*GainWidth-1:0] wanted_q;
  always_comb begin
    for (int c = 0; c < 3; c++) begin
      int slow, total, high, mean, kept_since;
      logic up, down, rest;
      slow = int'(rate_q) + int'(int'(used[c*GainWidth+:GainWidth]) < 2 * Least - Step);
      total = int'(sum[c]) >>> slow;
      high = total >>> (Drop - 1);
      rest = total[Drop-2:0] != '0;
      mean = total >>> Drop;
      if (total[Drop-1:0] > Drop'(1 << (Drop - 1)) || (total[Drop-1:0] == Drop'(1 << (Drop - 1)) && mean[0])) begin
        mean = mean + 1;
      end
      up = 8 * int'(net[c]) <= -3 * Pixels;
      down = 8 * int'(net[c]) >= 3 * Pixels;
      move[c] = up ? -Step : down ? Step : 4 * int'(near_left) >= Pixels ? mean : 0;
      wanted[c] = int'(gains[c*GainWidth+:GainWidth]) - move[c];
      if (wanted[c] < Least) wanted[c] = Least;
      if (wanted[c] > Most) wanted[c] = Most;
      far[c] = move[c] >= (1 << Quiet) || move[c] < -(1 << Quiet);
      in_limits[c] = int'(gains[c*GainWidth+:GainWidth]) >= Least;
      differs[c] = gains[c*GainWidth+:GainWidth] != wanted_q[c*GainWidth+:GainWidth];
      slow_fits[c] = 1'b1;
      if (turn[(c+2)%3] && steady >= 3'd2) slow_fits[c] = int'(slow_q) == slow && from_slow == '1 << slow;
      if (turn[c] && steady >= 3'd3) slow_fits[c] = int'(slow_qq) == slow / 4;
      begun[c] = int'(high_q) == int'(sum[c]) >>> (Drop - 1 + slow % 4)
          && (rest_q == rest || high == -1) && {up_q, down_q} == {up, down};
      ready[c] = int'(high_qq) == high && (rest_qq == rest || high == -1) && {up_qq, down_qq} == {up, down};
      kept_since = turn[(c+1)%3] ? 3 : turn[(c+2)%3] ? 1 : 2;
      is_kept[c] = int'(quiet) < 4 + kept_since || int'(steady) < 4 + kept_since
          || (int'($signed(moved[c*(GainWidth+1)+:GainWidth+1])) == move[c] && moves_far[c] == far[c]);
    end
  end
  always_ff @(posedge clk) begin
    move_q <= commits && !rst ? ~write : '0;
    for (int c = 0; c < 3; c++) wanted_q[c*GainWidth+:GainWidth] <= GainWidth'(wanted[c]);
  end
  logic in_last_row, first_out;
  logic [15:0] pixels;  // of the frame, that have come
  assign first_out = out_valid && out_position[2:0] == 3'b011;
  assign in_last_row = row == 16'(Rows - 1);
  assign pixels = in_last_row ? 16'(Pixels) + column : column;
  always_comb begin
    if (started) begin
      one_turn: assert (turn == 3'd1 || turn == 3'd2 || turn == 3'd4);
      in_raster: assert (row < 16'(Rows) && column < 16'(Columns));
      if (known) few_pixels: assert (few_fit == '1 && (in_turn_fits || clears[0]) && (quiet == '0 || !near));
      if (known) counts_are_those: assert (counted == '1 && near_count + CountWidth'(near) == near_left);
      if (known && quiet >= 3'd2) enough: assert (near_enough == (4 * int'(near_left) >= Pixels));
      cleared: assert (!(clears[0] && quiet != '0) && !(clears[1] && quiet > 3'd1) && !(clears[2] && quiet > 3'd2));
      two_rows: assert (!(valid_q && position_q[2] && position_q[0]) && !(out_valid && out_position[2] && out_position[0]));
      shifts: assert (slow_fits == '1);
      if (known && quiet >= 3'd3 && steady >= 3'd3) begins_in_turn: assert ((begun & turn) == turn);
      if (known && quiet >= 3'd4 && steady >= 3'd4) is_ready: assert ((ready & {turn[0], turn[2:1]}) == {turn[0], turn[2:1]});
      if (known) kept: assert (is_kept == '1);
      if (pixels != '0) goes_on: assert (in_frame && rate_q == frame_rate);
      stays: assert (16'(steady) >= pixels || steady == '1);
      if (pixels == '0) none_yet: assert (!in_frame && rate_q == rate_before);
      if (in_last_row && column == 16'(Columns - 1)) told: assert (moves == (far != '0));
      if (in_last_row && column >= 16'd1) taken: assert (!(valid_q && !position_q[2]));
      if (in_last_row && column >= 16'd2) left: assert (!counts && 16'(quiet) + 16'd2 >= column);
      if (pixels == 16'd1) first_in: assert (known || (valid_q && position_q[2:0] == 3'b011) || first_out);
      if (pixels == 16'd2) first_leaves: assert (known || first_out);
      if (pixels >= 16'd3) first_counted: assert (known);
      within_limits: assert (in_limits == '1);
      moves_when_due: assert ((move_q & differs) == '0);
      steps: cover (move_q[0] && 8 * int'(net[0]) >= 3 * Pixels && out_valid);
      follows: cover (move_q[2] && near_left == CountWidth'(Pixels) && sum[2] == SumWidth'(6));
    end
  end

endmodule

`default_nettype wire
