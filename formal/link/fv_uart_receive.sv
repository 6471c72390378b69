// SPDX-License-Identifier: Apache-2.0
// fv_uart_receive: a byte begins as the line falls, with the half of its first bit low; it has the levels in the middle
// of its bits; it leaves in its clock if its stop bit is high, and is broken if not; behind a broken one, and a reset,
// nothing begins until the line is high. Anything may come on the line.
//
// The specification counts the clocks since the line fell. It looks at the line 3 clocks later, as the core does.

logic [2:0] past;     // levels of the last clocks
localparam int Half = Divider / 2;
localparam int Stop = Half + 9 * Divider;  // clocks from the fall to the middle of the stop bit
logic [1:0] seen = '0;
logic level, may_begin, coming, middle, byte_due, broken_due;
logic [11:0] age;     // clocks since the line fell
logic [8:0] levels;   // of the bits so far, the newest highest
logic [7:0] byte_then;
assign level = dut.level;
assign middle = coming && age % 12'(Divider) == 12'(Half);
always_ff @(posedge clk) begin
  past <= {past[1:0], line};
  if (seen != 2'd3) seen <= seen + 2'd1;
  {byte_due, broken_due} <= '0;
  age <= age + 12'd1;
  if (!coming) begin
    coming <= may_begin & ~level;
    age <= 12'd1;
    may_begin <= may_begin | level;
  end
  if (middle) begin
    levels <= {level, levels[8:1]};
    if (age == 12'(Half) && level) coming <= 1'b0;
    if (age == 12'(Stop)) begin
      coming <= 1'b0;
      may_begin <= level;
      {byte_due, broken_due} <= {level, !level};
      byte_then <= levels[8:1];
    end
  end
  if (rst) {coming, may_begin, byte_due, broken_due} <= '0;
end

always_comb begin
  if (seen == 2'd3) line_of_3_clocks_before: assert (level == past[2]);
  if (started) begin
    byte_in_its_clock: assert (out_valid == byte_due);
    broken_in_its_clock: assert (broken == broken_due);
    if (out_valid) its_levels: assert (out_data == byte_then);
    // What makes it inductive: the core counts down to the middle of the next bit.
    in_step: assert (dut.busy == coming && dut.silent == !may_begin);
    if (coming) begin
      in_bit: assert (dut.position < 4'd10 && 32'(dut.count) < Divider && may_begin);
      counted: assert (32'(age) + 32'(dut.count) == Half + Divider * dut.position);
      if (dut.position != '0) so_far: assert ((out_data ^ levels[8:1]) >> (4'd9 - dut.position) == '0);
    end
    waits: cover (coming && level);
    if (Divider < 9) any_byte: cover (out_valid && out_data == 8'hA5);
    if (Divider < 9) long_break: cover (broken && !level);
  end
end
