// SPDX-License-Identifier: Apache-2.0
// depth_gate: the way out of the depth stream, and what a sink costs that does not take it.
//
//   drop_frames 0: the pipeline waits (en low), nothing is lost
//   drop_frames 1: it does not; a frame with a word that finds no room is given up: what left of it has left, the rest
//                  does not follow, and event_dropped is high for a clock. The next frame leaves from its first word
//                  on if that finds room, else it is given up whole.
//
// drop_frames counts as it is in the clock before a frame's first word comes. Stream in: the words of whole frames,
// under en, each frame in successive enabled clocks (frame_output). Stream out: the same under valid and ready, two
// words deep, latency 1, every output from a register; a word offered stays until it is taken. `look_` is the stream as
// the comparator and contact_events see it: each word once, in order; with 0 in the clock in which it leaves, with 1 a
// clock after it came, which is when it would leave, be it given up or not. Words that a sink has left standing when 0
// turns to 1 are looked at first, one a clock: for that, and for nothing else, en is low with 1, for one clock.
// Cycle-accurate model: models/tactile_depth/frame/depth_gate.py.

module depth_gate #(
  parameter int Width = 24
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             drop_frames,
  output logic             en,
  input  logic             in_valid,
  input  logic             in_user,       // first word of a frame
  input  logic             in_last,       // last word of a row
  input  logic             in_frame_end,  // last word of a frame
  input  logic [Width-1:0] in_data,
  output logic             event_dropped,
  output logic             m_valid,
  input  logic             m_ready,
  output logic             m_user,
  output logic             m_last,
  output logic             m_frame_end,
  output logic [Width-1:0] m_data,
  output logic             look_valid,
  output logic             look_user,
  output logic             look_last,
  output logic             look_frame_end,
  output logic [Width-1:0] look_data
);

  logic dropping;  // drop_frames, of the frame that is coming in
  logic room, look_room;
  logic given_up, give, unlooked, leaves;
  assign give = in_user | ~given_up;
  assign event_dropped = en & in_valid & give & ~room;
  axis_skid #(.Width(Width + 3)) u_out (
    .clk, .rst,
    .s_valid(en & in_valid & give), .s_ready(room), .s_data({in_user, in_last, in_frame_end, in_data}),
    .m_valid, .m_ready, .m_data({m_user, m_last, m_frame_end, m_data})
  );
  assign leaves = m_valid & m_ready;

  // Words to be looked at. They go with those that leave, or by themselves; then they are ahead.
  logic look_given, look_dropping, look_waits, look_now;
  logic [1:0] ahead;  // words in u_out that have been looked at
  assign unlooked = ahead == 2'd0;
  assign look_now = dropping | look_dropping | (leaves & unlooked);
  axis_skid #(.Width(Width + 5)) u_look (
    .clk, .rst,
    .s_valid(en & in_valid), .s_ready(look_room),
    .s_data({give & room, dropping, in_user, in_last, in_frame_end, in_data}),
    .m_valid(look_waits), .m_ready(look_now),
    .m_data({look_given, look_dropping, look_user, look_last, look_frame_end, look_data})
  );
  assign look_valid = look_waits & look_now;

  // en is `dropping ? look_room : room`, worked out a clock ahead: it goes everywhere, so it comes from a register.
  logic dropping_next, room_next, look_room_next;
  assign dropping_next = !in_valid || (en && in_frame_end) ? drop_frames : dropping;
  assign room_next = ~m_valid | m_ready | (room & ~(en & in_valid & give));
  assign look_room_next = ~look_waits | look_now | (look_room & ~(en & in_valid));

  always_ff @(posedge clk) begin
    if (en && in_valid) given_up <= ~(give & room);
    dropping <= dropping_next;
    en <= dropping_next ? look_room_next : room_next;
    ahead <= ahead + 2'(look_valid & look_given) - 2'(leaves);
    if (rst) begin
      dropping <= 1'b0;
      en <= 1'b0;
      ahead <= '0;
    end
  end

endmodule
