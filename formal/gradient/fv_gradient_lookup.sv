// SPDX-License-Identifier: Apache-2.0
// fv_gradient_lookup: the slopes of a pixel are those that stand at the index of its colour in the bank that its frame
// began with, from power-up or as last written; valid and place travel with it, 4 enabled clocks; while en is low all
// outputs hold. An entry asked for stands on the bus 3 clocks later and until the next: that of the bank not in use.
//
// Assumed, as axil_registers and frame_guard have it: nothing is written while a change-over is due, or with a read; the
// first pixels of two frames do not follow each other.

parameter int Width = 1, BitsPerChannel = 1;

// The accesses that reach the table, and the answer to them (fv_td_table_port).
logic table_write, table_read;
logic [IndexWidth-1:0] table_index;
logic [2*Width-1:0] table_word, asked_word;
table_answer_t expected_answer;
td_table_port #(.Select(0), .IndexWidth(IndexWidth), .Width(Width), .Words(2), .Signed(1)) u_port (
  .clk, .rst, .table_command, .table_answer(expected_answer), .write(table_write), .read(table_read),
  .index(table_index), .word(table_word), .free_word(asked_word)
);

always_comb if (!started) assume (!table_bank);

// The table as the register map describes it: red uppermost, then green, then blue.
logic [2*Width-1:0] bank_0[1 << IndexWidth];
logic [2*Width-1:0] bank_1[1 << IndexWidth];
initial $readmemh("gradient.hex", bank_0);
initial $readmemh("gradient.hex", bank_1);
logic [BitsPerChannel-1:0] red, green, blue;
assign red = in_pixel[23:16] >> (8 - BitsPerChannel);
assign blue = in_pixel[15:8] >> (8 - BitsPerChannel);
assign green = in_pixel[7:0] >> (8 - BitsPerChannel);
logic [IndexWidth-1:0] index;
assign index = (IndexWidth'(red) << (2 * BitsPerChannel)) + (IndexWidth'(green) << BitsPerChannel)
    + IndexWidth'(blue);

logic in_use = 1'b0;
logic [1:0] written = '0;
logic begins, used, named, starts_q;  // starts_q: a frame's first pixel waits in front of the table
assign begins = en && in_valid && (in_position & 4'b0011) == 4'b0011;
assign used = en && starts_q ? named : in_use;

logic [3:0] valid;           // of the pixels 1 to 4 enabled clocks ago
logic [15:0] place;
logic [8*Width-1:0] slopes;
logic held;
kept #(.Width(5 + 2 * Width)) u_kept (.clk, .rst, .en, .out({out_valid, out_position, out_gx, out_gy}), .held);
logic asked;                 // a read a clock ago
logic read_known, changed_over;
always_ff @(posedge clk) begin
  in_use <= rst ? table_bank : used;
  if (rst || begins) named <= table_bank;
  if (en) starts_q <= begins;
  if (table_write) written[!in_use] <= 1'b1;
  if (table_write && in_use) bank_0[table_index] <= table_word;
  if (table_write && !in_use) bank_1[table_index] <= table_word;
  if (en) begin
    valid <= {valid[2:0], in_valid};
    place <= {place[11:0], in_position};
    slopes <= {slopes[6*Width-1:0], (begins ? table_bank : named) ? bank_1[index] : bank_0[index]};
  end
  asked <= table_read;
  if (table_read) asked_word <= used ? bank_0[table_index] : bank_1[table_index];
  if (asked) read_known <= 1'b1;
  changed_over <= ~rst & (changed_over | (used != in_use));
  if (rst) begin
    valid <= '0;
    starts_q <= 1'b0;
    asked <= 1'b0;
    read_known <= 1'b0;
  end
end
always_comb begin
  if (started) begin
    bank_shown: assert (table_in_use == in_use);
    valid_travels: assert (out_valid == valid[3]);
    if (out_valid) place_travels: assert (out_position == place[15:12]);
    if (out_valid) slopes_of_index: assert ({out_gy, out_gx} == slopes[6*Width+:2*Width]);
    if (read_known) reads_spare: assert (table_answer == expected_answer);
    from_power_up: cover (out_valid && written == '0);
    from_write: cover (out_valid && changed_over && in_valid && valid == 4'b1111 && held);
    read_in_change: cover (asked && read_known && used != in_use && written == 2'b11 && changed_over);
  end
end

bind dut.u_table.g_bank[0].u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);
bind dut.u_table.g_bank[1].u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check_1 (.*);

// Protocol: nothing is written while a change of bank is due, or with a read. Frames have two pixels or more.
module protocol_gradient_lookup;
  logic begun = 1'b0, named = 1'b0, begins, write, legal, known;
  assign begins = in_valid & in_position[0] & in_position[1];
  table_accesses #(
    .Select(td_register_map_pkg::TableSelectGradient), .Entries(1 << (3 * BitsPerChannel))
  ) u_accesses (.clk, .rst, .holds, .table_command, .write, .read(), .index(), .idle(), .legal, .known);
  assign holds = legal & (rst | ~write | (table_bank == table_in_use & named == table_in_use)) & (rst | ~(begun & begins));
  always_ff @(posedge clk) begin
    if (en && holds) begun <= begins;
    if (reset || (en && begins)) named <= table_bank;
  end
  assign counts_table_in_use = live;
  assign counts_table_answer = live & known;
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_position, counts_out_gx, counts_out_gy} = {3{counts_out_valid & out_valid}};
endmodule
