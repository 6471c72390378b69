// SPDX-License-Identifier: Apache-2.0
// fv_td_enable: what was told in the clock before, and 0 behind a reset.

logic told;
always_ff @(posedge clk) told <= en_next & ~rst;

always_comb begin
  if (started) begin
    as_told: assert (en == told);
    moves: cover (en);
    waits: cover (!en && en_next);
  end
end
