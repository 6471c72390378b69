// SPDX-License-Identifier: Apache-2.0
// protocol_polynomial_gradient: frames of two rows or more, of eight pixels or more, cut short by a reset alone; how long
// they are is left open. Nothing is written while a change of bank is due, or in the clock of a read. Inputs stay while
// en is low.

`default_nettype none

module protocol_polynomial_gradient (
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
  output logic       counts_table_in_use,
  output logic       counts_table_answer,
  output logic       counts_saturations
);

  logic reset, live = 1'b0, begun = 1'b0, second_row = 1'b0, named = 1'b0, still = 1'b0, valid_before, place_legal;
  logic write, legal, known;
  logic [2:0] column = '0;  // pixels of this row so far, up to seven
  logic [3:0] place_before;
  assign reset = rst | ~holds;
  assign place_legal = begun ? ~in_position[1] | (column == 3'd7 & (~in_position[0] | second_row)) : &in_position[1:0];
  assign holds = (~in_valid | rst | place_legal)
      & (~still | rst | (in_valid == valid_before & (~in_valid | in_position == place_before)))
      & (rst | ~write | (table_bank == table_in_use & named == table_in_use)) & legal;
  table_accesses #(.Select(td_register_map_pkg::TableSelectCoefficients), .Entries(60)) u_accesses (
    .clk, .rst, .holds, .table_command, .write, .read(), .index(), .idle(), .legal, .known
  );
  always_ff @(posedge clk) begin
    live <= live | reset;
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

`default_nettype wire
