// SPDX-License-Identifier: Apache-2.0
// polynomial_gradient: slopes of a pixel from the deviations of its colours, linear in the three.
//
//   slope of an axis = sat( round( sum over red, green, blue of C[axis][colour] * deviation[colour] / 2^Drop ) )
//   C = upper CoeffWidth bits of A + B c + D c (c - 1) / 2 + E r + F r (r - 1) / 2 + H c r, column c, row r from 0
//
// Stream in: I / reference - 1 of each colour, raster order, gaps anywhere. Stream out: slopes dz/dx, dz/dy, z positive
// into the gel. Latency: 11 cycles. A frame has two rows or more, of four pixels or more; it begins afresh.
//
// Table port: docs/streams.md; the 36 words, at (3 axis + colour) 6 + term, terms A, B, D, E, F, H, modulo 2^WordWidth.
// table_in_use follows a frame's first pixel after 4 cycles. Both banks hold the calibration at power-up. Bit-accurate
// model: models/tactile_depth/gradient/polynomial_gradient.py; models/tactile_depth/rom_files.py writes the words.

`default_nettype none

module polynomial_gradient
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width          = 21,  // of a slope
  parameter int DeviationWidth = 17,
  parameter int CoeffWidth     = 18,
  parameter int WordWidth      = 32,
  parameter int Drop           = 9,   // negative: shift left, exact
  localparam int Terms = 6,
  localparam int Words = 6 * Terms,
  localparam int IndexWidth = $clog2(Words)
) (
  input  wire                              clk,
  input  wire                              rst,
  input  wire                              en,
  input  wire table_command_t              table_command,  // low: C has G fraction bits
  output table_answer_t                    table_answer,
  input  wire                              table_bank,
  output logic                             table_in_use,
  input  wire                              in_valid,
  input  wire position_t                   in_position,
  input  wire  signed [DeviationWidth-1:0] in_red,      // deviation, F fraction bits
  input  wire  signed [DeviationWidth-1:0] in_green,    // the same
  input  wire  signed [DeviationWidth-1:0] in_blue,     // the same
  output logic                             out_valid,
  output position_t                        out_position,
  output logic signed [Width-1:0]          out_gx,      // slope code, F + G - Drop fraction bits
  output logic signed [Width-1:0]          out_gy,      // the same
  output logic [1:0]                       saturations  // clip count, delayed
);

  localparam int Colours = 3;
  localparam int TermWidth = $clog2(Terms);
  localparam int ToCoefficient = 5;  // cycles, of red; a cycle later that of green, then of blue
  localparam int LastLoad = ToCoefficient + Colours - 1;   // to the last word of a frame's first row
  localparam int LastUpdate = 3 + Colours - 1;             // of another row
  localparam int ToSum = ToCoefficient + 3 + Colours - 1;  // operands, product, sum
  localparam int ProductWidth = DeviationWidth + CoeffWidth;
  localparam int SumWidth = ProductWidth + 2;

  // A pixel and its position, by the cycles with en since it was taken.

  logic frame_start;
  logic [ToSum-1:0] valid_q;
  position_t [ToSum-1:0] position_q;
  logic [LastLoad-1:0] first_q;  // it is the first of a frame
  logic [LastUpdate-1:0] row_q;  // it is the first of another row
  always_ff @(posedge clk) begin
    if (en) begin
      first_q <= {first_q[LastLoad-2:0], frame_start};
      row_q <= {row_q[LastUpdate-2:0], in_valid & ~in_position.first_row & in_position.first_column};
    end
    if (rst) {first_q, row_q} <= '0;
  end

  // The tables of a colour change over with its first read; those of the last colour are the last.

  logic table_write, table_read;
  logic [IndexWidth-1:0] table_index;
  logic [WordWidth-1:0] table_word, fetched_word;
  logic [2*Colours-1:0] in_use;
  logic [2*Colours-1:0][WordWidth-1:0] fetched_words;
  td_table_port #(
    .Select(TableSelectCoefficients), .IndexWidth(IndexWidth), .Width(WordWidth), .Signed(1)
  ) u_port (
    .clk, .rst, .table_command, .table_answer, .write(table_write), .read(table_read), .index(table_index),
    .word(table_word), .free_word(fetched_word)
  );
  assign frame_start = in_valid & in_position.first_row & in_position.first_column;
  assign table_in_use = in_use[2*Colours-1];
  always_comb begin
    fetched_word = '0;
    for (int i = 0; i < 2 * Colours; i++) fetched_word = fetched_word | fetched_words[i];
  end

  logic [Colours-1:0][DeviationWidth-1:0] deviation;
  assign deviation = {in_blue, in_green, in_red};

  logic [2*Colours-1:0][SumWidth-1:0] sums;  // of the products up to each colour
  logic [1:0][Width-1:0] slopes;
  logic [1:0] clipped;

  for (genvar axis = 0; axis < 2; axis++) begin : g_axis
    for (genvar colour = 0; colour < Colours; colour++) begin : g_colour
      localparam int Polynomial = Colours * axis + colour;
      localparam int Before = colour == 0 ? Polynomial : Polynomial - 1;

      // The words of this polynomial, one a cycle: at a frame's first pixel A, B, D, E; at other rows' F, H.
      logic [IndexWidth-1:0] offset;  // of the entry on the bus
      logic own_entry, fetched;
      logic [WordWidth-1:0] word, free_word;
      logic [TermWidth-1:0] term;
      assign offset = table_index - IndexWidth'(Terms * Polynomial);
      assign own_entry = 32'(offset) < $unsigned(Terms);
      assign term = first_q[colour] ? TermWidth'(0)
          : first_q[1+colour] ? TermWidth'(1)
          : first_q[2+colour] ? TermWidth'(2)
          : first_q[3+colour] ? TermWidth'(3)
          : row_q[colour] ? TermWidth'(4) : TermWidth'(5);
      td_banked_table #(
        .Width(WordWidth), .Depth(Terms), .Style(0), .File({TableFolder, "quadratic_", "0" + 8'(Polynomial), ".hex"})
      ) u_words (
        .clk, .rst, .en, .table_bank, .table_in_use(in_use[Polynomial]), .frame_start, .change(first_q[colour]),
        .read(1'b1), .read_address(term), .read_word(word),
        .free_write(table_write & own_entry), .free_write_address(offset[TermWidth-1:0]), .free_write_word(table_word),
        .free_read(table_read & own_entry), .free_read_address(offset[TermWidth-1:0]), .free_word
      );
      always_ff @(posedge clk) fetched <= table_read & own_entry;
      assign fetched_words[Polynomial] = fetched ? free_word : '0;

      // Along the raster, by second differences. Those of the row are ready when its first pixel comes; a frame begins
      // with sums of 0.
      logic begins_row;
      assign begins_row = position_q[ToCoefficient-2+colour].first_column;
      logic [WordWidth-1:0] row_value, row_step, row_rise, value, step, second_difference;
      always_ff @(posedge clk) begin
        if (en) begin
          if (first_q[1+colour]) row_value <= word;
          if (row_q[1+colour]) row_value <= row_value + row_rise;
          if (first_q[1+colour]) row_step <= '0;
          else if (first_q[2+colour] | row_q[2+colour]) row_step <= word + row_step;
          if (first_q[3+colour]) second_difference <= word;
          if (first_q[3+colour]) row_rise <= '0;
          else if (first_q[4+colour] | row_q[1+colour]) row_rise <= word + row_rise;
          if (valid_q[ToCoefficient-2+colour]) begin
            value <= begins_row ? row_value : value + step;
            step <= begins_row ? row_step : step + second_difference;
          end
        end
      end

      // The product.
      localparam int Delay = ToCoefficient + colour;
      logic [Delay-1:0][DeviationWidth-1:0] waiting;
      logic signed [DeviationWidth-1:0] deviation_q;
      logic signed [CoeffWidth-1:0] coefficient_q;
      logic signed [ProductWidth-1:0] product;
      td_multiply #(.AWidth(DeviationWidth), .BWidth(CoeffWidth)) u_product (
        .clk, .en, .a(deviation_q), .b(coefficient_q), .product
      );
      always_ff @(posedge clk) begin
        if (en) begin
          waiting <= {waiting[Delay-2:0], deviation[colour]};
          deviation_q <= $signed(waiting[Delay-1]);
          coefficient_q <= $signed(value[WordWidth-1-:CoeffWidth]);
        end
      end
      logic signed [SumWidth-1:0] sum_before;
      assign sum_before = colour == 0 ? '0 : $signed(sums[Before]);
      always_ff @(posedge clk) if (en) sums[Polynomial] <= sum_before + SumWidth'(product);
    end

    td_round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(Width)) u_round (
      .in($signed(sums[Colours*axis+Colours-1])), .out(slopes[axis]), .clipped(clipped[axis])
    );
  end

  always_ff @(posedge clk) begin
    if (en) begin
      {out_valid, valid_q} <= {valid_q, in_valid};
      {out_position, position_q} <= {position_q, in_position};
      {out_gy, out_gx} <= slopes;
    end
    saturations <= (en && valid_q[ToSum-1]) ? 2'(clipped[0]) + 2'(clipped[1]) : '0;
    if (rst) begin
      valid_q <= '0;
      out_valid <= 1'b0;
      saturations <= '0;
    end
  end

  if (CoeffWidth > WordWidth) begin : g_refused
    CoeffWidth_must_be_at_most_WordWidth u_refused ();
  end

endmodule

`default_nettype wire
