// SPDX-License-Identifier: Apache-2.0
// test_picture: passes a stream of pixels on, and between two of its frames a pseudo-random picture of its own.
//
//   pixel = state = {R, B, G};  state' = {state[11:0], state[23:12] ^ state[22:11] ^ state[21:10] ^ state[16:5]}
//
// `request` asks for one picture. It begins, with the state Seed, as soon as `between` is high, which says that the
// guard behind has no frame open; until its last pixel is taken the stream in waits. A request before then changes
// nothing. A source that never ends its frame keeps the picture waiting, unless the guard gives the frame up.
// Stream in, stream out: AXI4-Stream Video, ready/valid; m_test is high with the picture, which has marks of rows and
// frames. Latency: 0 cycles. Cycle-accurate model: models/tactile_depth/chip/video/test_picture.py.

`default_nettype none

module test_picture #(
  parameter logic [23:0] Seed = 24'h4F5CCF
) (
  input  wire         clk,
  input  wire         rst,
  input  wire         request,
  input  wire         between,     // no frame is open behind m_ready
  input  wire         row_ends,    // the pixel that is taken next is the last of a row
  input  wire         frame_ends,  // .. of a frame
  input  wire         s_valid,
  output logic        s_ready,
  input  wire  [23:0] s_data,    // three codes of 8 bits
  input  wire         s_last,
  input  wire         s_user,
  output logic        m_valid,
  input  wire         m_ready,
  output logic [23:0] m_data,    // as s_data
  output logic        m_last,
  output logic        m_user,
  output logic        m_test
);

  logic waiting, begun;  // a picture is asked for; its first pixel was taken
  logic [23:0] state;
  assign m_test = waiting & (begun | between);
  assign m_valid = m_test | s_valid;
  assign s_ready = m_ready & ~m_test;
  assign m_data = m_test ? state : s_data;
  assign m_last = m_test ? row_ends : s_last;
  assign m_user = m_test ? ~begun : s_user;

  logic taken, ends;
  assign taken = m_test & m_ready;
  assign ends = taken & frame_ends;
  always_ff @(posedge clk) begin
    waiting <= request | (waiting & ~ends);
    begun <= (begun | taken) & ~ends;
    if (taken) state <= {state[11:0], state[23:12] ^ state[22:11] ^ state[21:10] ^ state[16:5]};
    if (ends | ~waiting) state <= Seed;
    if (rst) {waiting, begun} <= '0;
  end

endmodule

`default_nettype wire
