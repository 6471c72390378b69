// SPDX-License-Identifier: Apache-2.0
// fv_column_mean: mean is minus the sum of (i + 1) d[i] over the rows of a frame so far, divided by Rows, 6 enabled
// clocks behind in_next of any row; any distance of at least 6 clocks between rows, any en, frames that begin afresh.
// Rounding is proven of td_round_saturate.

parameter int Rows = 3;
localparam int Width = 3;
localparam int CoeffWidth = 3;
localparam int MomentDrop = 1;
localparam int MeanReciprocal = 2;
localparam int MeanDrop = 1;

localparam int MomentWidth = Width + 2 * $clog2(Rows) + 2;
localparam int ToMean = 6;

protocol_column_mean #(.Rows(Rows)) u_protocol (
  .clk, .rst, .en, .in_next, .in_frame_start, .holds(allowed)
);

// The sum in one step, when d is there, and then its way through the roundings.
logic [ToMean-1:0] old;  // old[n]: in_next was n + 1 enabled clocks ago
logic [$clog2(Rows+1)-1:0] row;
logic signed [MomentWidth-1:0] addend, moment;
logic signed [Width-1:0] sum, sum_q, expected, expected_q;
logic signed [Width+CoeffWidth-1:0] scaled;
logic [1:0] unused_clipped;
td_round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
  .in(moment), .out(sum), .clipped(unused_clipped[0])
);
td_round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
  .in(scaled), .out(expected), .clipped(unused_clipped[1])
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
