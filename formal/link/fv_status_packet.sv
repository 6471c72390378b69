// SPDX-License-Identifier: Apache-2.0
// fv_status_packet: a packet after each reset, and one for the requests since the last one began, without a hole; its
// fields are those of the clock in which its first byte is taken. Stable under stall.

logic asked, was_reset, sending, leaves;
logic [4:0] sent;  // bytes of the packet
logic [8*FieldBytes-1:0] taken;
assign leaves = status_valid & status_ready;
always_ff @(posedge clk) begin
  was_reset <= rst;
  if (leaves) begin
    sending <= 1'b1;
    sent <= sent + 5'd1;
    if (!sending) {asked, taken} <= {1'b0, fields};
    if (sent == 5'(FieldBytes + 1)) {sending, sent} <= '0;
  end
  if (request || was_reset) asked <= 1'b1;
  if (rst) {asked, sending, sent} <= '0;
end

always_comb begin
  if (started) begin
    one_for_each: assert (status_valid == (asked || sending));
    if (status_valid) begin
      whole: assert (status_last == (sent == 5'(FieldBytes + 1)));
      if (sent == 5'd0) its_kind: assert (status_data == 8'h81);
      if (sent == 5'd1) the_version: assert (status_data == td_link_pkg::Version);
      if (sent > 5'd1) fields_as_taken: assert (status_data == 8'(taken >> {sent - 5'd2, 3'd0}));
    end
    // What makes it inductive: the place and the rest of the packet.
    in_place: assert (dut.place == sent && sent <= 5'(FieldBytes + 1) && sending == (sent != '0) && dut.due == asked);
    first_place: assert (dut.first == !sending);
    if (sending) rest: assert (dut.left == taken >> {sent - 5'd1 - 5'(sent > 5'd1), 3'd0});
    after_reset: cover (status_valid && status_last && asked);
    asked_as_it_begins: cover (leaves && !sending && request);
  end
end
