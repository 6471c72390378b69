// SPDX-License-Identifier: Apache-2.0
// td_repeat_check: whether the words of a frame, which a table alone decides, are those of the frame before.
//
// Each frame gets a signature: the one so far, rotated, and the word, folded. `differs` is high two cycles after a
// frame's last word, en or not, if that frame and the one before it came whole, from one bank, with signatures that
// differ. Any single bit of a word changes the signature. Stream in: frames of two words or more, gaps anywhere.
// Bit-accurate model: models/tactile_depth/chip/common/td_repeat_check.py.

`default_nettype none

module td_repeat_check #(
  parameter int Width = 36
) (
  input  wire             clk,
  input  wire             rst,
  input  wire             en,
  input  wire             in_valid,
  input  wire             in_first,  // with in_valid: the first word of a frame
  input  wire             in_last,   // with in_valid: the last word of a frame
  input  wire             in_bank,   // with in_first: the bank of the table
  input  wire [Width-1:0] in_data,
  output logic            differs
);

  localparam int SignatureWidth = 19;  // a prime: an error that repeats does not cancel in a power of two of words

  logic [SignatureWidth-1:0] folded, signature, signature_before;
  logic bank, whole, compares, ends;
  always_comb begin
    folded = '0;
    for (int place = 0; place < Width; place++) begin
      folded[place%SignatureWidth] = folded[place%SignatureWidth] ^ in_data[place];
    end
  end

  always_ff @(posedge clk) begin
    if (en && in_valid) begin
      signature <= folded ^ (in_first ? '0 : {signature[SignatureWidth-2:0], signature[SignatureWidth-1]});
      if (in_first) bank <= in_bank;
      if (in_first) compares <= whole & (in_bank == bank);
      whole <= in_last;
    end
    ends <= en & in_valid & in_last;
    if (ends) signature_before <= signature;
    differs <= ends & compares & (signature != signature_before);
    if (rst) {whole, compares, ends, differs} <= '0;
  end

endmodule

`default_nettype wire
