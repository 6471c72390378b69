// SPDX-License-Identifier: Apache-2.0
// light_gains_move: inside the core, counts of a frame as its pixels leave, and the move when its last pixel comes. What
// else is asserted are the steps of the induction: the core counts one clock later, and prepares the move while the last
// row comes.

`default_nettype none

module light_gains_move #(
  parameter int Rows        = 2,
  parameter int Columns     = 8,
  parameter int GainWidth   = 5,
  parameter int OutWidth    = 6,
  parameter int OutFraction = 4
) (
  input logic                       clk,
  input logic                       rst,
  input logic                       en,
  input logic [2:0]                 rate,
  input logic [2:0]                 write,
  input logic                       commits,
  input logic [3*GainWidth-1:0]     gains,
  input logic [3*GainWidth-1:0]     used,
  input logic                       free,
  input logic                       in_frame,
  input logic                       valid_q,
  input logic [3:0]                 position_q,
  input logic                       out_valid,
  input logic [3:0]                 out_position,
  input logic [3*OutWidth-1:0]      out,
  input logic                       counts,
  input logic                       restart,
  input logic [3:0]                 near_count,
  input logic [2:0]                 above,
  input logic [2:0]                 below,
  input logic [14:0]                nets,          // of the core, by colour, as what follows
  input logic [17:0]                sums,
  input logic [3*OutWidth-1:0]      deviations_q,
  input logic [17:0]                slowed,
  input logic [2:0]                 up,
  input logic [2:0]                 down,
  input logic                       near_enough,
  input logic [3*(GainWidth+1)-1:0] moved,
  input logic                       moves,
  input logic [15:0]                row,
  input logic [15:0]                column
);

  localparam int Pixels = (Rows - 1) * Columns;
  localparam int Near = 1 << (OutFraction - 3);
  localparam int SumLog2 = $clog2((2 * Pixels + 2) / 3);
  localparam int Drop = SumLog2 + OutFraction - (GainWidth - 1);
  localparam int Least = 1 << (GainWidth - 2), Most = (1 << GainWidth) - 1;
  localparam int Step = 1 << (GainWidth - 4);
  localparam int Quiet = GainWidth > 6 ? GainWidth - 6 : 0;  // 1/32, or the last bit

  logic started = 1'b0;
  always_ff @(posedge clk) started <= 1'b1;

  // Counts of the pixels that have left, and of the core with the pixel that it has not counted yet.

  logic [2:0] is_above, is_below, rate_q;
  logic is_near, begins, known;
  logic [3:0] near, core_near;
  logic signed [4:0] net[3], core_net[3];
  logic signed [5:0] sum[3], core_sum[3];
  logic [1:0] quiet;  // clocks since the core counted
  logic [1:0] steady;  // clocks since the gains of the frame could change
  always_comb begin
    for (int c = 0; c < 3; c++) begin
      is_above[c] = int'($signed(out[c*OutWidth+:OutWidth])) >= Near;
      is_below[c] = int'($signed(out[c*OutWidth+:OutWidth])) <= -Near;
      core_net[c] = counts && restart ? '0 : $signed(nets[5*c+:5]);
      core_sum[c] = counts && restart ? '0 : $signed(sums[6*c+:6]);
      if (counts) core_net[c] = core_net[c] + 5'(above[c]) - 5'(below[c]);
      if (counts && {above, below} == '0) core_sum[c] = core_sum[c] + $signed(deviations_q[c*OutWidth+:OutWidth]);
    end
    core_near = (counts && restart ? '0 : near_count) + 4'(counts && {above, below} == '0);
  end
  assign is_near = {is_above, is_below} == '0;
  assign begins = &out_position[1:0];
  always_ff @(posedge clk) begin
    rate_q <= rate;
    quiet <= en && counts ? '0 : quiet + 2'(quiet != '1);
    steady <= free || rst || !started ? '0 : steady + 2'(steady != '1);
    if (en && out_valid && !out_position[2]) begin
      if (begins) known <= 1'b1;
      near <= (begins ? '0 : near) + 4'(is_near);
      for (int c = 0; c < 3; c++) begin
        net[c] <= (begins ? '0 : net[c]) + 5'(is_above[c]) - 5'(is_below[c]);
        sum[c] <= (begins ? '0 : sum[c]) + (is_near ? $signed(out[c*OutWidth+:OutWidth]) : '0);
      end
    end
    if (rst || !started) known <= 1'b0;
  end

  // The move by the rule.

  int move[3], wanted[3];
  logic [2:0] move_q, differs, counts_agree, compared_agrees, moves_agree, far;
  logic [3*GainWidth-1:0] wanted_q;
  always_comb begin
    assume (!started || rate == rate_q);  // a move is prepared before the last pixel comes
    for (int c = 0; c < 3; c++) begin
      int total, mean;
      total = int'(sum[c]) >>> (int'(rate) + int'(int'(used[c*GainWidth+:GainWidth]) < 2 * Least - Step));
      mean = total >>> Drop;
      if (total[Drop-1:0] > Drop'(1 << (Drop - 1)) || (total[Drop-1:0] == Drop'(1 << (Drop - 1)) && mean[0])) begin
        mean = mean + 1;
      end
      move[c] = 0;
      if (8 * int'(net[c]) >= 3 * Pixels) move[c] = Step;
      else if (8 * int'(net[c]) <= -3 * Pixels) move[c] = -Step;
      else if (4 * int'(near) >= Pixels) move[c] = mean;
      wanted[c] = int'(gains[c*GainWidth+:GainWidth]) - move[c];
      if (wanted[c] < Least) wanted[c] = Least;
      if (wanted[c] > Most) wanted[c] = Most;
      counts_agree[c] = core_net[c] == net[c] && core_sum[c] == sum[c];
      compared_agrees[c] = int'($signed(slowed[6*c+:6])) == total && up[c] == (8 * int'(net[c]) <= -3 * Pixels)
          && down[c] == (8 * int'(net[c]) >= 3 * Pixels) && near_enough == (4 * int'(near) >= Pixels);
      moves_agree[c] = int'($signed(moved[c*(GainWidth+1)+:GainWidth+1])) == move[c];
      far[c] = move[c] >= (1 << Quiet) || move[c] < -(1 << Quiet);
      differs[c] = gains[c*GainWidth+:GainWidth] != wanted_q[c*GainWidth+:GainWidth];
    end
  end
  always_ff @(posedge clk) begin
    move_q <= commits && !rst ? ~write : '0;
    for (int c = 0; c < 3; c++) wanted_q[c*GainWidth+:GainWidth] <= GainWidth'(wanted[c]);
  end
  logic in_last_row, first_out;
  assign first_out = out_valid && out_position[2:0] == 3'b011;
  assign in_last_row = row == 16'(Rows - 1);
  always_comb begin
    if (started) begin
      if (known) counts_are_those: assert (counts_agree == '1 && core_near == near);
      if (known && !counts && quiet >= 2'd1 && steady >= 2'd1) compared: assert (compared_agrees == '1);
      if (known && !counts && quiet >= 2'd2 && steady >= 2'd2) moves_are_those: assert (moves_agree == '1);
      if (row != '0 || column >= 16'd1) goes_on: assert (in_frame);
      if (row != '0 || column >= 16'd2) stays: assert (steady >= 2'd1);
      if (row != '0 || column >= 16'd3) stayed: assert (steady >= 2'd2);
      if (in_last_row && column == 16'(Columns - 1)) told: assert (moves == (far != '0));
      if (in_last_row && column >= 16'd1) taken: assert (!(valid_q && !position_q[2]));
      if (in_last_row && column >= 16'd2) left: assert (!(out_valid && !out_position[2]));
      if (in_last_row && column >= 16'd3) counted: assert (!counts);
      if (row == '0 && column == 16'd1) first_in: assert (known || (valid_q && position_q[2:0] == 3'b011) || first_out);
      if (row == '0 && column == 16'd2) first_leaves: assert (known || first_out);
      if (row != '0 || column >= 16'd3) first_counted: assert (known);
      if (in_last_row && column >= 16'd4) settles: assert (quiet >= 2'd1);
      if (in_last_row && column >= 16'd5) settled: assert (quiet >= 2'd2);
      moves_when_due: assert ((move_q & differs) == '0);
      steps: cover (move_q[0] && 8 * int'(net[0]) >= 3 * Pixels && out_valid);
      follows: cover (move_q[2] && near == 4'(Pixels) && sum[2] == 6'd6);
    end
  end

endmodule

`default_nettype wire
