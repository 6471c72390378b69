// SPDX-License-Identifier: Apache-2.0
// fv_camera_window: the pixels of whole pictures leave with their marks; every fault of a picture before the window's
// last pixel is flagged once, and one break leaves for it; an early start is kept.
//
// The specification is an automaton on pictures that counts words, not rows, columns and bytes. Nothing is assumed of the
// source and of en. Settings are small and may change in every clock; a picture has those of the clock before its start.

parameter int WordsPerPixel = 1, PixelPairs = 0;
localparam int WindowColumns = 2, WindowRows = 2;
localparam int Bits = 3;  // of a setting
input logic [3:0][Bits-1:0] chosen;

typedef logic [7:0] count_t;

assign columns = 13'(chosen[3]);
assign rows = 13'(chosen[2]);
assign window_x = 13'(chosen[1]);
assign window_y = 13'(chosen[0]);
always_comb assume (chosen[3] <= 3'd4 && chosen[2] <= 3'd3);

// Settings of a picture that starts now, and of the present one.
logic [4*Bits-1:0] settings_q, settings;
count_t c, r, x, y;  // columns, rows, the window's first column and row
logic open, fits;
count_t usable;
assign {c, r, x, y} = {
  count_t'(settings[3*Bits+:Bits]), count_t'(settings[2*Bits+:Bits]), count_t'(settings[Bits+:Bits]),
  count_t'(settings[0+:Bits])
};
logic [4*Bits-1:0] picture;  // settings of the open picture
assign settings = open ? picture : settings_q;
assign usable = PixelPairs != 0 && c[0] ? c - 8'd1 : c;
assign fits = x + count_t'(WindowColumns) <= usable && y + count_t'(WindowRows) <= r;

// The word: how many of the picture come before it, and where it is.
count_t count, in_row, row, column, needed, needed_column;
logic half, row_ends, word, starts, drops, passed;
assign in_row = c * count_t'(WordsPerPixel);
assign row = count / (in_row == '0 ? 8'd1 : in_row);
assign column = (count % (in_row == '0 ? 8'd1 : in_row)) / count_t'(WordsPerPixel);
assign half = WordsPerPixel == 2 && !count[0];  // the row of words has an even length
assign row_ends = (count + 8'd1) % (in_row == '0 ? 8'd1 : in_row) == '0;
assign needed_column = PixelPairs != 0 ? (x + count_t'(WindowColumns - 1)) | 8'd1 : x + count_t'(WindowColumns - 1);
assign needed = ((y + count_t'(WindowRows - 1)) * c + needed_column + 8'd1) * count_t'(WordsPerPixel);

logic misplaced, outside, early, missing, short_now, long_now, fault, ends, pixel;
assign starts = s_valid && !open && s_user;
assign word = starts || (s_valid && open && !s_user);
assign passed = open && count >= needed;
assign outside = starts && !fits;
assign misplaced = word && !outside && s_last != row_ends;
assign early = s_valid && open && s_user;
assign missing = s_valid && !open && !s_user && !drops;
assign short_now = misplaced && s_last && !passed;
assign long_now = misplaced && !s_last && !passed;
assign fault = outside || short_now || long_now || missing || (early && !passed);
assign ends = outside || misplaced || early || (word && count + 8'd1 == in_row * r);
assign pixel = word && !outside && !misplaced && !half;

logic leaves, breaks, held;
logic [4:0] marks;
logic [23:0] data;
logic [7:0] low;
kept #(.Width(31)) u_kept (
  .*, .out({out_valid, out_abort, out_data, out_inside, out_odd_row, out_odd_column, out_row_start, out_frame_start})
);
always_ff @(posedge clk) begin
  settings_q <= chosen;
  if (en) begin
    leaves <= pixel;
    breaks <= fault;
    marks <= {
      row >= y && row < y + count_t'(WindowRows) && column >= x && column < x + count_t'(WindowColumns), row[0],
      column[0], column == x, column == x && row == y
    };
    if (word && half) low <= s_data[7:0];
    data <= WordsPerPixel == 2 ? {8'd0, s_data[7:0], low} : s_data;
    if (word) begin
      open <= 1'b1;
      drops <= 1'b0;
      picture <= settings;
      count <= count + 8'd1;
    end
    if (missing || misplaced || outside || early) drops <= 1'b1;
    if (ends) begin
      open <= 1'b0;
      count <= '0;
    end
  end
  if (rst) begin
    leaves <= 1'b0;
    breaks <= 1'b0;
    open <= 1'b0;
    drops <= 1'b0;
    count <= '0;
  end
end

always_comb begin
  if (started) begin
    ready: assert (s_ready == (en && (!open || !s_user)));
    flags: assert ({row_short, row_long, start_missing, start_early, window_outside}
        == (en ? {short_now, long_now, missing, early && !passed, outside} : 5'd0));
    hunts: assert (hunting == drops);
    in_time: assert ({out_valid, out_abort} == {leaves, breaks});
    if (out_valid) begin
      pixels: assert (out_data == data);
      marked: assert ({out_inside, out_odd_row, out_odd_column} == marks[4:2]);
      if (out_inside) started_marks: assert ({out_row_start, out_frame_start} == marks[1:0]);
    end

    window_passes: cover (out_valid && out_inside && passed && x == (PixelPairs != 0 ? 8'd0 : 8'd1) && y == 8'd1);
    harmless: cover (en && misplaced && passed);
    harmless_start: cover (en && early && passed);
    leaves_the_picture: cover (en && outside && c == 8'd4 && x == 8'd3);
    broken_at_the_end: cover (en && long_now && count + 8'd1 == needed);
    two_pictures: cover (starts && en && out_valid && !drops);
  end
end
