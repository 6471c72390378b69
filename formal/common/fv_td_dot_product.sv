// SPDX-License-Identifier: Apache-2.0
// fv_td_dot_product: a0 b0 + a1 b1, exact, of the operands of an arbitrary enabled clock, 4 enabled clocks later.

`default_nettype none

module fv_td_dot_product #(
  parameter int AWidth = 3,
  parameter int BWidth = 2
) (
  input logic                     clk,
  input logic                     en,
  input logic signed [AWidth-1:0] a0,
  input logic signed [BWidth-1:0] b0,
  input logic signed [AWidth-1:0] a1,
  input logic signed [BWidth-1:0] b1,
  input logic                     pick
);

  localparam int Latency = 4;

  logic signed [AWidth+BWidth:0] sum;
  td_dot_product #(.AWidth(AWidth), .BWidth(BWidth)) dut (.clk, .en, .a0, .b0, .a1, .b1, .sum);

  logic due;
  logic signed [AWidth-1:0] a0_picked, a1_picked;
  logic signed [BWidth-1:0] b0_picked, b1_picked;
  follow_delay #(.Width(2 * (AWidth + BWidth)), .Latency(Latency)) u_follow (
    .clk, .rst(1'b0), .en, .pick, .in({a0, b0, a1, b1}), .due, .word({a0_picked, b0_picked, a1_picked, b1_picked})
  );

  always_comb begin
    if (due) begin
      exact: assert (32'(sum) == 32'(a0_picked) * 32'(b0_picked) + 32'(a1_picked) * 32'(b1_picked));
      largest: cover (sum == (AWidth + BWidth + 1)'(1 << (AWidth + BWidth - 1)));
    end
  end

endmodule

`default_nettype wire
