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

  // Counts that begin again have a reset of their own, which costs no logic.
  logic row_ends, frame_starts;
  assign row_ends = in_valid & in_last;
  assign frame_starts = in_valid & in_user;
  always_ff @(posedge clk) begin
    if (rst || row_ends) words <= '0;
    else if (in_valid) words <= words_now;
    if (rst || frame_starts) row <= '0;
    else if (row_ends && framed && !row[CountWidth-1]) row <= row + CountWidth'(1);
    if (row_ends) columns <= words_now[WordWidth-1-:CountWidth];
    if (frame_starts) rows <= row;
    if (in_valid) silent <= 1'b0;
    if (frame_starts) framed <= 1'b1;
    if (rst) begin
      silent <= 1'b1;
      {framed, columns, rows} <= '0;
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
