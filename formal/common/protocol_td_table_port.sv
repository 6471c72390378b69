// SPDX-License-Identifier: Apache-2.0
// protocol_td_table_port: anything on the bus. Index and word count with an access, an entry once one was read.

`default_nettype none

module protocol_td_table_port #(
  parameter int Select = 0
) (
  input  logic                        clk,
  input  logic                        rst,
  input  td_types_pkg::table_command_t table_command,
  input  logic                        write,
  input  logic                        read,
  output logic                        holds,
  output logic                        counts_write,
  output logic                        counts_read,
  output logic                        counts_index,
  output logic                        counts_word,
  output logic                        counts_table_answer
);

  logic live = 1'b0, named = 1'b0, read_q = 1'b0, known = 1'b0;
  always_ff @(posedge clk) begin
    live <= live | rst;
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

`default_nettype wire
