// SPDX-License-Identifier: Apache-2.0
// code_wires: a code from one clock to the register that catches it in another; bits that are `late` show the code before
// the last edge of the first clock. A bit that has shown its new value keeps it.

`default_nettype none

module code_wires #(
  parameter int Width = 3
) (
  input  logic             from_clk,
  input  logic [Width-1:0] code,
  input  logic             to_clk,
  input  logic [Width-1:0] late,
  output logic [Width-1:0] caught
);

  logic [Width-1:0] code_before = '0, arrived, shown = '0, caught_q = '0;
  logic [2*Width-1:0] change = '0;  // that `shown` belongs to
  assign arrived = ~late | (change == {code_before, code} ? shown : '0);
  assign caught = caught_q;
  always_ff @(posedge from_clk) code_before <= code;
  always_ff @(posedge to_clk) begin
    caught_q <= (arrived & code) | (~arrived & code_before);
    shown <= arrived;
    change <= {code_before, code};
  end

  logic [Width-1:0] moving;
  assign moving = code ^ code_before;
  always_comb begin
    one_bit: assert ((moving & (moving - Width'(1))) == '0);
    if (moving != '0 && caught == code) shown_for_good: assert (change == {code_before, code} && (shown & moving) != '0);
  end

endmodule

`default_nettype wire
