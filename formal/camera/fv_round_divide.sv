// SPDX-License-Identifier: Apache-2.0
// fv_round_divide: the mean is the nearest integer, ties to even, clipped to 0..255; 10 enabled clocks later.

parameter int TotalWidth = 13, WeightWidth = 2, Drop = 3;

localparam int Latency = 10, Wide = TotalWidth + WeightWidth + Drop + 2;

typedef logic signed [Wide-1:0] wide_t;

always_comb assume (u_protocol.allowed);

// The operands of the present mean.
logic [Latency*TotalWidth-1:0] totals;
logic [Latency*WeightWidth-1:0] weights;
logic [3:0] age = '0;
always_ff @(posedge clk) begin
  if (en) begin
    totals <= {totals[(Latency-1)*TotalWidth-1:0], total};
    weights <= {weights[(Latency-1)*WeightWidth-1:0], weight};
    if (age != 4'(Latency)) age <= age + 4'd1;
  end
end

wide_t numerator, divisor, error;  // 2 (total - mean divisor)
assign numerator = wide_t'($signed(totals[Latency*TotalWidth-1-:TotalWidth]));
assign divisor = wide_t'({1'b0, weights[Latency*WeightWidth-1-:WeightWidth]}) <<< Drop;
assign error = (numerator - wide_t'({1'b0, mean}) * divisor) <<< 1;
always_comb begin
  if (age == 4'(Latency)) begin
    not_above: assert (mean == 8'd0 || error >= -divisor);
    not_below: assert (mean == 8'd255 || error <= divisor);
    ties: assert (mean == 8'd0 || mean == 8'd255 || (error != divisor && error != -divisor) || !mean[0]);
    tie_up: cover (error == -divisor && mean == 8'd2);
    tie_down: cover (error == divisor && mean == 8'd2);
    white: cover (mean == 8'd255 && error > divisor);
    black: cover (mean == 8'd0 && error < -divisor);
    rounded_to_white: cover (mean == 8'd255 && error < 0 && error > -divisor);
  end
end
