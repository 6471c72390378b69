// SPDX-License-Identifier: Apache-2.0
// fv_flip_marks: behind a flip that counts the next Records records are marked, and no others; each flip is told once.

parameter int Records = 3;

logic known = 1'b0, any;  // a flip counts from the first record on
logic [7:0] since;  // records since the last flip; many without one
logic told, told_q;
assign any = known & flipped;
always_ff @(posedge clk) begin
  if (record_valid) known <= 1'b1;
  if (any) since <= '0;
  else if (record_valid && since != '1) since <= since + 8'd1;
  told <= any;
  told_q <= told;
  if (rst) begin
    known <= 1'b0;
    since <= '1;
    {told, told_q} <= '0;
  end
end

always_comb begin
  if (started) begin
    those_in_flight: assert (marked == (any | since < 8'(Records)));
    once: assert (found == (told & ~told_q));
    marks_end: cover (since == 8'(Records) && !marked && known);
    again: cover (found && since == 8'd0 && known);
  end
end
