// SPDX-License-Identifier: Apache-2.0
// fv_thomas_table: the coefficient of an arbitrary position and row, 3 enabled clocks later, is that of square.hex,
// which says for every row and position which word that is: base + min(row, settled), in the last row one of its own
// with its shift.

`default_nettype none

module fv_thomas_table #(
  parameter int Rows           = 6,
  parameter int Columns        = 4,
  parameter int Words          = 12,
  parameter int CoeffWidth     = 5,
  parameter int SettledWidth   = 3,
  parameter int LastShiftWidth = 2,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows)
) (
  input logic                     clk,
  input logic                     en,
  input logic [PositionWidth-1:0] position,
  input logic [RowWidth-1:0]      row,
  input logic                     pick
);

  localparam int Latency = 5;

  always_comb assume (32'(row) < Rows);

  logic signed [CoeffWidth-1:0] coefficient;
  logic [LastShiftWidth-1:0] shift;
  thomas_table #(
    .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns), .Words(Words), .SettledWidth(SettledWidth),
    .LastShiftWidth(LastShiftWidth)
  ) dut (
    .clk, .en, .position, .row, .coefficient, .shift
  );

  logic [LastShiftWidth+CoeffWidth-1:0] square[Rows*Columns];
  initial $readmemh("square.hex", square);

  logic following = 1'b0;
  logic held = 1'b0;
  logic [2:0] age;
  logic [LastShiftWidth+CoeffWidth-1:0] expected, out_q;
  always_ff @(posedge clk) begin
    held <= ~en;
    out_q <= {shift, coefficient};
    if (en) begin
      if (!following || age == 3'(Latency)) begin
        following <= pick;
        age <= 3'd1;
        expected <= square[32'(row) * Columns + 32'(position)];
      end else begin
        age <= age + 3'd1;
      end
    end
  end

  always_comb begin
    if (following && age == 3'(Latency)) own_coefficient: assert ({shift, coefficient} == expected);
    if (held) holds: assert ({shift, coefficient} == out_q);
    inner: cover (following && age == 3'(Latency) && shift == '0 && held);
    last: cover (following && age == 3'(Latency) && shift != '0 && held);
  end

endmodule

`default_nettype wire
