// SPDX-License-Identifier: Apache-2.0
// fv_contact_events: a record Latency clocks after the last depth of each frame, kept until the next; touching moves
// only 3 clocks after a last depth, and the record says so; in it are the number of the frame, the time of its first
// depth and the flags at its last.
//
// Sums, decision, centroid and packets are proven of the cores in it.

parameter int Width = 2, Rows = 4, Columns = 8;
parameter int Latency = 28;  // models/tactile_depth/chip/contact/contact_events.py

// When a record is due, and what it says of its frame.
logic [Latency-1:0] due;
logic [32*Words-1:0] record_q;
logic [31:0] number, begun, begun_last;
frame_flags_t flags_last;
logic has_ended = 1'b0;
logic was_reset, touching_q;
always_ff @(posedge clk) begin
  was_reset <= rst;
  if (in_valid) begin
    if (in_position.frame_start) begun <= in_time;
    if (in_position.frame_end) {begun_last, flags_last, has_ended} <= {begun, in_flags, 1'b1};
  end
  due <= Latency'({due, in_valid & in_position.frame_end});
  if (due[1]) number <= number + 32'd1;
  record_q <= record;
  touching_q <= touching;
  if (rst) begin
    due <= '0;
    number <= '0;
  end
end

logic [Latency-1:0] early;
for (genvar n = 0; n < Latency; n++) begin : g_early
  assign early[n] = due[n] && 32'(u_protocol.u_depth_frames.next_place) > n;
end
always_comb begin
  if (started) begin
    // Behind the proof: frames of so many depths are Latency clocks long; flags stand between last beats.
    apart: assert (early == '0);
    if (has_ended) stands: assert (dut.last_flags == flags_last);
    record_due: assert (record_valid == due[Latency-1]);
    if (!record_valid && !was_reset) keeps: assert (record == record_q);
    if (!was_reset && !due[2]) between_frames: assert (touching == touching_q);
    if (record_valid) begin
      status: assert (record[0] == touching && !(record[1] && !touching) && !(record[2] && touching));
      of_frame: assert (record[63:32] == number && record[95:64] == begun_last);
      flags_of_frame: assert (record[32*Words-1-:96] == flags_last);
    end
    if (was_reset) quiet: assert (!m_event_tvalid && !touching && record == '0);
    begins: cover (record_valid && record[1]);
    ends: cover (record_valid && record[2]);
    sends: cover (m_event_tvalid && m_event_tready && m_event_tlast);
  end
end
