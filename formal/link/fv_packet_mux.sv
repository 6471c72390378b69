// SPDX-License-Identifier: Apache-2.0
// fv_packet_mux: bytes pass unchanged, those of a packet together; what is offered is stable under stall; the packet
// that begins is the one whose turn it is; depth is not passed by a second record.
//
// Packets may have any length. A packet passes from the clock after it was chosen to that in which its last byte
// leaves.

logic [3:0] valid, ready, turn, owner;  // a bit for each stream; whose packet begins, or passes
logic passes, leaves, behind_record, whole;
assign valid = {depth_valid, record_valid, reply_valid, status_valid};
assign ready = {depth_ready, record_ready, reply_ready, status_ready};
assign leaves = out_valid & out_ready;
assign turn[0] = valid[0];
assign turn[1] = valid[1] & ~valid[0];
assign turn[2] = valid[2] & valid[1:0] == '0 & ~(valid[3] & behind_record);
assign turn[3] = valid[3] & valid[1:0] == '0 & (~valid[2] | behind_record);

always_ff @(posedge clk) begin
  passes <= passes ? ~(leaves & out_last) : valid != '0;
  if (!passes) owner <= turn;
  if (!passes && turn[3:2] != '0) behind_record <= turn[2];
  whole <= leaves ? out_last : whole;  // no packet has begun to leave
  if (rst) begin
    passes <= 1'b0;
    behind_record <= 1'b0;
    whole <= 1'b1;
  end
end

offer_stays u_out_ (.*);
always_comb begin
  if (started) begin
    in_turn: assert (out_valid == (passes && (valid & owner) != '0));
    taken_alone: assert (ready == (passes && out_ready ? owner : '0));
    whole_packets: assert (whole || passes);
    if (out_valid) begin
      if (owner[0]) status_passes: assert (out_data == status_data && out_last == status_last);
      if (owner[1]) reply_passes: assert (out_data == reply_data && out_last == reply_last);
      if (owner[2]) record_passes: assert (out_data == record_data && out_last == record_last);
      if (owner[3]) depth_passes: assert (out_data == depth_data && out_last == depth_last);
      others_wait: cover (owner[3] && leaves && out_last && valid == '1 && !whole);
      record_again: cover (owner[2] && leaves && out_last && behind_record && !whole);
    end
    depth_first: cover (!passes && valid == 4'b1100 && turn[3]);
  end
end
