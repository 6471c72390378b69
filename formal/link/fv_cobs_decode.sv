// SPDX-License-Identifier: Apache-2.0
// fv_cobs_decode: a byte is a code if its place is the one that the code before it named, the first byte of a piece is
// one; a code but the first leaves as a zero unless the one before it was 255, and every other byte as it is; a piece
// that is not empty ends, and is bad if its end is not the place of a code, a byte was broken, or it is too long.
//
// Places are counted modulo 256: a code names one at most 255 further on. Anything comes before the first delimiter.

logic begun, broken, is_code, first, after_full;
localparam int LengthWidth = $clog2(Longest + 2);
localparam logic [LengthWidth-1:0] TooLong = LengthWidth'(Longest + 1);
logic [7:0] place, next_code;  // of the next byte, and of the next code
logic [LengthWidth-1:0] bytes;  // of the piece, up to TooLong
assign is_code = place == next_code;

logic due, ends, was_broken, was_cut, was_long;
logic [7:0] value;
always_ff @(posedge clk) begin
  due <= begun & in_valid & (in_data != '0) & ~(is_code & (first | after_full));
  value <= is_code ? 8'd0 : in_data;
  ends <= begun & in_valid & (in_data == '0) & (bytes != '0 | broken);
  was_broken <= broken;
  was_cut <= ~is_code;
  was_long <= bytes == TooLong;
  if (in_valid && in_data == '0) begin
    begun <= 1'b1;
    {place, next_code} <= '0;
    {broken, after_full} <= '0;
    first <= 1'b1;
    bytes <= '0;
  end else if (in_valid && begun) begin
    place <= place + 8'd1;
    if (is_code) begin
      next_code <= next_code + in_data;
      first <= 1'b0;
      after_full <= in_data == 8'd255;
    end
    if (bytes != TooLong) bytes <= bytes + LengthWidth'(1);
  end
  if (begun && in_broken) broken <= 1'b1;
  if (rst) begin
    {begun, due, ends} <= '0;
  end
end

always_comb begin
  if (started) begin
    in_time: assert (out_valid == due && out_end == ends);
    if (out_valid) decoded: assert (out_data == value);
    if (out_end) judged: assert (out_bad == (was_broken | was_cut | was_long));
    as_counted: assert (dut.begun == begun && (begun || dut.length == '0));
    if (begun) begin
      code_in: assert (dut.left == next_code - place);
      zero_behind: assert (dut.zero_due == (!first && !after_full));
      length: assert (dut.length == (broken ? TooLong : bytes));
      counted: assert (bytes <= TooLong && (bytes == '0) == first && (!first || is_code));
    end
    zero_between: cover (out_valid && out_data == '0 && 32'(bytes) == 3);
    good: cover (out_end && !out_bad);
    if (Longest < 9) too_long: cover (out_end && was_long && !was_cut && !was_broken);
    cut: cover (out_end && was_cut && !was_long && !was_broken);
  end
end
