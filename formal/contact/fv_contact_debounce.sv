// SPDX-License-Identifier: Apache-2.0
// fv_contact_debounce: touching changes with a frame exactly if its area and those of the frames right before it, as
// many as debounce says, speak against what it was, and none of them lies before its last change.
//
// debounce is any of its values, in each frame another: frames are counted, in one bit more.

parameter int AreaWidth = 3;

logic [8:0] against;  // frames in a row since a reset or a change, before this one
logic differs, changes, touching_q, touching_next_q, changed_q, valid_q;
assign differs = (32'(area) >= minimum_area) != touching;
assign changes = area_valid & differs & (against + 9'd1 >= 9'(debounce));
always_ff @(posedge clk) begin
  if (area_valid) against <= differs && !changes ? against + 9'd1 : '0;
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
  if (started) begin
    in_a_row: assert (touching_next == (touching ^ changes));
    next: assert (touching == touching_next_q);
    if (valid_q) said: assert (began == (changed_q && !touching_q) && ended == (changed_q && touching_q));
    begins: cover (changes && debounce == 8'd3 && !touching);
    ends: cover (changes && debounce == 8'd3 && touching);
    too_few: cover (area_valid && !differs && against == 9'd2 && debounce == 8'd3);
  end
end
