// SPDX-License-Identifier: Apache-2.0
// table_accesses: accesses of the bus that reach the table behind a td_table_port, one clock after they were on the
// bus, and when the answer is known: while another table is named, and from three clocks behind a read.

`default_nettype none

module table_accesses
  import td_types_pkg::*;
#(
  parameter int Select  = 0,
  parameter int Entries = 1
) (
  input  logic           clk,
  input  logic           rst,
  input  logic           holds,          // of the protocol: in a clock without, the core sees zeros and a reset
  input  table_command_t table_command,
  output logic           write,          // but for a reset
  output logic           read,
  output logic [23:0]    index,
  output logic           idle,           // no read is under way
  output logic           legal,          // an entry that there is; never both accesses at once
  output logic           known           // the answer counts
);

  logic own, other = 1'b0, write_q = 1'b0, read_q = 1'b0, asked = 1'b0, answered = 1'b0;
  assign own = table_command.select == 2'(Select);
  assign legal = ~own | ((~table_command.write | ~table_command.read)
      & (~(table_command.write | table_command.read) | table_command.index < 24'(Entries)));
  assign {write, read, idle} = {write_q, read_q, ~asked};
  assign known = other | answered;
  always_ff @(posedge clk) begin
    other <= holds ? ~own : Select != 0;
    write_q <= own & table_command.write & ~rst & holds;
    read_q <= own & table_command.read & ~rst & holds;
    index <= table_command.index;
    asked <= read_q & ~rst & holds;
    answered <= ~rst & holds & (answered | asked);
  end

endmodule

`default_nettype wire
