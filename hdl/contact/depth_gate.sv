// SPDX-License-Identifier: Apache-2.0
// depth_gate: the way out of the depth stream; it waits for the sink, or drops frames.
//
//   drop_frames 0: the pipeline waits for the sink (en low), and nothing is lost
//   drop_frames 1: the pipeline does not wait; a frame with a word that finds no room is given up from that word on,
//                  and event_dropped is high for one cycle
//
// stalled is high while the pipeline waits for the sink, and from a frame's word that finds no room up to a frame that
// begins with room; also in the cycle after a reset.
// drop_frames counts as it is in the cycle before a frame's first word comes. Stream in: the words of whole frames,
// under en, each frame in successive enabled cycles (frame_output). Stream out: the same under valid and ready, two
// words deep, every output from a register. Latency: 1 cycle.
// `tap_` is the stream for the comparator and contact_events: each word once, in order; with 0 in the cycle in which it
// leaves, with 1 a cycle after it came, given up or not. When 0 turns to 1, words that wait for the sink are tapped
// first, one a cycle: for that alone en is low with 1, for one cycle. Cycle-accurate model:
// models/tactile_depth/chip/contact/depth_gate.py.

`default_nettype none

module depth_gate
  import td_types_pkg::*;
#(
  parameter int Width = 24
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  drop_frames,
  output logic                 en,             // of this unit
  output logic                 en_next,        // of all: `en` in the next clock, unless a reset comes
  input  wire                  in_valid,
  input  wire depth_position_t in_position,
  input  wire  [Width-1:0]     in_data,        // depth code
  output logic                 event_dropped,
  output logic                 stalled,
  output logic                 m_valid,
  input  wire                  m_ready,
  output depth_position_t      m_position,
  output logic [Width-1:0]     m_data,         // depth code
  output logic                 tap_valid,
  output depth_position_t      tap_position,
  output logic [Width-1:0]     tap_data        // depth code
);

  logic dropping;  // drop_frames, of the frame that is coming in
  logic room, tap_room;
  logic given_up, kept, leaves;
  assign kept = in_position.frame_start | ~given_up;
  assign stalled = given_up | (~dropping & ~en);
  assign event_dropped = en & in_valid & kept & ~room;
  td_axis_skid #(.Width(Width + 3)) u_out (
    .clk, .rst,
    .s_valid(en & in_valid & kept), .s_ready(room), .s_data({in_position, in_data}),
    .m_valid, .m_ready, .m_data({m_position, m_data})
  );
  assign leaves = m_valid & m_ready;

  // Words to be tapped. They go with those that leave, or by themselves; then they are ahead.
  logic tap_kept, tap_dropping, tap_waits, tap_taken;
  logic [1:0] ahead;  // words in u_out that have been tapped
  assign tap_taken = dropping | tap_dropping | (leaves & ahead == 2'd0);
  td_axis_skid #(.Width(Width + 5)) u_tap (
    .clk, .rst,
    .s_valid(en & in_valid), .s_ready(tap_room), .s_data({kept & room, dropping, in_position, in_data}),
    .m_valid(tap_waits), .m_ready(tap_taken), .m_data({tap_kept, tap_dropping, tap_position, tap_data})
  );
  assign tap_valid = tap_waits & tap_taken;

  // en is `dropping ? tap_room : room`, worked out a cycle ahead: it goes everywhere, so it comes from registers.
  logic dropping_next, room_next, tap_room_next;
  assign dropping_next = !in_valid || (en && in_position.frame_end) ? drop_frames : dropping;
  assign room_next = ~m_valid | m_ready | (room & ~(en & in_valid & kept));
  assign tap_room_next = ~tap_waits | tap_taken | (tap_room & ~(en & in_valid));
  assign en_next = dropping_next ? tap_room_next : room_next;
  td_enable u_en (.clk, .rst, .en_next, .en);

  always_ff @(posedge clk) begin
    if (en && in_valid) given_up <= ~(kept & room);
    dropping <= dropping_next;
    ahead <= ahead + 2'(tap_valid & tap_kept) - 2'(leaves);
    if (rst) begin
      given_up <= 1'b0;
      dropping <= 1'b0;
      ahead <= '0;
    end
  end

endmodule

`default_nettype wire
