// SPDX-License-Identifier: Apache-2.0
// td_dot_product: a0 b0 + a1 b1, exact. Latency: 4 cycles.
//
// Registered and staggered as two cascaded DSP48E2 take it: operands, product (multiply), sum. No reset on the way.
// Bit-accurate model: models/tactile_depth/chip/common/td_dot_product.py.

`default_nettype none

module td_dot_product #(
  parameter int AWidth = 27,
  parameter int BWidth = 18
) (
  input  wire                             clk,
  input  wire                             en,
  input  wire  signed [AWidth-1:0]        a0,  // F fraction bits, as a1
  input  wire  signed [BWidth-1:0]        b0,  // G fraction bits, as b1
  input  wire  signed [AWidth-1:0]        a1,
  input  wire  signed [BWidth-1:0]        b1,
  output logic signed [AWidth+BWidth:0]   sum  // F + G fraction bits
);

  logic [AWidth-1:0] a0_q;
  logic [BWidth-1:0] b0_q;
  logic [1:0][AWidth-1:0] a1_q;
  logic [1:0][BWidth-1:0] b1_q;
  logic signed [AWidth+BWidth-1:0] product0, product0_q, product1;

  td_multiply #(.AWidth(AWidth), .BWidth(BWidth)) u_product0 (.clk, .en, .a(a0_q), .b(b0_q), .product(product0));
  td_multiply #(.AWidth(AWidth), .BWidth(BWidth)) u_product1 (.clk, .en, .a(a1_q[1]), .b(b1_q[1]), .product(product1));

  always_ff @(posedge clk) begin
    if (en) begin
      a0_q <= a0;
      b0_q <= b0;
      a1_q <= {a1_q[0], a1};
      b1_q <= {b1_q[0], b1};
      product0_q <= product0;
      sum <= (AWidth + BWidth + 1)'(product0_q) + (AWidth + BWidth + 1)'(product1);
    end
  end

endmodule

`default_nettype wire
