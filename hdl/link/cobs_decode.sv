// SPDX-License-Identifier: Apache-2.0
// cobs_decode: pieces between the zero bytes of a line, with the zeros back in that COBS took out (docs/link.md).
//
// Bytes in at any time, never held back; in_broken stands for a byte that could not be received. A code n below 255
// stands for the n - 1 bytes behind it and a zero, 255 for 254 bytes and no zero. The zero comes out with the next
// code, so that the last one of a piece does not. Out: a byte for each byte in but the codes without a zero before
// them; out_end at the delimiter of a piece that is not empty, with out_bad if the last code points beyond the end, a
// byte was broken, or the piece is longer than Longest. Nothing comes out before the first delimiter after a reset.
// Latency: 1 cycle. Cycle-accurate model: models/tactile_depth/chip/link/cobs_decode.py.

`default_nettype none

module cobs_decode #(
  parameter int Longest = td_link_pkg::LongestPiece  // bytes of a piece
) (
  input  wire        clk,
  input  wire        rst,
  input  wire        in_valid,
  input  wire  [7:0] in_data,
  input  wire        in_broken,  // without in_valid
  output logic       out_valid,
  output logic [7:0] out_data,
  output logic       out_end,    // without out_valid
  output logic       out_bad     // counts with out_end
);

  localparam int LengthWidth = $clog2(Longest + 2);
  localparam logic [LengthWidth-1:0] TooLong = LengthWidth'(Longest + 1);
  localparam logic [7:0] Full = 8'd255;  // the code without a zero

  logic begun;                     // a delimiter has come since the reset
  logic [LengthWidth-1:0] length;  // of the piece; TooLong stands for more, and for a piece with a broken byte
  logic [7:0] left;                // bytes that the last code still stands for
  logic zero_due;                  // the last code stands for a zero too
  logic delimiter, code;
  assign delimiter = in_valid & (in_data == '0);
  assign code = left == '0;

  always_ff @(posedge clk) begin
    out_valid <= begun & in_valid & ~delimiter & (~code | zero_due);
    out_data <= code ? '0 : in_data;
    out_end <= delimiter & (length != '0);
    out_bad <= ~code | (length == TooLong);
    if (delimiter) begin
      begun <= 1'b1;
      length <= '0;
      left <= '0;
      zero_due <= 1'b0;
    end else if (in_valid) begin
      if (begun && length != TooLong) length <= length + LengthWidth'(1);
      left <= (code ? in_data : left) - 8'd1;
      if (code) zero_due <= in_data != Full;
    end else if (in_broken && begun) begin
      length <= TooLong;
    end
    if (rst) begin
      out_valid <= 1'b0;
      out_end <= 1'b0;
      begun <= 1'b0;
      length <= '0;
      left <= '0;
      zero_due <= 1'b0;
    end
  end

endmodule

`default_nettype wire
