// SPDX-License-Identifier: Apache-2.0
// fv_contact_events: a record Latency clocks after the last depth of each frame, kept until the next; touching moves
// only 3 clocks after a last depth, and the record says so; packets are whole, in order, each the record that stood
// when
// it began; stable under stall; a record is sent, or waits, or is lost and said so.
//
// Whatever frames come, one may begin inside another; their last depths lie at least Latency clocks apart, as the core
// asks. So the frames here may be smaller than those that need no gaps for that. What is in a record is left to
// simulation, against numpy.

module fv_contact_events #(
  parameter int Width   = 2,
  parameter int Rows    = 3,
  parameter int Columns = 4,
  parameter int Latency = 20  // models/tactile_depth/contact/contact_events.py
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    in_valid,
  input logic                    restart,
  input logic signed [Width-1:0] in_data,
  input logic [31:0]             in_time,
  input logic signed [31:0]      on_threshold,
  input logic signed [31:0]      off_threshold,
  input logic [31:0]             minimum_area,
  input logic [7:0]              debounce,
  input logic                    m_event_tready,
  input logic [3:0]              pick
);

  localparam int Words = 13;
  localparam int Pixels = Rows * Columns;
  localparam int PlaceWidth = $clog2(Pixels);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_user, in_last, in_frame_end, touching, record_valid, event_lost, m_event_tvalid, m_event_tlast;
  logic [32*Words-1:0] record;
  logic [31:0] m_event_tdata;
  contact_events #(.Width(Width), .Rows(Rows), .Columns(Columns)) dut (
    .clk, .rst, .in_valid, .in_user, .in_last, .in_frame_end, .in_data, .in_time, .on_threshold, .off_threshold,
    .minimum_area, .debounce, .touching, .record_valid, .record, .event_lost, .m_event_tdata, .m_event_tvalid,
    .m_event_tready, .m_event_tlast
  );

  logic [PlaceWidth-1:0] next_place, place;
  assign in_user = restart | (next_place == '0);
  assign place = in_user ? '0 : next_place;
  assign in_last = place % PlaceWidth'(Columns) == PlaceWidth'(Columns - 1);
  assign in_frame_end = place == PlaceWidth'(Pixels - 1);

  // When a record is due, and what it was when a packet of it began: one bit of a word, since words are sent alike.
  logic [Latency-1:0] due;
  logic [32*Words-1:0] record_q;
  logic [3:0] watched, word;
  logic waits, offered, stalled, stalled_last, was_reset, packet_ends, first_bit, sent_bit, touching_q;
  logic [31:0] stalled_data;
  assign packet_ends = m_event_tvalid & m_event_tready & m_event_tlast;
  assign first_bit = 1'(record_q >> {watched, 5'd0});

  always_ff @(posedge clk) begin
    started <= 1'b1;
    was_reset <= rst;
    if (in_valid) next_place <= in_frame_end ? '0 : place + PlaceWidth'(1);
    due <= Latency'({due, in_valid & in_frame_end});
    record_q <= record;
    touching_q <= touching;
    waits <= due[Latency-2] | (waits & m_event_tvalid & ~packet_ends);
    offered <= m_event_tvalid & ~packet_ends;
    stalled <= m_event_tvalid & ~m_event_tready;
    stalled_data <= m_event_tdata;
    stalled_last <= m_event_tlast;
    if (m_event_tvalid && !offered) sent_bit <= first_bit;
    if (m_event_tvalid && m_event_tready) word <= m_event_tlast ? 4'd0 : word + 4'd1;
    if (!m_event_tvalid) watched <= pick;
    if (rst) begin
      next_place <= '0;
      due <= '0;
      waits <= 1'b0;
      offered <= 1'b0;
      stalled <= 1'b0;
      word <= '0;
    end
  end
  always_comb begin
    assume (pick < 4'(Words));
    if (due[Latency-2:0] != '0) assume (!(in_valid && in_frame_end));
  end

  always_comb begin
    if (started) begin
      record_due: assert (record_valid == due[Latency-1]);
      if (!record_valid && !was_reset) keeps: assert (record == record_q);
      if (!was_reset && !due[2]) between_frames: assert (touching == touching_q);
      if (record_valid) begin
        status: assert (record[0] == touching && !(record[1] && !touching) && !(record[2] && touching));
      end
      if (was_reset) quiet: assert (!m_event_tvalid && !touching && record == '0);
      if (stalled) stable: assert (m_event_tvalid && m_event_tdata == stalled_data && m_event_tlast == stalled_last);
      if (offered) whole_packet: assert (m_event_tvalid);
      if (m_event_tvalid) begin
        last_of_packet: assert (m_event_tlast == (word == 4'(Words - 1)));
        if (word == watched) as_it_was: assert (m_event_tdata[0] == (offered ? sent_bit : first_bit));
      end
      lost_and_said: assert (event_lost == (due[Latency-2] & waits & m_event_tvalid & ~packet_ends));
      sent_if_free: assert (m_event_tvalid || !waits || due[Latency-1]);
      begins: cover (record_valid && record[1]);
      ends: cover (record_valid && record[2]);
      slow: cover (event_lost && word == 4'd1);
      next_follows: cover (waits && packet_ends);
    end
  end

endmodule
