// SPDX-License-Identifier: Apache-2.0
// fv_uart_transmit: a byte is taken when the line is free; from the next clock on the line has a start bit, its eight
// bits from the lowest and a stop bit, each for Divider clocks; else it is high.
//
// The specification counts the clocks since the byte was taken.

parameter int Divider = 33;

logic sending;
logic [11:0] age;  // clocks
logic [9:0] bits;  // of the byte, the first lowest
always_ff @(posedge clk) begin
  age <= age + 12'd1;
  if (age == 12'(10 * Divider - 1)) sending <= 1'b0;
  if (!sending) begin
    sending <= in_valid;
    age <= '0;
    bits <= {1'b1, in_data, 1'b0};
  end
  if (rst) sending <= 1'b0;
end

always_comb begin
  if (started) begin
    taken_when_free: assert (in_ready == !sending);
    bit_of_its_time: assert (line == (sending ? bits[4'(age / 12'(Divider))] : 1'b1));
    if (sending) begin  // the core counts down, the bits and their clocks
      in_step: assert (dut.left <= 4'd10 && 32'(dut.count) < Divider
          && 32'(age) == (11 - 32'(dut.left)) * Divider - 1 - 32'(dut.count));
      as_shifted: assert ({dut.rest, line} == 10'({10'h3FF, bits} >> (4'd10 - dut.left)));
    end
    at_once: cover (in_valid && in_ready && age == 12'(10 * Divider));
  end
end
