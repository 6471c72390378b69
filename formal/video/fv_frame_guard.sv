// SPDX-License-Identifier: Apache-2.0
// fv_frame_guard: whatever arrives, only whole frames leave; every fault is flagged once; a whole frame passes
// unchanged, behind a fault too; an early start is kept. Nothing is assumed of the source, nor of en and the time-out,
// nor of s_test, with which a frame is marked and `hunting` stays.
//
// The specification is an automaton on frames that counts pixels, not rows and columns:
//   Idle    between frames; if it hunts, behind a fault, words go until a start
//   Open    `count` pixels of a frame taken, nothing wrong
//   Broken  a fault in the frame: filled up

parameter int Rows = 3, Columns = 4;

localparam int Pixels = Rows * Columns, CountWidth = $clog2(Pixels + 1);
localparam logic [CountWidth-1:0] One = 1;
localparam logic [CountWidth-1:0] Whole = Pixels;

logic row_short, row_long, start_missing, start_early, timed_out;
assign {timed_out, start_early, start_missing, row_long, row_short} = faults;

// What should happen in this clock.
typedef enum logic [1:0] {Idle, Open, Broken} state_e;
logic hunts, hunts_next;
state_e state, state_next;
logic [CountWidth-1:0] count, count_next;
logic [31:0] silence;  // enabled clocks without a word since the last one of an open frame
logic expired;         // they have reached the timeout of the last of them
logic pixel, filler, row_now, whole_now, short_now, long_now, missing_now, early_now, timed_out_now, fault;
always_comb begin
  pixel = s_valid && (state == Idle ? s_user : state == Open && !s_user);
  filler = state == Broken;
  row_now = (count + One) % CountWidth'(Columns) == '0;
  whole_now = count + One == Whole;
  short_now = pixel && s_last && !row_now;
  long_now = pixel && !s_last && row_now;
  missing_now = state == Idle && s_valid && !s_user && !hunts;
  early_now = state == Open && s_valid && s_user;
  timed_out_now = state == Open && !s_valid && expired;
  fault = short_now || long_now || early_now || timed_out_now;
  count_next = pixel || filler ? count + One : count;
  state_next = state;
  hunts_next = hunts;
  if (!s_test && missing_now) hunts_next = 1'b1;
  if (!s_test && pixel) hunts_next = 1'b0;
  if (pixel || fault || filler) begin
    state_next = filler || fault ? Broken : Open;
    if (count_next == Whole) begin
      if (!s_test) hunts_next = filler || fault;
      state_next = Idle;
      count_next = '0;
    end
  end
end

// What should leave in the next enabled clock, and what left in this frame.
logic leaves, leaves_bad, leaves_test, held, framed;
logic [CountWidth-1:0] place;
logic [23:0] data;
logic [CountWidth-1:0] waited;  // enabled clocks for which a start has been refused
logic [1:0] flagged;            // faults flagged in the frame now coming in, or between frames
logic behind_fault;
kept #(.Width(30)) u_kept (.clk, .rst, .en, .out({out_valid, out_data, out_position, out_bad}), .held);
always_ff @(posedge clk) begin
  if (en) begin
    state <= state_next;
    hunts <= hunts_next;
    leaves_test <= s_test;
    count <= count_next;
    silence <= s_valid || state != Open ? '0 : silence + 32'd1;
    expired <= !s_valid && state == Open && timeout != 0 && silence + 32'd1 >= timeout;
    leaves <= pixel | filler;
    place <= count;
    if (pixel) data <= s_data;
    leaves_bad <= filler | fault;
    waited <= s_valid && s_user && !s_ready ? waited + One : '0;
    if (leaves && place == Whole - One) behind_fault <= leaves_bad;
  end
  if (rst) begin
    state <= Idle;
    hunts <= 1'b0;
    count <= '0;
    leaves <= 1'b0;
    silence <= '0;
    expired <= 1'b0;
    waited <= '0;
    behind_fault <= 1'b0;
  end
end

// Faults flagged since the frame that is now coming in began, by the ports alone.
logic [1:0] flags, flags_in_frame;
assign flags = 2'(row_short) + 2'(row_long) + 2'(start_early) + 2'(timed_out);
always_ff @(posedge clk) begin
  if (en) flags_in_frame <= (pixel || filler) && count_next == '0 ? '0 : flags_in_frame + flags;
  if (rst) flags_in_frame <= '0;
end
logic [1:0] flags_of_frame;  // those of the frame whose last pixel is present
always_ff @(posedge clk) if (en) flags_of_frame <= flags_in_frame + flags;

// The place of the pixel that leaves, by the ports alone.
logic [CountWidth-1:0] left;
always_ff @(posedge clk) begin
  if (en && out_valid) left <= out_frame_end ? '0 : left + One;
  if (rst) left <= '0;
end

always_comb begin
  if (started) begin
    drops: assert (hunting == hunts);
    next_pixel: assert ({between, row_ends, frame_ends} == {state == Idle, row_now, whole_now});
    ready: assert (s_ready == (en && (state == Idle || !s_user)));
    flags_mean: assert ({row_short, row_long, start_missing, start_early, timed_out}
        == (en ? {short_now, long_now, missing_now, early_now, timed_out_now} : 5'd0));
    flagged_once: assert (32'(flags_in_frame) + 32'(flags) <= 1);
    early_start_kept: assert (waited <= Whole);  // 1 to be seen, then the rest of the frame
    if (s_valid && s_ready && s_user) start_begins_frame: assert (pixel && count == '0);

    leaves_as_it_should: assert (out_valid == leaves);
    if (out_valid) begin
      pixels_in_order: assert (out_data == data && left == place);
      first_row: assert (out_position.first_row == (left < CountWidth'(Columns)));
      last_row: assert (out_position.last_row == (left >= CountWidth'(Pixels - Columns)));
      first_column: assert (out_position.first_column == (left % CountWidth'(Columns) == '0));
      last_column: assert (out_position.last_column == ((left + One) % CountWidth'(Columns) == '0));
    end
    frame_start: assert (out_frame_start == (out_valid && left == '0));
    frame_end: assert (out_frame_end == (out_valid && left == Whole - One));
    if (out_frame_end) marked: assert (out_bad == (flags_of_frame == 2'd1 || leaves_test));
    if (out_frame_end) mark_expected: assert (out_bad == (leaves_bad || leaves_test) && out_test == leaves_test);

    good_after_fault: cover (out_frame_end && !out_bad && behind_fault);
    filled: cover (out_frame_end && out_bad && hunts && !out_test);
    refused_longest: cover (waited == Whole);
    tested: cover (out_frame_end && out_test && hunting);
    long_at_end: cover (en && long_now && count == Whole - One);
    missing: cover (start_missing);
    timed_out_late: cover (timed_out && timeout == 32'd3);
    back_to_back: cover (out_frame_start && out_data == 24'h123456 && !behind_fault && held);
  end
end
