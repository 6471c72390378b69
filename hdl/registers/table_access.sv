// SPDX-License-Identifier: Apache-2.0
// table_access: reads and writes the entries of the tables, one after another.
//
// TABLE_INDEX is the entry that is written or read next; it moves on after either, from the last entry to the first.
// A write of TABLE_LOW makes that entry {TABLE_HIGH, TABLE_LOW}: table_command.write is high with `write`. A read of
// TABLE_HIGH or TABLE_LOW raises table_command.read in the cycle after `read`; the entry's words shall stand on
// table_answer from 3 cycles later until the next such read, and stand on late_data then. Refused: what has no entry, a
// write with a byte that is not strobed, and a write of a table that is `closed`. A write that is refused does nothing.
// In a reset neither is commanded. Whether there is an entry comes from a register, because it begins long paths: no
// access and no other `select` may come in the cycle before one, where the access of a read is the cycle after `read`.
// Model: models/tactile_depth/chip/registers/table_access.py.

`default_nettype none

module table_access
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter int GradientWords    = 4096,  // entries of each table; 0: the build has none
  parameter int CoefficientWords = 0,
  parameter int ReferenceWords   = 0,
  parameter int ZeroWords       = 0
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  write,
  input  wire  [31:0]          write_offset,
  input  wire  [31:0]          write_ones,  // the data, 0 in bytes without strobe
  input  wire  [31:0]          write_mask,  // ones in bytes with strobe
  output logic                 write_refused,
  input  wire                  read,
  input  wire  [31:0]          read_offset,
  output logic [31:0]          read_data,   // the word at read_offset, 0 where there is none
  output logic                 read_late,   // the word at read_offset comes as late_data, 4 cycles later
  output logic [31:0]          late_data,
  output logic                 late_refused,

  input  wire  [1:0]           select,      // TABLE_SELECT
  input  wire  [3:0]           closed,      // tables that are not to be written
  output table_command_t       table_command,
  input  wire table_answer_t   table_answer
);

  localparam int SlopeWords = GradientWords > CoefficientWords ? GradientWords : CoefficientWords;
  localparam int MapWords = ReferenceWords > ZeroWords ? ReferenceWords : ZeroWords;
  localparam int IndexWidth = $clog2(SlopeWords > MapWords ? SlopeWords : MapWords);

  function automatic logic [31:0] words(input int code);  // entries of a table
    case (code)
      TableSelectGradient: return GradientWords;
      TableSelectCoefficients: return CoefficientWords;
      TableSelectReference: return ReferenceWords;
      default: return ZeroWords;
    endcase
  endfunction

  // Each table compares the index with its constant, and `select` chooses behind: a short path from `select`.
  logic [TableSelectSelectCount-1:0] has, ends;
  logic [31:0] high;
  logic [IndexWidth-1:0] index;
  logic has_entry, writes, asked, reads, asked_low, had_entry;
  for (genvar code = 0; code < TableSelectSelectCount; code++) begin : g_table
    assign has[code] = 32'(index) < words(code);
    assign ends[code] = index == IndexWidth'(words(code) - 32'd1);
  end

  always_comb begin
    case (read_offset)
      TableIndexOffset: read_data = 32'(index);
      TableSizeOffset: read_data = words(32'(select));
      default: read_data = '0;
    endcase
  end
  assign write_refused = write_offset == TableLowOffset && (!has_entry || !(&write_mask) || closed[select]);
  assign writes = write && write_offset == TableLowOffset && !write_refused && !rst;
  assign reads = asked && has_entry && !rst;
  assign read_late = read_offset == TableHighOffset || read_offset == TableLowOffset;
  assign late_refused = !had_entry;
  assign late_data = !had_entry ? '0 : asked_low ? table_answer.low : table_answer.high;
  assign table_command.write = writes;
  assign table_command.read = reads;
  assign table_command.select = select;
  assign table_command.index = 24'(index);
  assign table_command.high = high;
  assign table_command.low = write_ones;

  always_ff @(posedge clk) begin
    has_entry <= has[select];
    asked <= read && read_late;
    if (read) asked_low <= read_offset == TableLowOffset;
    if (asked) had_entry <= has_entry;
    if (writes || (reads && asked_low)) index <= ends[select] ? '0 : index + IndexWidth'(1);
    if (write && write_offset == TableIndexOffset) index <= IndexWidth'(write_ones | (32'(index) & ~write_mask));
    if (write && write_offset == TableHighOffset) high <= write_ones | (high & ~write_mask);
    if (rst) {asked, index, high} <= '0;
  end

endmodule

`default_nettype wire
