// SPDX-License-Identifier: Apache-2.0
// td_frame_size: columns and rows that arrived last on an AXI4-Stream Video input, of whole and of malformed frames.
//
//   columns  pixels of the last row that ended: words up to a tlast, behind the tlast before it
//   rows     rows that ended in the last frame that ended: tlasts between two words with tuser
//
// Stream in: its words, WordsPerPixel for a pixel, in_valid with each that is taken. 0: none has ended since the reset;
// 2^(CountWidth - 1) stands for more. silent: no word has come since the reset. Latency: 1 cycle. Model:
// models/tactile_depth/chip/common/td_frame_size.py.

`default_nettype none

module td_frame_size #(
  parameter int CountWidth    = 14,
  parameter int WordsPerPixel = 1
) (
  input  wire                   clk,
  input  wire                   rst,
  input  wire                   in_valid,
  input  wire                   in_last,
  input  wire                   in_user,
  output logic [CountWidth-1:0] columns,
  output logic [CountWidth-1:0] rows,
  output logic                  silent
);

  localparam int WordWidth = CountWidth + $clog2(WordsPerPixel);

  logic framed;  // a frame has begun since the reset
  logic [WordWidth-1:0] words, words_now;  // of the row that arrives
  logic [CountWidth-1:0] row;              // rows that have ended in the frame that arrives
  assign words_now = words + WordWidth'(!words[WordWidth-1]);

  always_ff @(posedge clk) begin
    if (in_valid) begin
      silent <= 1'b0;
      framed <= framed | in_user;
      words <= in_last ? '0 : words_now;
      if (in_last) columns <= words_now[WordWidth-1-:CountWidth];
      row <= in_user ? '0 : row + CountWidth'(in_last && framed && !row[CountWidth-1]);
      if (in_user) rows <= row;
    end
    if (rst) begin
      silent <= 1'b1;
      {framed, words, row, columns, rows} <= '0;
    end
  end

  if (CountWidth < 2) begin : g_refused_0
    CountWidth_must_be_at_least_2 u_refused ();
  end
  if (WordsPerPixel < 1 || WordsPerPixel != 1 << $clog2(WordsPerPixel)) begin : g_refused_1
    WordsPerPixel_must_be_a_power_of_two u_refused ();
  end

endmodule

`default_nettype wire
