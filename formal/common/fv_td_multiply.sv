// SPDX-License-Identifier: Apache-2.0
// fv_td_multiply: the exact product of the operands of every enabled clock stands until the next one.

parameter int AWidth = 5, BWidth = 3;

logic taken = 1'b0, held = 1'b0;
logic signed [AWidth-1:0] a_q;
logic signed [BWidth-1:0] b_q;
always_ff @(posedge clk) begin
  held <= taken & ~en;
  if (en) begin
    taken <= 1'b1;
    a_q <= a;
    b_q <= b;
  end
end

always_comb begin
  if (taken) exact: assert (32'(product) == 32'(a_q) * 32'(b_q));
  largest: cover (taken && product == (AWidth + BWidth)'(1 << (AWidth + BWidth - 2)));
  kept: cover (held && product != '0);
end
