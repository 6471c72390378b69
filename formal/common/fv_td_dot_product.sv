// SPDX-License-Identifier: Apache-2.0
// fv_td_dot_product: a0 b0 + a1 b1, exact, of the operands of an arbitrary enabled clock, 4 enabled clocks later.

parameter int AWidth = 3, BWidth = 2;
input logic pick;

localparam int Latency = 4;

logic due;
logic signed [AWidth-1:0] a0_picked, a1_picked;
logic signed [BWidth-1:0] b0_picked, b1_picked;
follow_delay #(.Width(2 * (AWidth + BWidth)), .Latency(Latency)) u_follow (
  .clk, .rst(1'b0), .en, .pick, .in({a0, b0, a1, b1}), .due, .word({a0_picked, b0_picked, a1_picked, b1_picked})
);

always_comb begin
  if (due) begin
    exact: assert (32'(sum) == 32'(a0_picked) * 32'(b0_picked) + 32'(a1_picked) * 32'(b1_picked));
    largest: cover (sum == (AWidth + BWidth + 1)'(1 << (AWidth + BWidth - 1)));
  end
end
