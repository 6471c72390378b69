// SPDX-License-Identifier: Apache-2.0
// table_signatures: says which tables are in use, by a signature of the words of each.
//
//   signature = signature_step(.. signature_step(32'hffffffff, first word) .., last word)
//
// The words are those that the host writes, one after another: TABLE_HIGH, if entries have two, and TABLE_LOW of each
// entry from index 0 to the last; or those of a capture. A bank's signature is known from 4 cycles after the last of a
// run of all its words. Any entry that is written outside such a run makes it unknown a cycle later; reads of entries,
// a write of TABLE_INDEX, a word for another table and rst end a run. `last` of the host: the index is 0 a cycle after
// the write. File gives the signatures at power-up: those of bank 0 and bank 1 of each table, 0 for unknown; without
// File none is known, nor after cold_rst. A change-over shows in read_data 1 cycle later.
// Model: models/tactile_depth/chip/registers/table_signatures.py.

`default_nettype none

module table_signatures
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter     File = "",
  parameter int Side = 1  // words of the zero offset in a step of its capture
) (
  input  wire                   clk,
  input  wire                   rst,
  input  wire                   cold_rst,
  input  wire                   write,
  input  wire  [31:0]           write_offset,
  input  wire  [31:0]           write_mask,  // ones in bytes with strobe
  input  wire  [31:0]           read_offset,
  output logic [31:0]           read_data,   // the word at read_offset, 0 where there is none

  input  wire table_command_t   table_command,  // low: the data of each write
  input  wire  [3:0]            table_in_use,
  input  wire captured_t        reference_captured,
  input  wire captured_t        zero_captured
);

  localparam logic [1:0] Gradient = 2'(TableSelectGradient);
  localparam logic [1:0] Reference = 2'(TableSelectReference);
  localparam logic [1:0] Zero = 2'(TableSelectZero);

  // Words of the host. Its bus has a register here, because whether an entry is written is known late in a cycle.

  logic [1:0] select, host_table;
  logic first, upper, lower, whole, reads, moves, in_order, is_half, host_starts, host_steps, host_ends;
  logic [31:0] low, host_word;
  assign in_order = lower ? is_half == (select == Gradient) : upper && select == Gradient && !is_half && whole;
  assign host_starts = in_order && first && !is_half && !rst;
  always_ff @(posedge clk) begin
    {lower, reads, select, low} <= {table_command.write, table_command.read, table_command.select, table_command.low};
    first <= table_command.index == '0;
    upper <= write && write_offset == TableHighOffset;
    moves <= write && write_offset == TableIndexOffset;
    whole <= &write_mask;
    host_table <= select;
    host_steps <= in_order && !rst;
    host_ends <= lower;
    host_word <= in_order ? low : '0;
    if (upper || lower) is_half <= upper && in_order;
    if (rst) {lower, reads, upper, moves, is_half} <= '0;
  end

  // The run of words: one at a time.

  logic runs = 1'b0;      // a cycle before the first reset writes no signature
  logic finished = 1'b0;
  logic bank_run, starts, steps, zero_steps, disturbed, ends;
  logic [1:0] table_run, table_started;
  logic [31:0] signature, advanced;
  assign zero_steps = zero_captured.steps;
  assign starts = host_starts || reference_captured.starts || zero_captured.starts;
  assign table_started = host_starts ? select : reference_captured.starts ? Reference : Zero;
  assign steps = host_steps || reference_captured.steps || zero_steps;
  assign disturbed = ((lower || (upper && select == Gradient)) && !in_order) || reads || moves
    || table_in_use[table_run] == bank_run || (host_steps && host_table != table_run)
    || (reference_captured.steps && table_run != Reference) || (zero_steps && table_run != Zero);
  assign ends = (host_steps && host_ends && first) || reference_captured.ends || zero_captured.ends;
  for (genvar n = 0; n < Side; n++) begin : g_side
    logic [31:0] later;  // the signature after n words of 0
    if (n == 0) begin : g_first
      assign later = signature;
    end else begin : g_next
      assign later = signature_step(g_side[n-1].later, '0);
    end
  end
  assign advanced = zero_steps ? g_side[Side-1].later : signature;

  always_ff @(posedge clk) begin
    if (steps) signature <= signature_step(advanced, host_word | reference_captured.word | zero_captured.word);
    runs <= runs && !disturbed && !ends;
    finished <= runs && !disturbed && ends && !starts && !rst;
    if (starts) begin
      runs <= 1'b1;
      table_run <= table_started;
      bank_run <= !table_in_use[table_started];
      signature <= '1;
    end
    if (rst) runs <= 1'b0;
  end

  // The signature of each bank, and whether a capture was the last to write the bank.

  logic [3:0] written, captured;
  logic [7:0] known = {8{1'(File != "")}};  // of bank 0 and bank 1 of each table; no reset: nor have the tables
  logic [7:0] held = '0;
  logic [7:0] changed;
  logic [2:0] bank_in_use;
  logic is_known;
  logic [31:0] signature_in_use;
  assign bank_in_use = {table_command.select, table_in_use[table_command.select]};
  assign captured = (4'(reference_captured.writes) << Reference) | (4'(zero_captured.writes) << Zero);
  assign written = (4'(lower) << select) | captured;
  for (genvar n = 0; n < 8; n++) begin : g_bank
    assign changed[n] = written[n/2] && table_in_use[n/2] != 1'(n % 2);
    always_ff @(posedge clk) begin
      if (finished && {table_run, bank_run} == 3'(n)) known[n] <= 1'b1;
      if (changed[n]) held[n] <= captured[n/2];
      if (changed[n] || cold_rst) known[n] <= 1'b0;
      if (cold_rst) held[n] <= 1'b0;
    end
  end
  always_ff @(posedge clk) if (!finished) is_known <= known[bank_in_use];
  td_ram #(.Width(32), .Depth(8), .Style(0), .File(File)) u_signatures (
    .clk, .write_en(finished), .write_address({table_run, bank_run}), .write_data(signature),
    .read_en(!finished), .read_address(bank_in_use), .read_data(signature_in_use)
  );
  assign read_data = read_offset == TableSignatureOffset && is_known ? signature_in_use
    : read_offset == ReferenceCaptureOffset ? 32'(held[{Reference, table_in_use[Reference]}]) << ReferenceCaptureHeldBit
    : read_offset == ZeroCaptureOffset ? 32'(held[{Zero, table_in_use[Zero]}]) << ZeroCaptureHeldBit : '0;

endmodule

`default_nettype wire
