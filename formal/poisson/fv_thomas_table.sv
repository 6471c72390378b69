// SPDX-License-Identifier: Apache-2.0
// fv_thomas_table: the coefficient of an arbitrary position and row, 3 enabled clocks later, is that of square.hex,
// which says for every row and position which word that is: base + min(row, settled), in the last row one of its own
// with its shift.

parameter int Rows = 6, Columns = 4, Words = 12, CoeffWidth = 5, SettledWidth = 3, LastShiftWidth = 2;
input logic pick;

localparam int Latency = 5;

logic [LastShiftWidth+CoeffWidth-1:0] square[Rows*Columns];
initial $readmemh("square.hex", square);

localparam int Width = LastShiftWidth + CoeffWidth;
logic due, held;
logic [Width-1:0] expected;
always_comb assume (u_protocol.allowed);
follow_delay #(.Width(Width), .Latency(Latency)) u_follow (
  .clk, .rst(1'b0), .en, .pick, .in(square[32'(row) * Columns + 32'(position)]), .due, .word(expected)
);
kept #(.Width(Width)) u_kept (.clk, .rst(1'b0), .en, .out({shift, coefficient}), .held);

always_comb begin
  if (due) own_coefficient: assert ({shift, coefficient} == expected);
  inner: cover (due && shift == '0 && held);
  last: cover (due && shift != '0 && held);
end
