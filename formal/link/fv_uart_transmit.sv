// SPDX-License-Identifier: Apache-2.0
// fv_uart_transmit: a byte is taken when the line is free; from the next clock on the line has a start bit, its eight
// bits from the lowest and a stop bit, each for Divider clocks; else it is high.
//
// The specification counts the clocks since the byte was taken.

parameter int Divider = 4;

logic sending;
logic [7:0] age;   // clocks
logic [9:0] bits;  // of the byte, the first lowest
always_ff @(posedge clk) begin
  age <= age + 8'd1;
  if (age == 8'(10 * Divider - 1)) sending <= 1'b0;
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
    bit_of_its_time: assert (line == (sending ? bits[4'(age / 8'(Divider))] : 1'b1));
    at_once: cover (in_valid && in_ready && age == 8'(10 * Divider));
  end
end
