// SPDX-License-Identifier: Apache-2.0
// fv_column_mean: mean is minus the sum of (i + 1) d[i] over the rows of a frame so far, divided by Rows, 6 enabled
// clocks behind in_next of any row; any distance of at least 6 clocks between rows, any en, frames that begin afresh.
// Rounding is proven of td_round_saturate.

parameter int Rows = 3;
localparam int Width = 3, CoeffWidth = 3, MomentDrop = 1, MeanReciprocal = 2, MeanDrop = 1;

localparam int MomentWidth = Width + 2 * $clog2(Rows) + 2, ToMean = 6;

// The sum in one step, when d is there, and then its way through the roundings.
logic [ToMean-1:0] old;  // old[n]: in_next was n + 1 enabled clocks ago
logic [$clog2(Rows+1)-1:0] row;
logic signed [MomentWidth-1:0] addend, moment;
logic signed [Width-1:0] sum, sum_q, expected, expected_q;
logic signed [Width+CoeffWidth-1:0] scaled;
td_round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
  .in(moment), .out(sum), .clipped()
);
td_round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
  .in(scaled), .out(expected), .clipped()
);
always_ff @(posedge clk) begin
  if (en) begin
    old <= ToMean'({old, in_next});
    if (in_next) row <= in_frame_start ? '0 : row + 1'b1;
    if (old[0]) addend <= MomentWidth'(32'(in_data) * (32'(row) + 1));
    if (old[1]) moment <= (row == '0 ? '0 : moment) + addend;
    if (old[2]) sum_q <= sum;
    if (old[3]) scaled <= (Width + CoeffWidth)'(-MeanReciprocal * 32'(sum_q));
    if (old[4]) expected_q <= expected;
  end
  if (rst) old <= '0;
end

always_comb begin
  if (started) begin
    if (old[ToMean-1]) mean_when_due: assert (mean == expected_q);
    of_all_rows: cover (old[ToMean-1] && 32'(row) == Rows - 2 && mean != '0 && en);
  end
end

// Protocol: rows at least 6 enabled clocks apart; a frame begins with any of them, and has at most Rows; after a
// reset none has begun. The mean counts from the row before the last one on.
module protocol_column_mean;
  localparam int Apart = 6;
  logic [2:0] left = '0;        // enabled clocks until a row may come
  logic [15:0] rows_left = '0;  // of the frame
  logic known = 1'b0;           // a mean of whole rows stands at the output
  logic [Apart-1:0] next_q = '0;
  assign holds = rst | (in_next ? left == '0 & (in_frame_start | rows_left != '0) : ~in_frame_start);
  assign counts_mean = known & ~reset & en;
  assign counts_clipped = live & ~reset;
  assign counts_flipped = live & ~reset;
  always_ff @(posedge clk) begin
    if (en) begin
      left <= in_next ? 3'(Apart - 1) : left - 3'(left != '0);
      if (in_next) rows_left <= (in_frame_start ? 16'(Rows) : rows_left) - 16'd1;
      next_q <= Apart'({next_q, in_next});
      known <= known | next_q[Apart-1];
    end
    if (reset) begin
      left <= '0;
      rows_left <= '0;
      known <= 1'b0;
      next_q <= '0;
    end
  end
endmodule
