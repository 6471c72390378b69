// SPDX-License-Identifier: Apache-2.0
// fv_cobs_encode: what is on the line, decoded, is what came in, packet by packet, between two zeros each; no other
// zeros; no code but those that COBS needs, so no other bytes have this meaning; stable under stall; memory as
// td_ram.sv asks.
//
// The specification decodes. One arbitrary byte is followed: `pick` is free, so it may be any. Nothing is assumed of
// the source, which may even withdraw a byte that it offered.

input logic pick;

localparam int Width = $clog2(Run + 3);  // one more than is ever held

// With a Run of 3 the last word of four is not used. That each byte read was written follows from the byte followed.
bind dut.u_piece ram_check #(.Depth(Depth), .Defined(0), .Covered(Depth == 2 ? 1 : 0)) u_check (.*);

// The line.
logic taken, leaves, in_packet, first, full, after_full, empty, decodes, is_code, ends;
logic [Width-1:0] left;  // bytes of the block that are to come
assign taken = in_valid & in_ready;
assign leaves = out_valid & out_ready;
assign is_code = leaves & in_packet & left == '0 & out_data != '0;
assign ends = leaves & in_packet & left == '0 & out_data == '0;
assign decodes = leaves & in_packet & (left != '0 | (is_code & ~first & ~full));  // a byte, or the zero of the block

logic [Width-1:0] held, ahead;  // bytes that came in and are not decoded; those before the one followed
logic following, whole;
logic [7:0] value;
logic [1:0] packets;  // that ended, to show how far a trace goes
always_ff @(posedge clk) begin
  held <= held + Width'(taken) - Width'(decodes);
  if (taken) whole <= in_last;
  if (leaves && !in_packet) begin
    in_packet <= 1'b1;
    first <= 1'b1;
    left <= '0;
  end
  if (is_code) begin
    first <= 1'b0;
    left <= Width'(out_data - 8'd1);
    full <= out_data == 8'(Run + 1);
    after_full <= full & ~first;
    empty <= out_data == 8'd1;
  end
  if (leaves && in_packet && left != '0) left <= left - Width'(1);
  if (ends) begin
    in_packet <= 1'b0;
    whole <= 1'b0;
    packets <= packets + 2'(packets != '1);
  end
  if (!following) begin
    following <= pick & taken;
    ahead <= held;
    value <= in_data;
  end else if (decodes) begin
    following <= ahead != '0;
    ahead <= ahead - Width'(1);
  end
  if (rst) begin
    held <= '0;
    whole <= 1'b0;
    in_packet <= 1'b0;
    left <= '0;
    following <= 1'b0;
    packets <= '0;
  end
end

offer_stays u_out_ (.*);
always_comb begin
  if (started) begin
    moves: assert (in_ready != out_valid);
    capacity: assert (32'(held) <= Run + 1);
    one_packet: assert (!(whole && in_ready));
    if (leaves && !in_packet) zero_before: assert (out_data == '0 && held != '0);
    if (is_code) within_a_run: assert (32'(out_data) <= Run + 1);
    if (decodes) out_of_something: assert (held != '0);
    if (decodes && following && ahead == '0) begin
      unchanged: assert (value == (left != '0 ? out_data : '0));
      no_zero: assert (left == '0 || value != '0);
    end
    if (ends) begin
      zero_behind: assert (whole && held == '0 && !first);
      shortest: assert (!(empty && after_full));
      if (Run < 9) behind_a_run: cover (full && packets == 2'd2);
      behind_a_zero: cover (empty && packets == 2'd1);
    end
    if (Run < 9) zero_behind_a_run: cover (is_code && full && !first && out_data == 8'd1 && whole);
    followed: cover (decodes && following && ahead == '0 && value == '0 && !first);
  end
end

// What makes it inductive: the bytes that are held are the zero of the block before, bytes of the piece, and its zero.
logic bytes, zero_before_piece, zero_of_piece;
logic [Width-1:0] sent, place;  // bytes of the piece; of the byte followed in it
assign bytes = dut.state == 3'd3;
assign sent = bytes ? Width'(dut.place) - Width'(1) : '0;
assign zero_before_piece = in_packet & ~first & ~full & ~bytes;
assign zero_of_piece = ~in_ready & (whole ? dut.empty_follows : 32'(dut.count) != Run);
assign place = sent + ahead - Width'(zero_before_piece);
always_comb begin
  if (started) begin
    in_state: assert (dut.state <= 3'd4 && dut.begun == in_packet && (in_ready ? !whole : whole == dut.ends));
    in_begin: assert (dut.state == 3'd1 ? !in_packet && held != '0 : in_ready || in_packet);
    first_code: assert (!(in_packet && first) || dut.state == 3'd2);
    in_piece: assert (32'(dut.count) < Run + 32'(!in_ready) && (bytes ? dut.place != '0 : dut.place == '0)
        && dut.place <= dut.count && left == (bytes ? Width'(dut.count) - sent : '0));
    if (dut.state == 3'd4) in_end: assert (whole && held == '0 && dut.count == '0 && !(empty && after_full));
    else as_held: assert (held == Width'(dut.count) - sent + Width'(zero_before_piece) + Width'(zero_of_piece));
    if (bytes) its_code: assert (!empty && full == (32'(dut.count) == Run));
    if (!in_ready && dut.empty_follows) ends_in_zero: assert (dut.state == 3'd4 || whole && 32'(dut.count) != Run);
    if (dut.state == 3'd2 && whole && dut.count == '0 && !dut.empty_follows) last_zero: assert (zero_before_piece);
    if (following) begin
      is_held: assert (ahead < held);
      if (zero_before_piece && ahead == '0 || place == Width'(dut.count)) a_zero: assert (value == '0);
      else if (bytes && ahead == '0) on_the_line: assert (value == out_data && value != '0);
      else in_memory: assert (dut.u_piece.g_distributed.words[place[$clog2(Run)-1:0]] == value && value != '0);
    end
  end
end
