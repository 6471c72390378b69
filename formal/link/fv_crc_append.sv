// SPDX-License-Identifier: Apache-2.0
// fv_crc_append: the bytes of a packet pass unchanged and at once; the four bytes of its CRC follow, low byte first,
// and last with the fourth alone; stable under stall.
//
// The specification of the CRC is not reflected: it takes the bits of a byte from the lowest, and its highest bit is
// the lowest of the core's.

function automatic logic [31:0] with_byte(input logic [31:0] remainder, input logic [7:0] data);
  logic [31:0] out;
  out = remainder;
  for (int place = 0; place < 8; place++) begin
    out = {out[30:0], 1'b0} ^ (out[31] ^ data[place] ? 32'h04C11DB7 : 32'd0);
  end
  return out;
endfunction

logic [31:0] remainder;  // of the bytes of the packet
logic [31:0] reflected;
logic [2:0] left;        // bytes of the CRC that are to come
logic leaves;
logic [3:0] passed;      // bytes of the packet, to show how far a trace goes
assign leaves = out_valid & out_ready;
always_comb for (int place = 0; place < 32; place++) reflected[place] = remainder[31-place];

always_ff @(posedge clk) begin
  if (leaves && left == '0) begin
    remainder <= with_byte(remainder, in_data);
    left <= in_last ? 3'd4 : 3'd0;
    passed <= passed + 4'(passed != '1);
  end
  if (leaves && left != '0) begin
    if (left == 3'd1) remainder <= '1;
    left <= left - 3'd1;
    if (left == 3'd1) passed <= '0;
  end
  if (rst) begin
    remainder <= '1;
    left <= '0;
    passed <= '0;
  end
end

// Bytes of the CRC that have left are replaced by ones: an invariant, without which the induction has no base.
logic [31:0] kept;
assign kept = ~(~reflected >> {3'(3'd4 - left), 3'd0});

offer_stays u_out_ (.*);
always_comb begin
  if (started) begin
    state_kept: assert (dut.state == (left == '0 ? reflected : kept));
    count_kept: assert (dut.appends == (left != '0) && left <= 3'd4);
    place_kept: assert (dut.place == (left == '0 ? 2'd0 : 2'(3'd4 - left)));
    taken: assert (in_ready == (out_ready && left == '0));
    at_once: assert (out_valid == (in_valid || left != '0));
    last_of_all: assert (out_last == (left == 3'd1));
    if (out_valid && left == '0) passes: assert (out_data == in_data);
    if (left == 3'd4) first_byte: assert (out_data == ~reflected[7:0]);
    if (left == 3'd3) second_byte: assert (out_data == ~reflected[15:8]);
    if (left == 3'd2) third_byte: assert (out_data == ~reflected[23:16]);
    if (left == 3'd1) fourth_byte: assert (out_data == ~reflected[31:24]);
    next_follows: cover (leaves && out_last && in_valid && passed == 4'd3);
  end
end
