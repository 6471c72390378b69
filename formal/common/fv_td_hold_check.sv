// SPDX-License-Identifier: Apache-2.0
// fv_td_hold_check: a word as it came is never called flipped, one with a single other bit always is, a clock later, in
// every clock but the one in which it is new. Any word, any resets.

parameter int Width = 5;

logic is_new, known, told_same, told_flipped;
logic [Width-1:0] held, apart;
assign apart = word ^ held;
always_ff @(posedge clk) begin
  is_new <= comes;
  if (is_new) {known, held} <= {1'b1, word};
  told_same <= !known || is_new || apart == '0;
  told_flipped <= known && !is_new && apart != '0 && (apart & (apart - 1'b1)) == '0 && !rst;
  if (rst) {known, told_same} <= 2'b01;
end

always_comb begin
  if (started) begin
    kept: assert (dut.known == known && (!known || dut.odd == ^held));
    newness: assert (dut.is_new == is_new);
    if (told_same) same: assert (!flipped);
    if (told_flipped) other: assert (flipped);
    flip_seen: cover (told_flipped && flipped);
    stays: cover (told_same && known && !is_new && held != '0);
  end
end
