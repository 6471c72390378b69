// SPDX-License-Identifier: Apache-2.0
// MULT18X18D: the multiplier of an ECP5, as far as commands/hardware/ecp5.py uses it: registers at inputs and output under CLK0,
// each under one enable. The one between, and resets, are not modelled. To simulate netlists; not for synthesis.

module MULT18X18D #(
  parameter REG_INPUTA_CLK = "NONE",
  parameter REG_INPUTA_CE  = "CE0",
  parameter REG_INPUTB_CLK = "NONE",
  parameter REG_INPUTB_CE  = "CE0",
  parameter REG_OUTPUT_CLK = "NONE",
  parameter REG_OUTPUT_CE  = "CE0",
  parameter GSR            = "ENABLED",
  parameter RESETMODE      = "SYNC"
) (
  input  logic A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17,
  input  logic B0, B1, B2, B3, B4, B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
  input  logic C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, C10, C11, C12, C13, C14, C15, C16, C17,
  input  logic SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
  input  logic CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3,
  output logic P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17,
  output logic P18, P19, P20, P21, P22, P23, P24, P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35
);

  logic [17:0] a, b, a_q, b_q;
  logic signed [18:0] left, right;
  logic signed [37:0] product, product_q;
  logic [3:0] ce;
  assign a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  assign b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  assign ce = {CE3, CE2, CE1, CE0};

  // The number of an enable is the last letter of its name.
  always_ff @(posedge CLK0) begin
    if (ce[REG_INPUTA_CE[1:0]]) a_q <= a;
    if (ce[REG_INPUTB_CE[1:0]]) b_q <= b;
    if (ce[REG_OUTPUT_CE[1:0]]) product_q <= product;
  end

  assign left = REG_INPUTA_CLK == "CLK0" ? {SIGNEDA & a_q[17], a_q} : {SIGNEDA & a[17], a};
  assign right = REG_INPUTB_CLK == "CLK0" ? {SIGNEDB & b_q[17], b_q} : {SIGNEDB & b[17], b};
  assign product = left * right;
  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
    P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} =
      REG_OUTPUT_CLK == "CLK0" ? product_q[35:0] : product[35:0];

endmodule
