// SPDX-License-Identifier: Apache-2.0
// fv_td_table_port: an access of its own table reaches the table one clock later, unless a reset comes with it, or
// with a write then; no other does. The entry that the last read named, of those that the table showed behind it, each
// word extended to 32 bits, stands on the bus while the bus named the table in the clock before; otherwise zeros.
// Whatever the bus says.

parameter int Select = 2, IndexWidth = 2, Width = 2, Words = 2, Entries = 1, Signed = 1;

logic started = 1'b0;
logic own, rst_q, reads_q, known;  // known: an entry was read
table_command_t command_q;
logic [Words-1:0][Width-1:0] entry, shown;
logic [IndexWidth-1:0] read_index;
always_comb begin
  shown = '0;
  for (int place = 0; place < Entries; place++) begin
    if (32'(read_index) % (1 << $clog2(Entries)) == place) shown = free_word[place*Words*Width+:Words*Width];
  end
end
assign own = command_q.select == 2'(Select);
always_ff @(posedge clk) begin
  started <= 1'b1;
  rst_q <= rst;
  command_q <= table_command;
  reads_q <= started && own && command_q.read && !rst_q;
  read_index <= command_q.index[IndexWidth-1:0];
  if (started && reads_q) {known, entry} <= {1'b1, shown};
  if (!started) known <= 1'b0;
end

function automatic logic [31:0] extended(input logic [Width-1:0] of_entry);
  return Signed != 0 ? 32'($signed(of_entry)) : 32'(of_entry);
endfunction

always_comb begin
  if (!started) before_power_up: assert (!write);
  if (started) begin
    written: assert (write == (own && command_q.write && !rst_q && !rst));
    asked: assert (read == (own && command_q.read && !rst_q));
    if (write || read) which: assert (index == command_q.index[IndexWidth-1:0]);
    if (write) low_word: assert (word[Width-1:0] == command_q.low[Width-1:0]);
    if (write && Words > 1) high_word: assert (word[Words*Width-1-:Width] == command_q.high[Width-1:0]);
    if (!own) silent: assert (table_answer == '0);
    if (own && known) answers_low: assert (table_answer.low == extended(entry[0]));
    if (own && known) answers_high: assert (table_answer.high == (Words > 1 ? extended(entry[Words-1]) : '0));
    another_named_meanwhile: cover (known && own && table_answer.low != '0 && !reads_q && table_command.read);
    withdrawn: cover (rst && own && command_q.write && command_q.read);
  end
end

// Protocol: anything on the bus. Index and word count with an access, an entry once one was read.
module protocol_td_table_port;
  logic named = 1'b0, read_q = 1'b0, known = 1'b0;
  always_ff @(posedge clk) begin
    named <= table_command.select == 2'(Select);
    read_q <= live & read;
    known <= known | read_q;
  end
  assign holds = 1'b1;
  assign {counts_write, counts_read} = {2{live}};
  assign counts_index = live & (write | read);
  assign counts_word = live & write;
  assign counts_table_answer = live & (~named | known);
endmodule
