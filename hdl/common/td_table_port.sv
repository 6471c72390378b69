// SPDX-License-Identifier: Apache-2.0
// td_table_port: the place of one table on the bus of the tables.
//
// The bus comes from afar, so it has a register here: what it says to the table `Select` stands on write, read, index
// and word 1 cycle later. The table answers a read with free_word 1 cycle after it: with Entries of them side by side,
// of which the lowest bits of the index name one; a number past the last reads 0. That entry stands on table_answer
// from 3 cycles after the read on the bus until the next read of this table, in each cycle behind one in which the bus
// names the table; otherwise table_answer is 0, so that answers are combined by OR. A reset withdraws an access that
// has not reached the table. Cycle-accurate model: models/tactile_depth/chip/common/td_table_port.py.

`default_nettype none

module td_table_port
  import td_types_pkg::*;
#(
  parameter int Select     = 0,   // number of the table in TABLE_SELECT
  parameter int IndexWidth = 12,
  parameter int Width      = 24,  // of a word
  parameter int Words      = 1,   // of an entry; 2: the upper one is in TABLE_HIGH
  parameter int Entries    = 1,   // side by side in a word of the memory
  parameter int Signed     = 0    // words are signed
) (
  input  wire                            clk,
  input  wire                            rst,
  input  wire table_command_t            table_command,
  output table_answer_t                  table_answer,
  output logic                           write,
  output logic                           read,
  output logic [IndexWidth-1:0]          index,
  output logic [Words*Width-1:0]         word,
  input  wire  [Entries*Words*Width-1:0] free_word
);

  localparam int EntryWidth = $clog2(Entries) + 1;

  logic names, selected, read_q;
  logic write_now = 1'b0;  // a cycle before the first reset writes nothing
  logic [Entries*Words*Width-1:0] answers;  // of all entries of the word that was read: a memory is slow
  logic [Words*Width-1:0] answer;
  logic [1:0][EntryWidth-1:0] entry;        // of the last read, and of `answers`
  assign answer = (Words * Width)'(answers >> (32'(entry[1]) * 32'($unsigned(Words * Width))));
  assign names = table_command.select == 2'(Select);
  assign write = write_now & ~rst;

  always_ff @(posedge clk) begin
    selected <= names;
    write_now <= table_command.write & names;
    read <= table_command.read & names;
    index <= table_command.index[IndexWidth-1:0];
    word <= (Words * Width)'({table_command.high[Width-1:0], table_command.low[Width-1:0]});
    read_q <= read;
    if (read) entry[0] <= EntryWidth'(index) & EntryWidth'($unsigned((1 << $clog2(Entries)) - 1));
    if (read_q) {entry[1], answers} <= {entry[0], free_word};
    if (rst) {write_now, read} <= '0;
  end

  logic [Words-1:0][31:0] extended;
  for (genvar w = 0; w < Words; w++) begin : g_word
    logic [31:0] signs;
    assign signs = {32{Signed != 0 & answer[(w+1)*Width-1]}};
    assign extended[w] = selected ? 32'({signs, answer[w*Width+:Width]}) : '0;
  end
  assign table_answer.low = extended[0];
  assign table_answer.high = Words > 1 ? extended[Words-1] : '0;

  if (Words < 1 || Words > 2 || Width > 32) begin : g_refused
    an_entry_is_1_or_2_words_of_at_most_32_bits u_refused ();
  end

endmodule

`default_nettype wire
