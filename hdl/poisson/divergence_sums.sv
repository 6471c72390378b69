// SPDX-License-Identifier: Apache-2.0
// divergence_sums: sums of each row of the divergence, times a constant, for the check of the solver.
//
//   out[s] = floor(Scale / 2^ScaleFraction (Begin[s] + sum over the columns j of sum s of floor(f[i,j] / 2^Dropped)))
//
// td_check_pkg says which columns are part of a sum; Begin is half of their number if bits are dropped, which is what
// that takes from the sum on average. The product is made bit by bit with one adder. Results wrap at SumWidth bits.
// Stream in: divergence in raster order, gaps anywhere. Stream out: four words for each row, one in ScaleFraction + 1
// cycles with en; LastFirst 1: the last sum first. Latency: from the last word of a row to the first of the sums
// ScaleFraction + 4 cycles with en. Bit-accurate model: models/tactile_depth/chip/poisson/divergence_sums.py.

`default_nettype none

module divergence_sums
  import td_check_pkg::*;
#(
  parameter int Columns       = 128,    // a power of two
  parameter int Width         = 15,
  parameter int Dropped       = 5,      // low bits of a word
  parameter int Scale         = 16130,  // below 2^ScaleFraction
  parameter int ScaleFraction = 14,
  parameter int SumWidth      = 13,
  parameter int LastFirst     = 1
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_valid,
  input  wire                     in_frame_start,  // with in_valid: the first word of a frame
  input  wire  signed [Width-1:0] in_data,         // divergence code
  output logic                    out_valid,
  output logic                    out_frame_start,  // with out_valid: the first sum of a frame
  output logic [SumWidth-1:0]     out_data         // a sum, signed
);

  localparam int Sums = CheckSums;
  localparam int ColumnWidth = $clog2(Columns);
  localparam int Kept = Width - Dropped;
  localparam int RowWidth = Kept + ColumnWidth;  // of a sum before it is scaled
  localparam int CountWidth = $clog2(ScaleFraction + 1);

  logic [ColumnWidth-1:0] column;  // of the next word, if it does not begin a frame
  logic [Sums-1:0] parts;  // sums that the word is a part of
  logic begins, first_row;  // the row that comes, the row whose sums leave: the first of a frame
  logic ends, row_there;
  logic signed [Kept-1:0] kept;
  always_ff @(posedge clk) begin
    if (en && in_valid && in_frame_start) column <= ColumnWidth'(1);
    else if (en && in_valid) column <= column + ColumnWidth'(1);
    if (rst || (en && !in_valid)) {parts, ends} <= '0;
    else if (en && in_frame_start) {parts, ends} <= {check_sums('0, Columns), 1'b0};
    else if (en) {parts, ends} <= {check_sums(10'(column), Columns), column == '1};
    if (en) kept <= in_data[Width-1:Dropped];
    if (en) row_there <= ends;
    if (en && in_valid && in_frame_start) begins <= 1'b1;
    else if (en && ends) begins <= 1'b0;
    if (en && ends) first_row <= begins;
    if (rst) row_there <= '0;
  end

  // The lowest bit of Scale comes first: each adds a sum to half of the product so far.
  logic [Sums-1:0] turn;  // the sum, 0 if none
  logic [CountWidth-1:0] step;
  logic step_last, adds;
  logic [Sums-1:0][RowWidth-1:0] addends;  // one of them at most is not 0
  logic signed [RowWidth-1:0] addend;
  logic signed [RowWidth:0] product;
  assign step_last = step == CountWidth'(ScaleFraction);
  assign adds = 1'((ScaleFraction + 1)'($unsigned(Scale)) >> step);
  assign addend = addends[0] | addends[1] | addends[2] | addends[3];
  assign out_data = SumWidth'(product >>> 1);
  always_ff @(posedge clk) begin
    if (en) begin
      step <= row_there || step_last ? '0 : step + CountWidth'(1);
      if (row_there) turn <= LastFirst != 0 ? 4'b1000 : 4'b0001;
      else if (step_last) turn <= LastFirst != 0 ? turn >> 1 : turn << 1;
      out_valid <= step_last & (turn != '0);
      out_frame_start <= step_last & first_row & turn[LastFirst != 0 ? Sums - 1 : 0];
    end
    if (rst || (en && out_valid)) product <= '0;
    else if (en) product <= (product >>> 1) + (RowWidth + 1)'(addend);
    if (rst) {turn, out_valid} <= '0;
  end

  for (genvar s = 0; s < Sums; s++) begin : g_sum
    localparam int Begin = Dropped > 0 ? check_half(2'($unsigned(s)), Columns) : 0;
    logic [RowWidth-1:0] sum, row_sum;
    always_ff @(posedge clk) begin
      if (rst || (en && ends)) sum <= RowWidth'($unsigned(Begin));
      else if (en && parts[s]) sum <= sum + RowWidth'(kept);
      if (en && ends) row_sum <= sum;  // the last column is part of no sum
      if (rst || (en && !(turn[s] && adds))) addends[s] <= '0;
      else if (en) addends[s] <= row_sum;
    end
  end

endmodule

`default_nettype wire
