// SPDX-License-Identifier: Apache-2.0
// fv_td_axis_skid: nothing lost, repeated, reordered or changed; outputs stable under stall; a word offered one clock
// after it was taken; ready whenever there is room.
//
// One arbitrary word is followed: `pick` is free, so it may be any. Nothing is assumed of the source, which may even
// withdraw a word that it offered.

parameter int Width = 1;
input logic pick;

logic taken, left;
assign taken = s_valid & s_ready;
assign left = m_valid & m_ready;

logic [2:0] held;  // words inside
logic following, fresh;
logic [2:0] ahead;  // words that leave before the one followed
logic [Width-1:0] value;
logic [2:0] passed;  // words that left, to show how far a trace goes
always_ff @(posedge clk) begin
  fresh <= rst;
  held <= held + 3'(taken) - 3'(left);
  passed <= passed + 3'(left && passed != 3'd7);
  if (!following) begin
    following <= pick & taken;
    ahead <= held - 3'(left);
    value <= s_data;
  end else if (left) begin
    following <= ahead != 3'd0;
    ahead <= ahead - 3'd1;
  end
  if (rst) begin
    held <= '0;
    passed <= '0;
    following <= 1'b0;
  end
end

offer_stays u_m_ (.*);
always_comb begin
  if (started) begin
    capacity: assert (held <= 3'd2);
    offered: assert (m_valid == (held != 3'd0));  // at once, and nothing out of nothing
    ready: assert (s_ready == (held != 3'd2 && !fresh));
    if (following && ahead == 3'd0) in_place: assert (m_data == value);
    full: cover (held == 3'd2 && following && ahead == 3'd1);
    streams: cover (passed == 3'd7 && left && taken);
    drains: cover (passed == 3'd7 && held == 3'd0 && !following);
  end
end
