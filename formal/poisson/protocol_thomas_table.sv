// SPDX-License-Identifier: Apache-2.0
// protocol_thomas_table: rows of the frame; what is read counts once 5 enabled clocks have passed.

`default_nettype none

module protocol_thomas_table #(
  parameter int Rows = 128,
  localparam int RowWidth = $clog2(Rows)
) (
  input  logic                clk,
  input  logic                en,
  input  logic [RowWidth-1:0] row,
  output logic                holds,
  output logic                counts_coefficient,
  output logic                counts_shift
);

  assign holds = {1'b0, row} < (RowWidth + 1)'(Rows);
  settled #(.Clocks(5)) u_settled (.clk, .en(en & holds), .settled(counts_coefficient));
  assign counts_shift = counts_coefficient;

endmodule

`default_nettype wire
