// SPDX-License-Identifier: Apache-2.0
// fv_cobs_encode: what is on the line, decoded, is what came in, packet by packet, between two zeros each; no other
// zeros; no code but those that COBS needs, so no other bytes have this meaning; stable under stall; memory as
// td_ram.sv asks.
//
// The specification decodes. One arbitrary byte is followed: `pick` is free, so it may be any. Nothing is assumed of
// the source, which may even withdraw a byte that it offered.

parameter int Run = 2;
input logic pick;

localparam int Width = $clog2(Run + 3);  // one more than is ever held

// With a Run of 3 the last word of four is not used.
bind dut.u_piece ram_check #(.Depth(Depth), .Covered(Depth == 2 ? 1 : 0)) u_check (.*);

// The line.
logic taken, leaves, in_packet, first, full, after_full, empty, decodes, is_code, ends;
logic [Width-1:0] left;  // bytes of the block that are to come
assign taken = in_valid & in_ready;
assign leaves = out_valid & out_ready;
assign is_code = leaves & in_packet & left == '0 & out_data != '0;
assign ends = leaves & in_packet & left == '0 & out_data == '0;
assign decodes = leaves & in_packet & (left != '0 | (is_code & ~first & ~full));  // a byte, or the zero of the block

logic [Width-1:0] held, ahead;  // bytes that came in and are not decoded; those before the one followed
logic following, whole, stalled;
logic [7:0] value, stalled_data;
logic [1:0] packets;  // that ended, to show how far a trace goes
always_ff @(posedge clk) begin
  stalled <= out_valid & ~out_ready;
  stalled_data <= out_data;
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
    stalled <= 1'b0;
    held <= '0;
    whole <= 1'b0;
    in_packet <= 1'b0;
    left <= '0;
    following <= 1'b0;
    packets <= '0;
  end
end

always_comb begin
  if (started) begin
    moves: assert (in_ready != out_valid);
    capacity: assert (32'(held) <= Run + 1);
    one_packet: assert (!(whole && in_ready));
    if (leaves && !in_packet) zero_before: assert (out_data == '0 && held != '0);
    if (leaves && in_packet && left != '0) no_zero: assert (out_data != '0);
    if (is_code) within_a_run: assert (32'(out_data) <= Run + 1);
    if (decodes) out_of_something: assert (held != '0);
    if (decodes && following && ahead == '0) unchanged: assert (value == (left != '0 ? out_data : '0));
    if (ends) begin
      zero_behind: assert (whole && held == '0 && !first);
      shortest: assert (!(empty && after_full));
      behind_a_run: cover (full && packets == 2'd2);
      behind_a_zero: cover (empty && packets == 2'd1);
    end
    if (stalled) stable: assert (out_valid && out_data == stalled_data);
    zero_behind_a_run: cover (is_code && full && !first && out_data == 8'd1 && whole);
    followed: cover (decodes && following && ahead == '0 && value == '0 && !first);
  end
end
