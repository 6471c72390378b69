// SPDX-License-Identifier: Apache-2.0
// td_multiply, in place of the core td_multiply on an ECP5, whose multipliers are 18 x 18: two of them take the upper
// and the lower part of a long operand, each with a register of its own; their sum follows the registers.

`default_nettype none

module td_multiply #(
  parameter int AWidth = 27,
  parameter int BWidth = 18
) (
  input  wire                             clk,
  input  wire                             en,
  input  wire  signed [AWidth-1:0]        a,
  input  wire  signed [BWidth-1:0]        b,
  output logic signed [AWidth+BWidth-1:0] product
);

  localparam int Native = 18;

  if (AWidth <= Native || BWidth > Native) begin : g_plain
    always_ff @(posedge clk) if (en) product <= a * b;
  end else begin : g_parts
    localparam int Low = Native - 1;
    logic signed [AWidth-Low+BWidth-1:0] upper;
    logic signed [Native+BWidth-1:0] lower;
    always_ff @(posedge clk) begin
      if (en) begin
        upper <= $signed(a[AWidth-1:Low]) * b;
        lower <= $signed({1'b0, a[Low-1:0]}) * b;
      end
    end
    assign product = ((AWidth + BWidth)'(upper) <<< Low) + (AWidth + BWidth)'(lower);
  end

endmodule

`default_nettype wire
