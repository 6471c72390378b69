// SPDX-License-Identifier: Apache-2.0
// fv_contact_events: a record Latency clocks after the last depth of each frame, kept until the next; touching moves
// only 3 clocks after a last depth, and the record says so; in it are the number of the frame, the time of its first
// depth and the flags at its last, with those that come with the record.
//
// Sums, decision, centroid, packets and the delay of the positions are proven of the cores in it.

parameter int Width = 2, Rows = 4, Columns = 8;
parameter int Latency = 28;  // models/tactile_depth/chip/contact/contact_events.py

localparam int ToCount = 2, ToPeak = 3, ToLate = 6, ToSums = ToLate + 2;  // clocks from a last depth
localparam int ToDivision = ToSums + 2, Division = (Latency - ToDivision) / 2;  // of two, one after the other

// When a record is due, and what it says of its frame.
logic [Latency-1:0] due;
logic [32*Words-1:0] record_q;
logic [31:0] number, begun, begun_last;
frame_flags_t flags_last, flags_told;  // told: of the record
logic was_reset, touching_q;
depth_position_t [ToLate-1:0] positions;
always_ff @(posedge clk) begin
  was_reset <= rst;
  if (in_valid) begin
    if (in_position.frame_start) begun <= in_time;
    if (in_position.frame_end) {begun_last, flags_last} <= {begun, in_flags};
  end
  positions <= {positions[ToLate-2:0], in_position};
  due <= Latency'({due, in_valid & in_position.frame_end});
  if (due[1]) number <= number + 32'd1;
  flags_told <= flags_last;
  flags_told.flipped <= in_flipped;
  flags_told.residual <= in_residual;
  record_q <= record;
  touching_q <= touching;
  if (rst) begin
    due <= '0;
    number <= '0;
  end
end
always_comb assume (dut.late_position == positions[ToLate-1]);

// Where in the core the last depth of a frame is; frames of so many depths are Latency clocks long.
logic [Latency-1:0] early;
logic [ToLate-1:0] late_ends;
logic [Division-1:0] first_division, second_division;
logic [Division-1:0] counts_down;
assign {second_division, first_division} = due[Latency-2-:2*Division];
for (genvar n = 0; n < Latency; n++) begin : g_early
  assign early[n] = due[n] && 32'(u_protocol.u_depth_frames.next_place) > n;
end
for (genvar n = 0; n < ToLate; n++) begin : g_late
  assign late_ends[n] = dut.valid_delayed[n] && positions[n].frame_end;
end
for (genvar n = 0; n < Division; n++) begin : g_division
  assign counts_down[n] = !(first_division[n] || second_division[n])
      || (32'(dut.u_centroid.u_divide.bits_to_come) == Division - 1 - n && dut.u_centroid.of_row == second_division[n]);
end
always_comb begin
  if (started) begin
    apart: assert (early == '0 && (due & (due - 1'b1)) == '0);
    at_peak: assert ((dut.u_peak.valid_q && dut.u_peak.frame_end_q) == due[0] && dut.count_valid == due[ToCount-1]
        && dut.peak_valid == due[ToPeak-1]);
    at_sums: assert (late_ends == due[ToLate-1:0] && dut.u_sums.end_delayed == due[ToLate]
        && dut.sums_valid == due[ToSums-1] && dut.sums_held == due[ToSums]);
    at_centroid: assert (dut.u_centroid.u_divide.dividing == ((first_division | second_division) != '0)
        && counts_down == '1 && dut.centroid_valid == due[Latency-2]);
    counted: assert (dut.frame == number);
    if (u_protocol.u_depth_frames.next_place != '0) begun_then: assert (dut.start_time == begun);
    if (due != '0) stands: assert (dut.last_flags == flags_last && dut.last_time == begun_last);
    if (due[Latency-1:ToCount] != '0) decided: assert (!(dut.began && !touching) && !(dut.ended && touching));
    record_due: assert (record_valid == due[Latency-1]);
    if (!record_valid && !was_reset) keeps: assert (record == record_q);
    if (!was_reset && !due[2]) between_frames: assert (touching == touching_q);
    if (record_valid) begin
      status: assert (record[0] == touching && !(record[1] && !touching) && !(record[2] && touching));
      of_frame: assert (record[63:32] == number && record[95:64] == begun_last);
      flags_of_frame: assert (record[32*Words-1-:96] == flags_told);
    end
    if (was_reset) quiet: assert (!m_event_tvalid && !touching && record == '0);
    begins: cover (record_valid && record[1]);
    ends: cover (record_valid && record[2]);
    sends: cover (m_event_tvalid && m_event_tready && m_event_tlast);
  end
end
