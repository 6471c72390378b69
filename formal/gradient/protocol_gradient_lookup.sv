// SPDX-License-Identifier: Apache-2.0
// protocol_gradient_lookup: nothing is written while a change of bank is due, or with a read. Frames have two pixels or
// more. An entry of the table stands 2 clocks after it is asked for.

`default_nettype none

module protocol_gradient_lookup (
  input  logic       clk,
  input  logic       rst,
  input  logic       en,
  input  logic       table_bank,
  input  logic       table_in_use,
  input  logic       table_write,
  input  logic       table_read,
  input  logic       in_valid,
  input  logic [3:0] in_position,
  input  logic       out_valid,
  output logic       holds,
  output logic       counts_out_valid,
  output logic       counts_out_position,
  output logic       counts_out_gx,
  output logic       counts_out_gy,
  output logic       counts_table_read_gx,
  output logic       counts_table_read_gy,
  output logic       counts_table_in_use
);

  logic reset, live = 1'b0, asked = 1'b0, reads = 1'b0, begun = 1'b0, named = 1'b0, begins;
  assign reset = rst | ~holds;
  assign begins = in_valid & in_position[0] & in_position[1];
  assign holds = (~table_write | (~rst & table_bank == table_in_use & named == table_in_use & ~table_read))
      & (~table_read | ~rst) & ~(begun & begins);
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en && holds) begun <= begins;
    if (reset || (en && begins)) named <= table_bank;
    asked <= ~reset & table_read;
    if (reset) reads <= 1'b0;
    else if (asked) reads <= 1'b1;
  end
  assign counts_table_in_use = live;
  assign {counts_table_read_gx, counts_table_read_gy} = {2{live & reads}};
  assign counts_out_valid = live & ~reset & en;
  assign {counts_out_position, counts_out_gx, counts_out_gy} = {3{counts_out_valid & out_valid}};

endmodule

`default_nettype wire
