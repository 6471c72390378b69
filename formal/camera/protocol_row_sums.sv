// SPDX-License-Identifier: Apache-2.0
// protocol_row_sums: after a reset the first pixel begins a row; sums count where a block ends.

`default_nettype none

module protocol_row_sums (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_valid,
  input  logic in_row_start,
  input  logic out_ends,
  output logic holds,
  output logic counts_out_ends,
  output logic counts_out_sums,
  output logic counts_out_red_columns
);

  logic reset, live = 1'b0, in_row = 1'b0;
  assign reset = rst | ~holds;
  assign holds = rst | ~in_valid | in_row | in_row_start;
  always_ff @(posedge clk) begin
    live <= live | reset;
    in_row <= ~reset & (in_row | (en & in_valid));
  end
  assign counts_out_ends = live & ~reset;
  assign {counts_out_sums, counts_out_red_columns} = {2{counts_out_ends & out_ends}};

endmodule

`default_nettype wire
