// SPDX-License-Identifier: Apache-2.0
// fv_packet_store: a good packet that met a free bank at its begin waits, two at most; another one is said to be bad.
// The packets that wait are offered in order, byte by byte up to BankBytes, each byte as it came, with the length of
// the packet; stable under stall; one ends with its last byte or where the consumer drops it. A byte is offered one
// clock after there is one to offer. What td_ram asks holds. Lengths in full, places of 8 bits: those of the banks in use
// count alike, and the bench fills such a bank.
//
// The bench keeps the lengths of the packets that wait. One arbitrary byte of an arbitrary packet is followed.

input logic pick;

wire [11:0] bytes = u_protocol.count;

localparam int PlaceWidth = $clog2(BankBytes);
localparam logic [11:0] Most = 12'(BankBytes);

logic [1:0] waiting;           // packets
logic [10:0] first, second;    // their lengths
logic met_full, stores, takes, ends, bad_due, room;
logic [11:0] sent, kept;       // bytes of the first that left; bytes of it that leave
assign room = waiting != 2'd2;
assign stores = in_end & in_good & ~met_full;
assign takes = out_valid & out_ready;
assign kept = 12'(first) < Most ? 12'(first) : Most;
assign ends = takes & (out_drop | (sent + 12'd1 == kept));

// The byte followed: it is of the packet that comes, then of the second or the first that waits.
logic following, complete, is_second, was_reset;
logic [11:0] at;  // its place
logic [7:0] value;
logic now;
logic bank;  // its bank
assign bank = !complete ? dut.stored[0] : dut.gone[0] ^ is_second;
assign now = following & complete & ~is_second & (at == sent);

always_ff @(posedge clk) begin
  was_reset <= rst;
  bad_due <= in_end & ~stores;
  waiting <= waiting + 2'(stores) - 2'(ends);
  if (ends) first <= second;
  if (stores && waiting == 2'(ends)) first <= bytes[10:0];
  else if (stores) second <= bytes[10:0];
  if (in_valid && !room) met_full <= 1'b1;
  if (takes) sent <= ends ? '0 : sent + 12'd1;
  if (!following) begin
    following <= pick & in_valid & room & ~met_full & (bytes < Most);
    at <= bytes;
    value <= in_data;
    complete <= 1'b0;
  end else begin
    if (in_end && !complete) begin
      following <= stores;
      complete <= 1'b1;
      is_second <= waiting != 2'(ends);
    end else if (complete && ends) begin
      is_second <= 1'b0;
      if (!is_second) following <= 1'b0;
    end
    if (now && takes) following <= 1'b0;
  end
  if (in_end) met_full <= 1'b0;
  if (rst) begin
    {met_full, bad_due, following} <= '0;
    waiting <= '0;
    sent <= '0;
  end
end

offer_stays u_out_ (.*);
always_comb begin
  if (started) begin
    said: assert (bad == bad_due);
    two_at_most: assert (waiting <= 2'd2 && in_ready == room);
    if (was_reset) quiet: assert (!out_valid);
    if (out_valid) something_waits: assert (waiting != '0);
    if (out_valid) its_length: assert (out_length == first && out_length_mod3 == 2'(first % 11'd3));
    if (out_valid) its_last: assert (out_last == (sent + 12'd1 == kept));
    if (now && out_valid) as_it_came: assert (out_data == value);
    if (waiting != '0) within_it: assert (sent < kept);
    if (dut.fetched) read_now: assert (waiting != '0 && !out_valid && (!now || dut.read_data == value));
    // What makes it inductive: the state of the core is that of the bench.
    as_counted: assert (bytes[11] || (dut.length == bytes[10:0] && dut.length_mod3 == 2'(bytes % 12'd3)));
    as_met: assert (dut.lost == met_full && 2'(dut.stored - dut.gone) == waiting && 12'(dut.place) == sent);
    if (waiting != '0) as_first: assert (first != '0 && dut.lengths[dut.gone[0]] == {2'(first % 11'd3), first});
    if (waiting == 2'd2) as_second: assert (dut.lengths[~dut.gone[0]] == {2'(second % 11'd3), second});
    if (waiting == 2'd2) not_empty: assert (second != '0);
    if (bytes != '0 && !room) at_its_begin: assert (met_full);
    if (waiting == '0) from_the_first: assert (sent == '0);
    if (following) begin
      if (!complete) coming: assert (at < bytes && room && !met_full);
      else if (is_second) in_second: assert (waiting == 2'd2 && at < 12'(second));
      else in_first: assert (waiting != '0 && at < 12'(first) && at >= sent);
      if (complete || !bytes[11]) begin
        kept_of_it: assert (at < Most && dut.u_bytes.g_distributed.words[{bank, at[PlaceWidth-1:0]}] == value);
      end
    end
    both_full: cover (waiting == 2'd2 && met_full && in_end && in_good);
    if (BankBytes < 9) longer: cover (out_valid && out_last && out_length > 11'(BankBytes));
    followed: cover (now && out_valid && sent == 12'd2 && is_second == 1'b0 && waiting == 2'd2);
    dropped: cover (takes && out_drop && !out_last);
  end
end

// A byte is offered two clocks after one waits, and none is: in the clocks after the last one left there is none.
logic waited, waited_more;
always_ff @(posedge clk) begin
  waited <= (waiting != '0) & ~out_valid & ~rst;
  waited_more <= waited & ~out_valid & ~rst;
end
always_comb begin
  if (started && waited) read_at_once: assert (dut.fetched || out_valid);
  if (started && waited_more) at_once: assert (out_valid);
end

bind dut.u_bytes ram_check #(.Depth(Depth), .Defined(0), .Covered(Depth == 8 ? 1 : 0)) u_check (.*);

// Protocol: a byte, or the end of a packet, or none; a good packet has 1 to 2047 bytes. Any consumer. What is
// offered counts while it is valid.
module protocol_packet_store;
  logic [11:0] count = '0;  // of the packet that comes; 2048 stands for more
  assign holds = ~(in_valid & in_end) & ~(in_end & in_good & (count == '0 | count[11]));
  assign counts = live;
  assign counts_out_data = live & out_valid;
  assign {counts_out_last, counts_out_length, counts_out_length_mod3} = {3{counts_out_data}};
  always_ff @(posedge clk) begin
    if (in_valid && !count[11]) count <= count + 12'd1;
    if (in_end || reset) count <= '0;
  end
endmodule
