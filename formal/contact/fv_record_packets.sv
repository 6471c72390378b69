// SPDX-License-Identifier: Apache-2.0
// fv_record_packets: the newest record stands in its register; packets are whole, in order, each the record that stood
// when it began; stable under stall; a record is sent, or waits, or is lost and said so.
//
// New records come in any clock. One bit of an arbitrary word is watched, since words are sent alike.

parameter int Words = 15;
input logic [3:0] pick;

logic [32*Words-1:0] newest, record_q;
logic [3:0] watched, word;
logic new_q, waits, offered, was_reset, packet_ends, first_bit, sent_bit;
assign packet_ends = m_event_tvalid & m_event_tready & m_event_tlast;
assign first_bit = 1'(record_q >> {watched, 5'd0});

always_ff @(posedge clk) begin
  was_reset <= rst;
  new_q <= new_valid;
  if (new_valid) newest <= new_record;
  record_q <= record;
  waits <= new_valid | (waits & m_event_tvalid & ~packet_ends);
  offered <= m_event_tvalid & ~packet_ends;
  if (m_event_tvalid && !offered) sent_bit <= first_bit;
  if (m_event_tvalid && m_event_tready) word <= m_event_tlast ? 4'd0 : word + 4'd1;
  if (!m_event_tvalid) watched <= pick;
  if (rst) begin
    new_q <= 1'b0;
    newest <= '0;
    waits <= 1'b0;
    offered <= 1'b0;
    word <= '0;
  end
end
always_comb assume (pick < 4'(Words));

offer_stays u_m_event_t (.*);
always_comb begin
  if (started) begin
    in_time: assert (record_valid == new_q);
    kept: assert (record == newest);
    if (was_reset) quiet: assert (!m_event_tvalid);
    if (offered) whole_packet: assert (m_event_tvalid);
    if (m_event_tvalid) begin
      last_of_packet: assert (m_event_tlast == (word == 4'(Words - 1)));
      if (word == watched) as_it_was: assert (m_event_tdata[0] == (offered ? sent_bit : first_bit));
    end
    lost_and_said: assert (record_lost == (new_valid & waits & m_event_tvalid & ~packet_ends));
    sent_if_free: assert (m_event_tvalid || !waits || new_q);
    slow: cover (record_lost && word == 4'd1);
    next_follows: cover (waits && packet_ends);
  end
end
