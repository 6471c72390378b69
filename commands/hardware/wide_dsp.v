// SPDX-License-Identifier: Apache-2.0
// For `make synth`: a 7-series DSP with the multiplier of a DSP48E2. Yosys' xilinx_dsp adds registers and cascades, which
// are the same in both.

module \$__MUL27X18 (input [26:0] A, input [17:0] B, output [44:0] Y);
  parameter A_SIGNED = 0;
  parameter B_SIGNED = 0;
  parameter A_WIDTH = 0;
  parameter B_WIDTH = 0;
  parameter Y_WIDTH = 0;
  wire [47:0] product;
  DSP48E1 #(
    .ACASCREG(0), .ADREG(0), .ALUMODEREG(0), .AREG(0), .BCASCREG(0), .BREG(0), .CARRYINREG(0), .CARRYINSELREG(0),
    .CREG(0), .DREG(0), .INMODEREG(0), .MREG(0), .OPMODEREG(0), .PREG(0),
    .A_INPUT("DIRECT"), .B_INPUT("DIRECT"), .USE_MULT("MULTIPLY"), .USE_SIMD("ONE48"), .USE_DPORT("FALSE")
  ) _TECHMAP_REPLACE_ (
    .A({{3{A[26]}}, A}), .B(B), .C(48'd0), .D(25'd0), .CARRYIN(1'b0), .P(product),
    .INMODE(5'd0), .ALUMODE(4'd0), .OPMODE(7'b0000101), .CARRYINSEL(3'd0),
    .ACIN(30'd0), .BCIN(18'd0), .PCIN(48'd0)
  );
  assign Y = product[44:0];
endmodule
