// SPDX-License-Identifier: Apache-2.0
// fv_frame_output: a frame that is due and good leaves whole, with frame_start on its first word, row_end on the last of
// each row and frame_end on its last; a bad one, or one that does not begin when due, does not leave at all; out_of_step is high
// exactly where bursts and frames do not begin as they should. Whatever bursts come, and whenever frames are due.

parameter int Width = 1, Rows = 3, Columns = 4;

localparam int Pixels = Rows * Columns, CountWidth = $clog2(Pixels + 1);

logic [CountWidth-1:0] left;  // words of the frame after this clock's
logic present, good, good_q;
logic [CountWidth-1:0] word;
assign present = in_due | (left != '0);
assign word = in_due ? '0 : CountWidth'(Pixels) - left;
assign good = in_due ? in_frame_start & ~in_bad : good_q;
logic row_begins;
assign row_begins = present & (word % CountWidth'(Columns) == '0);

logic [CountWidth-1:0] sent;  // words of this frame that left
always_ff @(posedge clk) begin
  if (en) begin
    left <= in_due ? CountWidth'(Pixels - 1) : left != '0 ? left - CountWidth'(1) : left;
    good_q <= good;
    if (present) sent <= (in_due ? '0 : sent) + CountWidth'(out_valid);
  end
  if (rst) left <= '0;
end

always_comb begin
  if (started) begin
    whole: assert (active == present && out_valid == (present && good));
    if (out_position.frame_end) begin
      all_or_none: assert ((in_due ? '0 : sent) + CountWidth'(out_valid) == (good ? CountWidth'(Pixels) : '0));
    end
    start_on_first: assert (out_position.frame_start == (present && word == '0));
    last_of_row: assert (out_position.row_end == (present && (word + CountWidth'(1)) % CountWidth'(Columns) == '0));
    if (out_valid) unchanged: assert (out_data == in_data);
    frame_end_on_last: assert (out_position.frame_end == (present && word == CountWidth'(Pixels - 1)));
    in_step_or_said: assert (out_of_step == (in_start != row_begins || in_frame_start != in_due));
    good_frame: cover (out_position.frame_end && good && !out_of_step);
    not_begun: cover (out_position.frame_end && !good && !in_bad);
  end
end
