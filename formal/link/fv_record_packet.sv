// SPDX-License-Identifier: Apache-2.0
// fv_record_packet: packets are the kind and 60 bytes, whole, stable under stall, none of them more than 2 clocks late.
// Each is the newest whole record when its first byte was taken; a record that waits behind a packet goes as the next
// one begins.
//
// One bit of an arbitrary byte of each record is followed.

input logic [5:0] pick;

bind dut.u_records ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);

wire [3:0] word = u_protocol.next_word;

logic [5:0] watched, place;  // place: bytes of the packet that were taken
logic [1:0] silent;
logic [7:0] stalled_data;
logic came, came_next, waits, waits_bit, sent_bit, sending, leaves, ends, stalled, was_reset;
assign leaves = record_valid & record_ready;
assign ends = s_event_tvalid & s_event_tlast;
assign sending = place != '0;
assign came_next = s_event_tvalid && word == watched[5:2] ? s_event_tdata[{watched[1:0], 3'd0}] : came;
always_comb assume (pick < 6'd60);

always_ff @(posedge clk) begin
  was_reset <= rst;
  if (!started) watched <= pick;
  came <= came_next;
  if (ends) waits_bit <= came_next;
  if (leaves && !sending) sent_bit <= waits_bit;
  if (leaves) place <= record_last ? '0 : place + 6'd1;
  waits <= ends | (waits & ~(leaves & ~sending)
      & ~(s_event_tvalid & word == '0 & sending & ~(leaves & record_last)));
  silent <= record_valid | ~sending ? '0 : silent + 2'd1;
  stalled <= record_valid & ~record_ready;
  stalled_data <= record_data;
  if (rst) begin
    place <= '0;
    waits <= 1'b0;
    silent <= '0;
    stalled <= 1'b0;
  end
end

always_comb begin
  if (started && !rst) begin
    if (was_reset) quiet: assert (!record_valid);
    if (!sending) newest: assert (record_valid == waits);
    if (stalled) stable: assert (record_valid && record_data == stalled_data);
    if (record_valid) begin
      last_of_packet: assert (record_last == (place == 6'd60));
      if (!sending) kind: assert (record_data == 8'h99);
      if (place == watched + 6'd1) as_it_was: assert (record_data[0] == sent_bit);
    end
    in_time: assert (silent <= 2'd2);
    another: cover (record_valid && sending && waits);
    second_word: cover (leaves && place == 6'd5);
  end
end

// Protocol: records of 15 words; bytes count while they are valid.
module protocol_record_packet;
  logic [3:0] next_word = '0;
  assign holds = rst | ~s_event_tvalid | s_event_tlast == (next_word == 4'd14);
  assign counts = live & ~reset;
  assign {counts_record_data, counts_record_last} = {2{counts & record_valid}};
  always_ff @(posedge clk) begin
    if (s_event_tvalid) next_word <= s_event_tlast ? '0 : next_word + 4'd1;
    if (reset) next_word <= '0;
  end
endmodule
