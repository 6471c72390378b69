// SPDX-License-Identifier: Apache-2.0
// protocol_td_multiply: any operands; the product counts once 1 enabled clock has passed.

`default_nettype none

module protocol_td_multiply (
  input  logic clk,
  input  logic en,
  output logic counts_product
);

  settled #(.Clocks(1)) u_settled (.clk, .en, .settled(counts_product));

endmodule

`default_nettype wire
