// SPDX-License-Identifier: Apache-2.0
// fv_td_frame_size: columns and rows are those of the row and of the frame that ended last, as marks of the stream say
// where they end; silent is high until the first word. Nothing is assumed of the stream.
//
// The specification counts words and rows without a limit of its own, and compares them with the largest number.

parameter int CountWidth = 3, WordsPerPixel = 1;

localparam int Most = 1 << (CountWidth - 1), Wide = CountWidth + 8;
localparam logic [Wide-1:0] One = 1;
localparam logic [Wide-1:0] Limit = '1;

function automatic logic [CountWidth-1:0] shown(input logic [Wide-1:0] count);
  return 32'(count) > Most ? CountWidth'(Most) : CountWidth'(count);
endfunction
function automatic logic [Wide-1:0] more(input logic [Wide-1:0] count);
  return count == Limit ? Limit : count + One;
endfunction

logic seen, begun;
logic [Wide-1:0] words, ended, last_words, last_rows, row_words;
assign row_words = more(words);
always_ff @(posedge clk) begin
  if (in_valid) begin
    seen <= 1'b1;
    begun <= begun | in_user;
    words <= in_last ? '0 : row_words;
    if (in_last) last_words <= row_words;
    if (in_user) last_rows <= ended;
    if (in_user) ended <= '0;
    else if (in_last && begun) ended <= more(ended);
  end
  if (rst) {seen, begun, words, ended, last_words, last_rows} <= '0;
end

always_comb begin
  if (started) begin
    pixels_of_row: assert (columns == shown(last_words / Wide'(WordsPerPixel)));
    rows_of_frame: assert (rows == shown(last_rows));
    none_yet: assert (silent == !seen);
    largest: cover (columns == CountWidth'(Most) && rows == CountWidth'(Most));
    shrinks: cover (rows == CountWidth'(1) && columns == CountWidth'(2) && ended == Wide'(3));
    no_start: cover (!begun && columns == CountWidth'(3));
  end
end
