// SPDX-License-Identifier: Apache-2.0
// thomas_table: coefficient c of Thomas's algorithm for a mode and a row.
//
//   c[0] = 1 / b[0], c[i] = 1 / (b[i] - c[i-1]) = coefficient 2^(shift + 1 - CoeffWidth)
//
// A position and a row in, its coefficient out 5 enabled cycles later. Down the rows a coefficient soon settles; what
// follows its last change is not stored: word base + min(row, settled). The last row has a table of its own, and a
// shift, since its coefficients exceed 1 under Neumann. A user that multiplies nothing in that row leaves it out. For
// several modes in a clock, a coefficient and a shift are those of all of them side by side.
// Bit-accurate model: models/tactile_depth/chip/poisson/thomas_table.py, which also writes the ROMs.

`default_nettype none

module thomas_table #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter Table       = "down",  // begin of their names
  parameter int CoeffWidth     = 18,
  parameter int Rows           = 128,
  parameter int Columns        = 128,   // modes in a row
  parameter int Words          = 1379,
  parameter int SettledWidth   = 7,
  parameter bit HasLastRow     = 1'b1,  // 0: what is read for the last row has no meaning
  parameter int LastShiftWidth = 1,
  parameter int Parity         = 0,  // 1: a parity bit in each word
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows),
  localparam int AddressWidth = $clog2(Words)
) (
  input  wire                          clk,
  input  wire                          en,
  input  wire  [PositionWidth-1:0]     position,
  input  wire  [RowWidth-1:0]          row,
  output logic signed [CoeffWidth-1:0] coefficient,  // CoeffWidth - 1 - shift fraction bits
  output logic [LastShiftWidth-1:0]    shift,
  output logic                         flipped       // a word that was read has a flipped bit
);

  localparam int IndexWidth = AddressWidth + SettledWidth;
  localparam int CompareWidth = RowWidth > SettledWidth ? RowWidth : SettledWidth;

  logic [RowWidth-1:0] row_q;
  logic [AddressWidth-1:0] base, address;
  logic [SettledWidth-1:0] settled;
  logic signed [CoeffWidth-1:0] inner;  // behind a register: the memory is slow and may be far from the multiplier
  logic index_flipped, inner_flipped, last_flipped;
  assign flipped = index_flipped | inner_flipped | last_flipped;
  td_parity_rom #(
    .Width(IndexWidth), .Depth(Columns), .Style(IndexWidth * Columns > td_memory_pkg::LateBits ? 1 : 0),
    .File({TableFolder, Table, "_index.hex"}), .Parity(Parity)
  ) u_index (
    .clk, .en, .address(position), .data({base, settled}), .flipped(index_flipped)
  );

  always_ff @(posedge clk) begin
    if (en) begin
      row_q <= row;
      address <= base
          + (CompareWidth'(row_q) < CompareWidth'(settled) ? AddressWidth'(row_q) : AddressWidth'(settled));
    end
  end

  td_parity_rom #(
    .Width(CoeffWidth), .Depth(Words), .File({TableFolder, Table, ".hex"}), .Latency(2), .Parity(Parity)
  ) u_inner (
    .clk, .en, .address, .data(inner), .flipped(inner_flipped)
  );

  if (HasLastRow) begin : g_last_row
    logic [1:0][PositionWidth-1:0] last_position;
    logic [2:0] last_row;  // behind row_q
    logic signed [CoeffWidth-1:0] last;
    logic [LastShiftWidth-1:0] last_shift;
    td_parity_rom #(
      .Width(LastShiftWidth + CoeffWidth), .Depth(Columns), .File({TableFolder, Table, "_last.hex"}), .Latency(2),
      .Parity(Parity)
    ) u_last (
      .clk, .en, .address(last_position[1]), .data({last_shift, last}), .flipped(last_flipped)
    );
    always_ff @(posedge clk) begin
      if (en) begin
        last_position <= {last_position[0], position};
        last_row <= {last_row[1:0], row_q == RowWidth'(Rows - 1)};
        coefficient <= last_row[2] ? last : inner;
        shift <= last_row[2] ? last_shift : '0;
      end
    end
  end else begin : g_inner_rows
    assign {shift, last_flipped} = '0;
    always_ff @(posedge clk) if (en) coefficient <= inner;
  end

endmodule

`default_nettype wire
