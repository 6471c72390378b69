// SPDX-License-Identifier: Apache-2.0
// fv_packet_check: a byte leaves when the fourth behind it has come, and no other byte; a packet is good if it was not
// bad, has five bytes or more, and their remainder is that of a right CRC.
//
// The remainder is that of long division by the polynomial, a bit at a time, lowest bit of a byte first. One arbitrary
// byte is followed.

input logic pick;

// x^32 + .. + 1, the highest power on the left; a right packet leaves the remainder C704DD7B.
localparam logic [31:0] Polynomial = 32'h04C11DB7;
localparam logic [31:0] Right = 32'hC704DD7B;
function automatic logic [31:0] divided(input logic [31:0] remainder, input logic [7:0] data);
  logic [31:0] rest;
  rest = remainder;
  for (int place = 0; place < 8; place++) begin
    rest = {rest[30:0], 1'b0} ^ (rest[31] != data[place] ? Polynomial : 32'd0);
  end
  return rest;
endfunction

logic [31:0] remainder, reflected;
logic [3:0] bytes;  // of the packet, up to 5
logic due, ends, was_bad, was_short, was_wrong, following, watched;
logic [2:0] behind;  // bytes that came behind the one followed
logic [7:0] value, watched_value;  // of the byte followed, and of the one that leaves
for (genvar place = 0; place < 32; place++) begin : g_place
  assign reflected[place] = remainder[31-place];
end

always_ff @(posedge clk) begin
  due <= in_valid & (bytes >= 4'd4);
  ends <= in_end;
  was_bad <= in_bad;
  was_short <= bytes < 4'd5;
  was_wrong <= remainder != Right;
  watched <= following & in_valid & (behind == 3'd3);
  watched_value <= value;
  if (in_valid) begin
    remainder <= divided(remainder, in_data);
    if (bytes < 4'd5) bytes <= bytes + 4'd1;
    behind <= behind + 3'd1;
    if (following && behind == 3'd3) following <= 1'b0;
    if (pick && !following) begin
      following <= 1'b1;
      behind <= '0;
      value <= in_data;
    end
  end
  if (in_end || rst) begin
    remainder <= '1;
    bytes <= '0;
    following <= 1'b0;
  end
  if (rst) {due, ends, watched} <= '0;
end

always_comb begin
  if (started) begin
    in_time: assert (out_valid == due && out_end == ends);
    if (watched) in_order: assert (out_valid && out_data == watched_value);
    if (out_end) judged: assert (out_good == !(was_bad || was_short || was_wrong));
    as_divided: assert (dut.crc == reflected);
    right_packet: cover (out_end && out_good);
    wrong_packet: cover (out_end && was_wrong && !was_short && !was_bad);
  end
end
