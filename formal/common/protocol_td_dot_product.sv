// SPDX-License-Identifier: Apache-2.0
// protocol_td_dot_product: any operands; the sum counts once 4 enabled clocks have passed.

`default_nettype none

module protocol_td_dot_product (
  input  logic clk,
  input  logic en,
  output logic counts_sum
);

  settled #(.Clocks(4)) u_settled (.clk, .en, .settled(counts_sum));

endmodule

`default_nettype wire
