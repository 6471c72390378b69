// SPDX-License-Identifier: Apache-2.0
// fv_depth_gate: of a frame that waits every word leaves; of one that does not, the first ones up to a word that finds
// no room, and then event_dropped is high, once; in order, unchanged, stable under stall. Every word that comes is
// tapped once and in order: of a frame that does not wait in the clock after it came; of one that does no later than it
// leaves, and sooner only when the next frame does not wait. With such a frame en is high, but for the first clock.
//
// One arbitrary word is followed: `pick` is free. drop_frames and m_ready move freely.

parameter int Width = 1;
input logic pick;

// What is given to the output: as long as its two places and the frame allow.
logic drops, refused, moves, room, given, leaves;  // `drops`: of the frame that is, or would be, present
logic fresh;
logic [1:0] held, untapped;  // words that have not left, that have not been tapped
assign moves = en & in_valid;
assign room = (held != 2'd2) & ~fresh;
assign given = moves & room & (in_position.frame_start | ~refused);
assign leaves = m_valid & m_ready;

logic [Width+2:0] word, value, sent, tapped;
assign word = {in_position, in_data};
assign sent = {m_position, m_data};
assign tapped = {tap_position, tap_data};

logic en_told, drops_q, came_dropping, follows_out, follows_tap, waits, forced;
logic [1:0] ahead_out, ahead_tap;  // words before the one followed
logic leaves_now, tapped_now;
assign leaves_now = follows_out & (ahead_out == 2'd0) & leaves;
assign tapped_now = follows_tap & (ahead_tap == 2'd0) & tap_valid;
always_ff @(posedge clk) begin
  fresh <= rst;
  en_told <= en_next & ~rst;
  if (moves) refused <= ~given;
  if (!in_valid || (moves && in_position.frame_end)) drops <= drop_frames;
  drops_q <= drops;
  came_dropping <= moves & drops;
  held <= held + 2'(given) - 2'(leaves);
  untapped <= untapped + 2'(moves) - 2'(tap_valid);
  if (!follows_out && !follows_tap) begin
    follows_tap <= moves & pick;
    follows_out <= given & pick;
    ahead_tap <= untapped - 2'(tap_valid);
    ahead_out <= held - 2'(leaves);
    value <= word;
    waits <= ~drops;
  end else begin
    if (tap_valid) follows_tap <= follows_tap & ~tapped_now;
    if (tap_valid) ahead_tap <= ahead_tap - 2'd1;
    if (leaves) follows_out <= follows_out & ~leaves_now;
    if (leaves) ahead_out <= ahead_out - 2'd1;
  end
  if (rst) begin
    drops <= 1'b0;
    drops_q <= 1'b0;
    came_dropping <= 1'b0;
    refused <= 1'b0;
    held <= '0;
    untapped <= '0;
    follows_out <= 1'b0;
    follows_tap <= 1'b0;
  end
end
assign forced = waits & drops;  // it has waited, but what comes now does not

offer_stays u_m_ (.*);
always_comb begin
  if (started) begin
    enable_as_told: assert (en == en_told);
    enable_is_room: assert (dut.en == (dut.dropping ? dut.tap_room : dut.room));
    offered: assert (m_valid == (held != 2'd0));
    if (follows_out && ahead_out == 2'd0) in_place: assert (sent == value);
    says_that_it_waits: assert (stalled == (refused || (!drops && !en)));
    said: assert (event_dropped == (moves & ~given & (in_position.frame_start | ~refused)));
    if (!drops) nothing_refused: assert (!moves || given);
    if (drops && drops_q && !fresh) never_waits: assert (en);
    if (!drops) waits_for_room: assert (en == room);
    no_tap_of_nothing: assert (!tap_valid || untapped != 2'd0);
    if (tapped_now) as_it_came: assert (tapped == value);
    if (came_dropping) seen_at_once: assert (tap_valid && untapped == 2'd1);
    if (leaves_now) no_later: assert (!follows_tap || tapped_now);
    if (tapped_now && waits && !forced) no_sooner: assert (leaves_now);
    cut: cover (event_dropped && !in_position.frame_start && follows_out);
    whole_dropped: cover (event_dropped && in_position.frame_start && held == 2'd2);
    two_stand: cover (drops && !en && follows_tap && ahead_tap == 2'd1);
    seen_before: cover (leaves_now && !follows_tap && !drops && waits && held == 2'd2 && untapped == 2'd1);
    recovers: cover (leaves && m_position.frame_end && refused && drops);
  end
end

// Protocol: frames of any number of words, in successive enabled clocks; after a reset the first word is a frame's
// first, in a reset too. A word stays while en is low.
module protocol_depth_gate;
  logic open = 1'b0, stays = 1'b0;
  logic [Width+2:0] word, word_before;
  assign word = {in_position, in_data};
  assign holds = (in_valid | ~open) & (~in_valid | in_position[2] == ~open)
      & (~stays | (in_valid & word == word_before));
  always_ff @(posedge clk) begin
    if (reset) open <= 1'b0;
    else if (en && in_valid) open <= ~in_position[0];
    stays <= in_valid & ~en & ~reset;
    word_before <= word;
  end
  assign counts = live & ~reset;
  assign {counts_m_position, counts_m_data} = {2{counts & m_valid}};
  assign {counts_tap_position, counts_tap_data} = {2{counts & tap_valid}};
endmodule
