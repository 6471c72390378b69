// SPDX-License-Identifier: Apache-2.0
// protocol_gradient_lookup: nothing is written while a change of bank is due, or with a read. Frames have two pixels or
// more.

`default_nettype none

module protocol_gradient_lookup #(
  parameter int BitsPerChannel = 4
) (
  input  logic       clk,
  input  logic       rst,
  input  logic       en,
  input  td_types_pkg::table_command_t table_command,
  input  logic       table_bank,
  input  logic       table_in_use,
  input  logic       in_valid,
  input  logic [3:0] in_position,
  input  logic       out_valid,
  output logic       holds,
  output logic       counts_out_valid,
  output logic       counts_out_position,
  output logic       counts_out_gx,
  output logic       counts_out_gy,
  output logic       counts_table_answer,
  output logic       counts_table_in_use
);

  logic reset, live = 1'b0, begun = 1'b0, named = 1'b0, begins, write, legal, known;
  assign reset = rst | ~holds;
  assign begins = in_valid & in_position[0] & in_position[1];
  table_accesses #(
    .Select(td_register_map_pkg::TableSelectGradient), .Entries(1 << (3 * BitsPerChannel))
  ) u_accesses (.clk, .rst, .holds, .table_command, .write, .read(), .index(), .idle(), .legal, .known);
  assign holds = legal & (rst | ~write | (table_bank == table_in_use & named == table_in_use)) & (rst | ~(begun & begins));
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en && holds) begun <= begins;
    if (reset || (en && begins)) named <= table_bank;
  end
  assign counts_table_in_use = live;
  assign counts_table_answer = live & known;
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_position, counts_out_gx, counts_out_gy} = {3{counts_out_valid & out_valid}};

endmodule

`default_nettype wire
