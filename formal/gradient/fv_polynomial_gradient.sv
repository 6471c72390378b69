// SPDX-License-Identifier: Apache-2.0
// fv_polynomial_gradient: the coefficient that a pixel meets is that of its place in its frame, from the words that stood
// in the bank which the frame began with, from power-up or as last written; valid and place travel with the pixel, 12
// enabled clocks; while en is low all outputs hold. A word read stands on the bus 3 clocks later and until the
// next: that of the bank not in use. A colour's words change over 1, 2 or 3 enabled clocks behind the first pixel.
//
// One polynomial is followed: the deviations of the other colours are zero, and the corrections, which the simulation
// checks. Assumed, as axil_registers and frame_guard
// have it: nothing is written while a change-over is due or in the clock of a read; frames are whole.

`default_nettype none

module fv_polynomial_gradient
  import td_types_pkg::*;
#(
  parameter int Polynomial = 0,
  parameter int Rows       = 2,
  parameter int Columns    = 8,
  parameter int WordWidth  = 1,
  localparam int Terms = 10,
  localparam int IndexWidth = 6
) (
  input logic                        clk,
  input logic                        rst,
  input logic                        en,
  input logic                        table_bank,
  input table_command_t              table_command,
  input logic                        in_valid,
  input logic signed [1:0]           deviation
);

  localparam int Latency = 12;
  localparam int Colour = Polynomial % 3;
  localparam int Axis = Polynomial / 3;
  localparam int Width = WordWidth + 1;  // twice the lowest coefficient does not fit

  // Whole frames.
  logic [3:0] row, column, in_position;
  logic begins, begins_row;
  assign in_position = {column == 4'(Columns - 1), row == 4'(Rows - 1), column == '0, row == '0};
  assign begins = en && in_valid && row == '0 && column == '0;
  assign begins_row = en && in_valid && row != '0 && column == '0;

  logic out_valid, table_in_use;
  table_answer_t table_answer, expected_answer;
  logic [3:0] out_position;
  logic [1:0] saturations;
  logic signed [Width-1:0] out_gx, out_gy, slope;
  assign slope = Axis != 0 ? out_gy : out_gx;
  polynomial_gradient #(
    .Width(Width), .DeviationWidth(2), .CoeffWidth(WordWidth), .WordWidth(WordWidth), .FineBits(0), .CorrectionWidth(1),
    .CorrectionUnit(1), .Drop(0)
  ) dut (
    .*, .correction_gx(1'b0), .correction_gy(1'b0), .in_red(Colour == 0 ? deviation : 2'd0), .in_green(Colour == 1 ? deviation : 2'd0),
    .in_blue(Colour == 2 ? deviation : 2'd0)
  );

  // The accesses that reach the table, and the answer to them (fv_td_table_port).
  logic table_write, table_read;
  logic [IndexWidth-1:0] table_index;
  logic [WordWidth-1:0] table_word, asked_word;
  td_table_port #(.Select(1), .IndexWidth(IndexWidth), .Width(WordWidth), .Signed(1)) u_port (
    .clk, .rst, .table_command, .table_answer(expected_answer), .write(table_write), .read(table_read),
    .index(table_index), .word(table_word), .free_word(asked_word)
  );

  logic started = 1'b0;
  always_comb if (!started) assume (rst && !table_bank);

  // The words as the register map describes them.
  logic [WordWidth-1:0] words_0[Terms], words_1[Terms];  // of both banks
  initial begin
    $readmemh({"polynomial_", 8'(48 + Polynomial), ".hex"}, words_0);
    $readmemh({"polynomial_", 8'(48 + Polynomial), ".hex"}, words_1);
  end
  logic own;
  logic [3:0] term;
  assign own = 32'(table_index) >= Terms * Polynomial && 32'(table_index) < Terms * (Polynomial + 1);
  assign term = 4'(table_index - IndexWidth'(Terms * Polynomial));

  logic in_use = 1'b0;  // by the frame that is taken, or was
  logic used, named, of_colour, reported;
  logic [2:0] begun;    // a first pixel, so many enabled clocks ago
  assign used = begins ? table_bank : in_use;
  logic colour_used;
  assign colour_used = en && begun[Colour] ? named : of_colour;

  // The polynomial at once, where it stands after the pixel that is taken.
  logic [Terms-1:0][WordWidth-1:0] words;  // of the bank in use
  for (genvar t = 0; t < Terms; t++) begin : g_term
    assign words[t] = used ? words_1[t] : words_0[t];
  end
  logic [WordWidth-1:0] value, step, second, value_now, step_now, second_now;
  logic [WordWidth-1:0] row_value, row_step, row_second, value_rise, value_bend, step_rise;
  assign value_now = begins ? words[0] : begins_row ? row_value + value_rise : value + step;
  assign step_now = begins ? words[1] : begins_row ? row_step + step_rise : step + second;
  assign second_now = begins ? words[2] : begins_row ? row_second + words[9] : second + words[3];

  logic [Latency-1:0] valid;
  logic [4*Latency-1:0] place;
  logic [(WordWidth+2)*Latency-1:0] product;
  logic signed [WordWidth+1:0] exact;
  logic signed [1:0] deviation_q;
  logic held, moved, asked, asked_own, read_known, changed_over, overwritten;
  logic [4+2*Width:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en & ~rst;
    moved <= en & ~rst;
    out_q <= {out_valid, out_position, out_gx, out_gy};
    if (rst || begins) {in_use, named} <= {2{table_bank}};
    of_colour <= rst ? table_bank : colour_used;
    reported <= rst ? table_bank : en && begun[2] ? named : reported;
    if (en) begun <= {begun[1:0], begins};
    if (table_write && own && in_use) words_0[term] <= table_word;
    if (table_write && own && !in_use) words_1[term] <= table_word;
    if (table_write && own) overwritten <= 1'b1;
    if (en && in_valid) begin
      value <= value_now;
      step <= step_now;
      second <= second_now;
      if (begins || begins_row) begin
        row_value <= value_now;
        row_step <= step_now;
        row_second <= second_now;
        value_rise <= begins ? words[4] : value_rise + value_bend;
        value_bend <= begins ? words[5] : value_bend + words[7];
        step_rise <= begins ? words[6] : step_rise + words[8];
      end
      column <= column == 4'(Columns - 1) ? '0 : column + 4'd1;
      if (column == 4'(Columns - 1)) row <= row == 4'(Rows - 1) ? '0 : row + 4'd1;
    end
    if (en) begin
      valid <= {valid[Latency-2:0], in_valid};
      place <= {place[4*Latency-5:0], in_position};
      product <= {
        product[(WordWidth+2)*(Latency-1)-1:0], (WordWidth + 2)'($signed(value_now)) * (WordWidth + 2)'(deviation)
      };
    end
    asked <= table_read;
    asked_own <= own;
    if (table_read) asked_word <= colour_used ? words_0[term] : words_1[term];
    if (asked) read_known <= asked_own;
    changed_over <= ~rst & (changed_over | (begins & table_bank != in_use));
    if (rst) begin
      valid <= '0;
      row <= '0;
      column <= '0;
      asked <= 1'b0;
      begun <= '0;
      read_known <= 1'b0;
    end
  end
  always_comb begin
    if (table_write) assume (table_bank == reported && begun == '0 && !table_read);
    if (table_write || table_read) assume (32'(table_index) < 6 * Terms);
  end

  logic clips;
  assign exact = $signed(product[(WordWidth+2)*Latency-1-:WordWidth+2]);
  assign clips = exact[WordWidth+1] != exact[WordWidth];
  always_comb begin
    if (started) begin
      bank_shown: assert (table_in_use == reported);
      valid_travels: assert (out_valid == valid[Latency-1]);
      if (out_valid) place_travels: assert (out_position == place[4*Latency-1-:4]);
      if (out_valid && !clips) slope_of_place: assert (slope == exact[WordWidth:0]);
      if (out_valid && clips) saturated: assert (slope == {exact[WordWidth+1], {WordWidth{~exact[WordWidth+1]}}});
      if (moved && out_valid) clips_counted: assert (clips ? saturations != '0 : saturations < 2'd2);
      if (!moved || !out_valid) no_clips_counted: assert (saturations == '0);
      if (held) holds: assert ({out_valid, out_position, out_gx, out_gy} == out_q);
      if (read_known) reads_spare: assert (table_answer == expected_answer);
      from_power_up: cover (out_valid && clips && out_position[2] && !changed_over);
      from_write: cover (out_valid && clips && out_position[2] && changed_over && overwritten && held);
    end
  end

endmodule

`default_nettype wire
