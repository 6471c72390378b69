// SPDX-License-Identifier: Apache-2.0
// fv_contact_debounce: touching changes with a frame exactly if its area and those of the frames right before it, as
// many as debounce says, speak against what it was, and none of them lies before its last change.
//
// debounce is any constant up to Most; what a larger count does is the same comparison.

parameter int AreaWidth = 3;
parameter int Most = 4;

logic [7:0] debounce_q;
logic [Most-1:0] against;  // of the last frames since a reset or a change, the newest in bit 0
logic [Most-1:0] needed;
logic differs, changes, touching_q, touching_next_q, changed_q, valid_q;
assign differs = (32'(area) >= minimum_area) != touching;
assign needed = debounce == 0 ? Most'(1) : Most'((1 << debounce) - 1);
assign changes = area_valid & ((Most'({against, differs}) & needed) == needed);
always_ff @(posedge clk) begin
  debounce_q <= debounce;
  if (area_valid) against <= changes ? '0 : Most'({against, differs});
  touching_q <= touching;
  touching_next_q <= touching_next;
  valid_q <= area_valid & ~rst;
  changed_q <= changes & ~rst;
  if (rst) begin
    against <= '0;
    touching_next_q <= 1'b0;
  end
end
always_comb begin
  assume (debounce <= 8'(Most));
  if (started) assume (debounce == debounce_q);
end

always_comb begin
  if (started) begin
    in_a_row: assert (touching_next == (touching ^ changes));
    next: assert (touching == touching_next_q);
    if (valid_q) said: assert (began == (changed_q && !touching_q) && ended == (changed_q && touching_q));
    begins: cover (changes && debounce == 8'd3 && !touching);
    ends: cover (changes && debounce == 8'd3 && touching);
    too_few: cover (against == Most'(2) && debounce == 8'd2);
  end
end
