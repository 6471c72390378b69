// SPDX-License-Identifier: Apache-2.0
// thomas_table: coefficient c of Thomas's algorithm for a mode and a row.
//
//   c[0] = 1 / b[0], c[i] = 1 / (b[i] - c[i-1]) = coefficient 2^(shift + 1 - CoeffWidth)
//
// A position and a row in, its coefficient out 5 enabled clocks later. Down the rows a coefficient soon settles; what
// follows its last change is not stored: word base + min(row, settled). The last row has a table of its own, and a
// shift, since its coefficients exceed 1 under Neumann. A user that multiplies nothing in that row leaves it out.
// Bit-accurate model: models/tactile_depth/poisson/thomas_table.py, which also writes the ROMs.

`default_nettype none

module thomas_table #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int CoeffWidth     = 18,
  parameter int Rows           = 128,
  parameter int Columns        = 128,   // modes in a row
  parameter int Words          = 1379,
  parameter int SettledWidth   = 7,
  parameter bit HasLastRow     = 1'b1,  // 0: what is read for the last row has no meaning
  parameter int LastShiftWidth = 1,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows),
  localparam int AddressWidth = $clog2(Words)
) (
  input  wire                          clk,
  input  wire                          en,
  input  wire  [PositionWidth-1:0]     position,
  input  wire  [RowWidth-1:0]          row,
  output logic signed [CoeffWidth-1:0] coefficient,  // CoeffWidth - 1 - shift fraction bits
  output logic [LastShiftWidth-1:0]    shift
);

  localparam int CompareWidth = RowWidth > SettledWidth ? RowWidth : SettledWidth;

  logic [PositionWidth-1:0] position_q;
  logic [RowWidth-1:0] row_q;
  logic [AddressWidth-1:0] base, address;
  logic [SettledWidth-1:0] settled;
  td_rom #(.Width(AddressWidth + SettledWidth), .Depth(Columns), .File({TableFolder, "thomas_index.hex"})) u_index (
    .clk, .en, .address(position_q), .data({base, settled})
  );

  logic [RowWidth-1:0] row_q2;
  always_ff @(posedge clk) begin
    if (en) begin
      row_q <= row;
      position_q <= position;
      row_q2 <= row_q;
      address <= base
          + (CompareWidth'(row_q2) < CompareWidth'(settled) ? AddressWidth'(row_q2) : AddressWidth'(settled));
    end
  end

  logic signed [CoeffWidth-1:0] inner;
  td_rom #(.Width(CoeffWidth), .Depth(Words), .File({TableFolder, "thomas.hex"})) u_inner (
    .clk, .en, .address, .data(inner)
  );

  if (HasLastRow) begin : g_last_row
    logic [PositionWidth-1:0] position_q2, position_q3;
    logic last_q3, last_q4;
    logic signed [CoeffWidth-1:0] last;
    logic [LastShiftWidth-1:0] last_shift;
    td_rom #(.Width(LastShiftWidth + CoeffWidth), .Depth(Columns), .File({TableFolder, "thomas_last.hex"})) u_last (
      .clk, .en, .address(position_q3), .data({last_shift, last})
    );
    always_ff @(posedge clk) begin
      if (en) begin
        position_q2 <= position_q;
        position_q3 <= position_q2;
        last_q3 <= row_q2 == RowWidth'(Rows - 1);
        last_q4 <= last_q3;
        coefficient <= last_q4 ? last : inner;
        shift <= last_q4 ? last_shift : '0;
      end
    end
  end else begin : g_inner_rows
    assign shift = '0;
    always_ff @(posedge clk) if (en) coefficient <= inner;
  end

  if (Columns < 2 || Columns != (1 << $clog2(Columns))) begin : g_refused_0
    Columns_must_be_a_power_of_two_at_least_2 u_refused ();
  end
  if (Rows < 2) begin : g_refused_1
    Rows_must_be_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
