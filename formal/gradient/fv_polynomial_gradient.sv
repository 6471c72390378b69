// SPDX-License-Identifier: Apache-2.0
// fv_polynomial_gradient: in frames of any size of two rows or more, of eight pixels or more, the coefficient that a
// pixel meets is that of its place in its frame, from the words that stood in the bank which the frame began with, from
// power-up or as last written; the correction that is added is the one that came 4 enabled clocks behind the pixel.
// Valid and place travel with the pixel, 12 enabled clocks; while en is low all outputs hold. A word read stands on the
// bus 3 clocks later and until the next: that of the bank not in use. A colour's words change over 1, 2 or 3 enabled
// clocks behind the first pixel.
//
// One polynomial is followed: the deviations of the other colours are zero. Assumed, as axil_registers and frame_guard
// have it: nothing is written while a change-over is due or in the clock of a read; frames are whole.
//
// The polynomial is evaluated as the pixel reaches the core's register of it, by the same differences; the words are
// taken at once, when the frame begins. The steps of the induction say what each register of the core holds meanwhile.

parameter int Polynomial = 0, WordWidth = 2, FineBits = 1, CoeffWidth = 2, CorrectionUnit = 3;
localparam int Width = CoeffWidth + 1;  // twice the lowest coefficient does not fit
localparam int DeviationWidth = 2, CorrectionWidth = 2, Drop = 0;
input logic signed [1:0] deviation;

localparam int Latency = 12, Colour = Polynomial % 3, Axis = Polynomial / 3, Total = WordWidth + FineBits,
    ProductWidth = CoeffWidth + 2;
localparam int Exact = ProductWidth + 2;  // bits of a sum
localparam int ToValue = 5 + Colour;  // enabled clocks from the first in which a pixel waits to its coefficient

assign in_red = Colour == 0 ? deviation : 2'd0;
assign in_green = Colour == 1 ? deviation : 2'd0;
assign in_blue = Colour == 2 ? deviation : 2'd0;
table_answer_t expected_answer;
logic signed [Width-1:0] slope;
logic signed [1:0] correction;
assign slope = Axis != 0 ? out_gy : out_gx;
assign correction = Axis != 0 ? correction_gy : correction_gx;

// The accesses that reach the table, and the answer to them (fv_td_table_port).
logic table_write, table_read;
logic [IndexWidth-1:0] table_index;
logic [WordWidth-1:0] table_word, asked_word;
td_table_port #(.Select(1), .IndexWidth(IndexWidth), .Width(WordWidth), .Signed(1)) u_port (
  .clk, .rst, .table_command, .table_answer(expected_answer), .write(table_write), .read(table_read),
  .index(table_index), .word(table_word), .free_word(asked_word)
);

protocol_polynomial_gradient u_protocol (  // what the inputs do while en is low is free
  .clk, .rst, .en(1'b1), .table_command, .table_bank, .table_in_use, .in_valid(in_valid & en), .in_position,
  .out_valid, .holds(allowed)
);

// The words as the register map describes them, those of the frame, and the banks.
logic [WordWidth-1:0] words_0[Terms], words_1[Terms];  // of both banks
initial begin
  $readmemh({"polynomial_", 8'(48 + Polynomial), ".hex"}, words_0);
  $readmemh({"polynomial_", 8'(48 + Polynomial), ".hex"}, words_1);
end
logic own;
logic [3:0] term;
assign own = 32'(table_index) >= Terms * Polynomial && 32'(table_index) < Terms * (Polynomial + 1);
assign term = 4'(table_index - IndexWidth'(Terms * Polynomial));

logic begins, in_use, of_colour, colour_used, reported;  // in_use: bank of the frame that is taken, or was
logic [WordWidth-1:0] words[Terms];
logic [Total-1:0] wide[Terms];  // with all fraction bits
assign begins = en && in_valid && &in_position[1:0];
for (genvar t = 0; t < Terms; t++) begin : g_term
  assign wide[t] = t == 3 || t >= 7 ? Total'($signed(words[t])) : Total'(words[t]) << FineBits;
  always_ff @(posedge clk) if (begins) words[t] <= table_bank ? words_1[t] : words_0[t];
end

// The pixels taken 0 to 11 enabled clocks before the last.
logic [Latency-1:0] valid, first, other;  // first pixels of a frame, of its other rows
logic [Latency-1:0][3:0] place;
logic [Latency-1:0][1:0] deviations, corrections;  // corrections: of pixels that have got theirs
always_comb begin
  for (int k = 0; k < Latency; k++) begin
    first[k] = valid[k] & (&place[k][1:0]);
    other[k] = valid[k] & place[k][1] & ~place[k][0];
  end
end
assign colour_used = en && first[Colour] ? in_use : of_colour;

// The polynomial where it stands for a pixel that reached its coefficient.
logic known;
logic [Total-1:0] value, step, second, third, value_now, step_now, second_now;
logic [Total-1:0] row_value, row_step, row_second, value_rise, value_bend, step_rise;
logic starts, starts_row;
assign starts = first[ToValue-1];
assign starts_row = other[ToValue-1];
assign value_now = starts ? wide[0] : starts_row ? row_value + value_rise : value + step;
assign step_now = starts ? wide[1] : starts_row ? row_step + step_rise : step + second;
assign second_now = starts ? wide[2] : starts_row ? row_second + wide[9] : second + third;
logic [Latency-1:0][ProductWidth-1:0] products;  // of pixels behind it

function automatic logic signed [Exact-1:0] total(input logic [ProductWidth-1:0] product, input logic [1:0] added);
  return Exact'($signed(product)) + Exact'($signed(added)) * Exact'(CorrectionUnit);
endfunction

logic held, moved, asked, asked_own, read_known, change_begun, changed_over, overwritten;
kept #(.Width(5 + 2 * Width)) u_kept (.clk, .rst, .en, .out({out_valid, out_position, out_gx, out_gy}), .held);
always_ff @(posedge clk) begin
  moved <= en & ~rst;
  if (rst || begins) in_use <= table_bank;
  of_colour <= rst ? table_bank : colour_used;
  reported <= rst ? table_bank : en && first[2] ? in_use : reported;
  if (table_write && own && in_use) words_0[term] <= table_word;
  if (table_write && own && !in_use) words_1[term] <= table_word;
  if (table_write && own) overwritten <= 1'b1;
  if (en) begin
    valid <= {valid[Latency-2:0], in_valid};
    place <= {place[Latency-2:0], in_position};
    deviations <= {deviations[Latency-2:0], deviation};
    corrections <= {corrections[Latency-2:4], correction, 8'd0};
    products <= {products[Latency-2:0], ProductWidth'(0)};
    products[ToValue+1] <= ProductWidth'($signed(value[Total-1-:CoeffWidth]))
        * ProductWidth'($signed(deviations[ToValue]));
    if (valid[ToValue-1]) {value, step, second} <= {value_now, step_now, second_now};
    if (starts || starts_row) begin
      {row_value, row_step, row_second} <= {value_now, step_now, second_now};
      value_rise <= starts ? wide[4] : value_rise + value_bend;
      value_bend <= starts ? wide[5] : value_bend + wide[7];
      step_rise <= starts ? wide[6] : step_rise + wide[8];
    end
    if (starts) {known, third} <= {1'b1, wide[3]};
  end
  asked <= table_read;
  asked_own <= own;
  if (table_read) asked_word <= colour_used ? words_0[term] : words_1[term];
  if (asked) read_known <= asked_own;
  change_begun <= ~rst & (change_begun | (begins & u_protocol.begun & table_bank != in_use));
  changed_over <= ~rst & (changed_over | (en & first[Latency-2] & change_begun));  // of pixels that leave
  if (rst) begin
    valid <= '0;
    {known, asked, read_known} <= '0;
  end
end

logic clips;
logic signed [Exact-1:0] exact;
assign exact = total(products[Latency-1], corrections[Latency-1]);
assign clips = exact != Exact'($signed(exact[Width-1:0]));
always_comb begin
  if (started) begin
    bank_shown: assert (table_in_use == reported);
    valid_travels: assert (out_valid == valid[Latency-1]);
    if (out_valid) place_travels: assert (out_position == place[Latency-1]);
    if (out_valid && !clips) slope_of_place: assert (slope == exact[Width-1:0]);
    if (out_valid && clips) saturated: assert (slope == {exact[Exact-1], {Width - 1{~exact[Exact-1]}}});
    if (moved && out_valid) clips_counted: assert (clips ? saturations != '0 : saturations < 2'd2);
    if (!moved || !out_valid) no_clips_counted: assert (saturations == '0);
    if (read_known) reads_spare: assert (table_answer == expected_answer);
    from_power_up: cover (out_valid && clips && other[Latency-1] && corrections[Latency-1] != '0 && !changed_over);
    from_write: cover (out_valid && clips && changed_over && overwritten && held);
  end
end

// The steps of the induction: how far lines are apart, and what the core's registers hold.

logic in_frame;
logic [Latency-1:0] line;  // first pixels of rows
assign in_frame = u_protocol.begun;
assign line = first | other;
for (genvar k = 0; k < Latency; k++) begin : g_stage
  localparam int Apart = k < 8 ? 0 : k - 7;  // stages of lines that may follow this one
  always_comb begin
    if (started) begin
      if (k < 7 && line[k]) row_is_short: assert (32'(u_protocol.column) <= k);
      if (line[k]) rows_apart: assert ((line & 12'((1 << k) - (1 << Apart))) == '0);
      if (first[k]) frames_apart: assert ((first & 12'((1 << k) - 1)) == '0);
      if (first[k] && u_protocol.second_row) two_rows: assert ((line & 12'((1 << Apart) - 1)) != '0);
      if (valid[k] && k < ToValue && !known) begin_first: assert ((first & 12'((1 << ToValue) - (1 << k))) != '0);
    end
  end
end
logic [Latency-2:0] places_kept;
logic [6:4] corrections_kept;
always_comb begin
  for (int k = 0; k < Latency - 1; k++) places_kept[k] = !valid[k] || dut.position_q[k] == place[k];
  for (int k = 4; k < 7; k++) corrections_kept[k] = !valid[k] || dut.u_corrections.g_shift.taps[k-4][2*Axis+:2] == corrections[k];
  if (started) begin
    places_wait: assert (places_kept == '1);
    corrections_wait: assert (corrections_kept == '1);
    if (valid[7]) correction_scaled: assert (Exact'(dut.g_axis[Axis].correction) == total('0, corrections[7]));
    if (!in_frame) nothing_taken: assert (valid == '0 && !known);
    if (!known) none_known: assert (valid[Latency-1:ToValue] == '0);
    if (in_frame && !known) frame_comes: assert (first[ToValue-1:0] != '0);
  end
end

// The core's words of this polynomial and its differences. Those of rows move in the core's ring in the 6 enabled clocks
// from the third behind a row's first pixel on, later by the number of the colour; the polynomial above takes them at
// once, in the third of these clocks.
logic core_named, core_bank, last_named;
logic [WordWidth-1:0] core_word;
logic [3:0] core_term;
assign core_term = dut.g_axis[Axis].g_colour[Colour].term;
logic [Total-1:0] core_value, core_step, core_second, core_third;
logic [5:0][Total-1:0] core_ring;
assign core_named = dut.g_axis[Axis].g_colour[Colour].u_words.named;
assign last_named = dut.g_axis[1].g_colour[2].u_words.named;
assign core_bank = dut.g_axis[Axis].g_colour[Colour].u_words.bank;
assign core_word = dut.g_axis[Axis].g_colour[Colour].word;
assign core_value = dut.g_axis[Axis].g_colour[Colour].value;
assign core_step = dut.g_axis[Axis].g_colour[Colour].step_now;
assign core_second = dut.g_axis[Axis].g_colour[Colour].second;
assign core_third = dut.g_axis[Axis].g_colour[Colour].third;
assign core_ring = dut.g_axis[Axis].g_colour[Colour].ring;

// In the order D, A, B, E, H, F: differences of a frame's first row, of this row, of the next and of the last.
logic [5:0][Total-1:0] of_frame, of_row, coming, gone;
logic rising;  // the differences of this row are of use: no frame begins
assign rising = known && first[ToValue-1:0] == '0;
logic [4:2] new_frame;  // a frame's first pixel is so many stages and those of its colour on, before its coefficient
assign of_frame = {wide[5], wide[6], wide[4], wide[1], wide[0], wide[2]};
assign of_row = {value_bend, step_rise, value_rise, row_step, row_value, row_second};
assign coming = {value_bend + wide[7], step_rise + wide[8], value_rise + value_bend, row_step + step_rise,
    row_value + value_rise, row_second + wide[9]};
assign gone = {value_bend - wide[7], step_rise - wide[8], value_rise - value_bend + wide[7], {3 * Total{1'b0}}};
for (genvar k = 2; k <= 4; k++) assign new_frame[k] = |(first[ToValue-1:0] >> (k + Colour));
for (genvar i = 0; i < 6; i++) begin : g_difference
  always_comb begin
    if (started && rising && line[7+Colour:3+Colour] == '0) stands: assert (core_ring[i] == of_row[i]);
  end
  for (genvar k = 3; k < 8; k++) begin : g_moved  // so many stages on, k - 2 of them have moved
    localparam int Place = (i + k - 2) % 6;
    localparam logic Moved = i + k - 2 >= 6, Taken = k > 4;
    always_comb begin
      if (started && rising && other[k+Colour]) begin
        rises: assert (core_ring[i] == (Moved == Taken ? of_row[Place] : Moved ? coming[Place] : gone[Place]));
      end
      if (started && Moved && first[k+Colour]) loads: assert (core_ring[i] == of_frame[Place]);
    end
  end
end
always_comb begin
  if (started) begin
    bank_named: assert (u_protocol.named == in_use && core_named == in_use && last_named == in_use);
    bank_of_colour: assert (core_bank == of_colour && of_colour == (first[Colour:0] != '0 ? reported : in_use));
    bank_settles: assert (first[2:0] != '0 || reported == in_use);
    if (asked && asked_own) word_fetched: assert (dut.fetched_word == asked_word);
    ports_alike: assert ({dut.table_write, dut.table_read, dut.u_port.selected}
        == {table_write, table_read, u_port.selected} && u_protocol.write == u_port.write_now);
    if (table_write || table_read) begin
      accesses_alike: assert ({dut.table_index, dut.table_word} == {table_index, table_word});
    end
    if (asked || read_known) asked_then: assert ({dut.u_port.read_q, u_port.read_q} == {2{asked}});
    if (read_known) word_answered: assert (dut.u_port.answer == u_port.answer);
    frames_marked: assert (dut.first_q == first[9:0]);
    rows_marked: assert (dut.row_q == line[9:0]);
    pixels_marked: assert (dut.valid_q == valid[Latency-2:0]);
    moves_marked: assert (dut.g_axis[Axis].g_colour[Colour].loads == (first[2+Colour+:6] != '0)
        && dut.g_axis[Axis].g_colour[Colour].moves == (line[2+Colour+:6] != '0)
        && dut.g_axis[Axis].g_colour[Colour].by_word == (line[2+Colour] | line[6+Colour] | line[7+Colour]));

    // The words of a frame come early: T, by which the pixels before them no longer change.
    if (new_frame[2]) third_comes: assert (core_third == wide[3]);
    if (known && !new_frame[2]) third_stands: assert (core_third == third);
    if (known) begin
      value_of_pixel: assert (core_value == value);
      if (!new_frame[4]) step_of_pixel: assert (core_step == step);
      if (!new_frame[3]) second_of_pixel: assert (core_second == second);
      if (first[7+Colour:ToValue] != '0) taken: assert (of_row == of_frame);
    end
  end
end
for (genvar t = 0; t < Terms; t++) begin : g_word
  localparam int Read = 32'(40'h1_5_6_5_6_4_0_1_3_2 >> 4 * t) & 15;  // stages on, a line reads the word
  logic [WordWidth-1:0] core_word_0, core_word_1;  // of both banks
  assign core_word_0 = dut.g_axis[Axis].g_colour[Colour].u_words.g_bank[0].u_ram.g_distributed.words[t];
  assign core_word_1 = dut.g_axis[Axis].g_colour[Colour].u_words.g_bank[1].u_ram.g_distributed.words[t];
  always_comb begin
    banks_are_those: assert ({core_word_1, core_word_0} == {words_1[t], words_0[t]});
    if (started) begin
      if (in_frame) words_stay: assert (words[t] == (in_use ? words_1[t] : words_0[t]));
      if (t < 7 && first[Read+Colour]) term_of_frame: assert (32'(core_term) == t);
      if (t >= 7 && rising && other[Read+Colour]) term_of_row: assert (32'(core_term) == t);
      in_table: assert (32'(core_term) < Terms);
      if (t < 7 && first[Read+1+Colour]) word_of_frame: assert (core_word == words[t]);
      if (t >= 7 && rising && other[Read+1+Colour]) word_of_row: assert (core_word == words[t]);
    end
  end
end

// Products and sums.
for (genvar c = 0; c < 3; c++) begin : g_sum
  logic [6+c:0][1:0] waiting;
  logic [6+c:0] waits;
  logic signed [ProductWidth-1:0] factors, product;
  logic signed [Exact-1:0] sum;
  assign waiting = dut.g_wait[c].u_wait.g_shift.taps;
  assign factors = ProductWidth'($signed(dut.coefficients[c][Axis])) * ProductWidth'($signed(dut.late[c]));
  assign product = dut.g_axis[Axis].g_colour[c].product;
  assign sum = Exact'($signed(dut.sums[3*Axis+c]));
  always_comb begin
    for (int k = 0; k < 7 + c; k++) waits[k] = !valid[k] || waiting[k] == (c == Colour ? deviations[k] : '0);
    if (started) begin
      deviations_wait: assert (waits == '1);
      if (valid[6+c]) multiplied: assert (factors == (c == Colour ? products[6+c] : '0));
      if (valid[7+c]) product_kept: assert (product == (c == Colour ? products[7+c] : '0));
      if (valid[8+c]) added: assert (sum == total(c < Colour ? '0 : products[8+c], corrections[8+c]));
    end
  end
end

bind dut.g_axis[Axis].g_colour[Colour].u_words.g_bank[0].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_0 (.*);
bind dut.g_axis[Axis].g_colour[Colour].u_words.g_bank[1].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_1 (.*);

// Protocol: frames of two rows or more, of eight pixels or more, cut short by a reset alone; how long they are is
// left open. Nothing is written while a change of bank is due, or in the clock of a read. Inputs stay while en is
// low.
module protocol_polynomial_gradient;
  logic begun = 1'b0, second_row = 1'b0, named = 1'b0, still = 1'b0, valid_before, place_legal;
  logic write, legal, known;
  logic [2:0] column = '0;  // pixels of this row so far, up to seven
  logic [3:0] place_before;
  assign place_legal = begun ? ~in_position[1] | (column == 3'd7 & (~in_position[0] | second_row)) : &in_position[1:0];
  assign holds = (~in_valid | rst | place_legal)
      & (~still | rst | (in_valid == valid_before & (~in_valid | in_position == place_before)))
      & (rst | ~write | (table_bank == table_in_use & named == table_in_use)) & legal;
  table_accesses #(.Select(td_register_map_pkg::TableSelectCoefficients), .Entries(60)) u_accesses (
    .clk, .rst, .holds, .table_command, .write, .read(), .index(), .idle(), .legal, .known
  );
  always_ff @(posedge clk) begin
    still <= ~en & ~reset;
    valid_before <= in_valid;
    place_before <= in_position;
    if (reset || (en && in_valid && &in_position[1:0])) named <= table_bank;
    if (en && in_valid) begin
      begun <= 1'b1;
      column <= in_position[1] ? '0 : column + 3'(column != 3'd7);
      if (in_position[1]) second_row <= ~in_position[0];
    end
    if (reset) begin
      begun <= 1'b0;
      second_row <= 1'b0;
      column <= '0;
    end
  end
  assign counts_table_in_use = live;
  assign counts_table_answer = live & known;
  assign counts_saturations = live & ~reset;
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_position, counts_out_gx, counts_out_gy} = {3{counts_out_valid & out_valid}};
endmodule
