// SPDX-License-Identifier: Apache-2.0
// depth_value: the 16-bit value of one depth code, or of the mean of four (docs/link.md, formats 2 and 3).
//
//   value = clip( round( (a + b + c + d) / 2^(shift + 2) ) ),  one code a: clip( round( a / 2^shift ) )
//
// It rounds once, to the nearest, ties to even, and clips to 16 bits, signed. Codes come one in a clock at most,
// in_first with the first of a value; average and shift do not change inside a value. Latency: 3 clocks from the last
// code. Model: to_bytes in models/tactile_depth/chip/link/depth_formats.py.

`default_nettype none

module depth_value #(
  parameter int DataWidth = 24
) (
  input  wire                         clk,
  input  wire                         average,   // four codes a value; 0: one
  input  wire  [4:0]                  shift,     // 0 to 16
  input  wire                         in_valid,
  input  wire                         in_first,
  input  wire  signed [DataWidth-1:0] in_code,
  output logic signed [15:0]          value
);

  localparam int SumWidth = DataWidth + 2;
  localparam int Fraction = 18;  // bits that are dropped, at most
  localparam int WideWidth = (DataWidth > 16 ? DataWidth : 16) + 1;

  // One code counts four times, so that 2 bits more than shift are dropped always.
  logic signed [SumWidth-1:0] code, sum;
  logic signed [SumWidth+15:0] shifted;
  logic signed [DataWidth-1:0] whole;
  logic signed [WideWidth-1:0] rounded;
  logic up, clipped;
  assign code = average ? SumWidth'(in_code) : {in_code, 2'b00};
  assign shifted = $signed({sum, 16'd0}) >>> shift;
  assign rounded = WideWidth'(whole) + WideWidth'({1'b0, up});
  assign clipped = rounded[WideWidth-1:15] != {(WideWidth - 15) {rounded[WideWidth-1]}};

  always_ff @(posedge clk) begin
    if (in_valid) sum <= in_first ? code : sum + code;
    whole <= shifted[Fraction+:DataWidth];
    up <= shifted[Fraction-1] & (shifted[Fraction] | shifted[Fraction-2:0] != '0);
    value <= clipped ? {rounded[WideWidth-1], {15{~rounded[WideWidth-1]}}} : rounded[15:0];
  end

endmodule

`default_nettype wire
