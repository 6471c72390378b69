// SPDX-License-Identifier: Apache-2.0
// polynomial_gradient: slopes of a pixel from the deviations of its colours, linear in the three, and a correction.
//
//   slope of an axis = sat( round( ( sum over red, green, blue of C[axis][colour] * deviation[colour]
//                                    + correction[axis] * CorrectionUnit ) / 2^Drop ) )
//   C = upper CoeffWidth bits of a polynomial of third degree in the column and the row, from 0
//
// With the differences A of a frame's first pixel, B, D, T along its row, and E, F, H, U, G, W from row to row:
//   C(r, c) = A + B c + D c2 + T c3 + E r + F r2 + U r3 + H c r + G c r2 + W c2 r
// where x2 = x (x - 1) / 2, x3 = x2 (x - 2) / 3. T, U, G and W have FineBits more fraction bits than the others; all
// sums are modulo 2^(WordWidth + FineBits).
//
// Stream in: I / reference - 1 of each colour, raster order, gaps anywhere; a pixel's correction comes 4 cycles later.
// Stream out: slopes dz/dx, dz/dy, z positive into the gel. Latency: 12 cycles. A frame has two rows or more, of eight
// pixels or more; it begins afresh.
//
// Table port: docs/streams.md; the 60 words, at (3 axis + colour) 10 + term, terms A, B, D, T, E, F, H, U, G, W.
// table_in_use follows a frame's first pixel after 4 cycles. Both banks hold the calibration at power-up. Bit-accurate
// model: models/tactile_depth/chip/gradient/polynomial_gradient.py; models/tactile_depth/chip/rom_files.py writes the
// words.

`default_nettype none

module polynomial_gradient
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width           = 21,  // of a slope
  parameter int DeviationWidth  = 17,
  parameter int CoeffWidth      = 18,
  parameter int WordWidth       = 32,
  parameter int FineBits        = 4,
  parameter int CorrectionWidth = 8,
  parameter int CorrectionUnit  = 1 << 21,
  parameter int Drop            = 9,   // negative: shift left, exact
  parameter int Parity          = 0,   // 1: a parity bit in each word
  localparam int Terms = 10,
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
  input  wire  signed [CorrectionWidth-1:0] correction_gx,  // of the pixel 4 enabled cycles ago
  input  wire  signed [CorrectionWidth-1:0] correction_gy,
  output logic                             out_valid,
  output position_t                        out_position,
  output logic signed [Width-1:0]          out_gx,      // slope code, F + G - Drop fraction bits
  output logic signed [Width-1:0]          out_gy,      // the same
  output logic [1:0]                       saturations,  // clip count, delayed
  output logic                             flipped      // a word, a coefficient, or a deviation has a flipped bit
);

  localparam int Colours = 3;
  localparam int TermWidth = $clog2(Terms);
  localparam int ToCoefficient = 6;  // cycles, of red; a cycle later that of green, then of blue
  localparam int Reads = 7;          // of words, from a row's first pixel on
  localparam logic [Reads*TermWidth-1:0] FrameTerms = {4'd5, 4'd6, 4'd4, 4'd1, 4'd0, 4'd2, 4'd3};  // F to T
  localparam logic [Reads*TermWidth-1:0] RowTerms = {4'd7, 4'd8, 4'd0, 4'd0, 4'd0, 4'd9, 4'd0};    // U, G, W
  localparam int Differences = 6;    // of a row
  localparam int ToFirst = 2;        // cycles to the first of them
  localparam int ToLast = ToFirst + Differences + Colours - 1;
  localparam int ToSum = ToCoefficient + 3 + Colours - 1;  // operands, product, sum
  localparam int CorrectionDelay = ToCoefficient + 1 - 4;  // to its product with the unit
  localparam int TotalWidth = WordWidth + FineBits;
  localparam int ProductWidth = DeviationWidth + CoeffWidth;
  localparam int SumWidth = ProductWidth + 2;

  // A pixel and its position, by the cycles with en since it was taken.

  logic frame_start;
  logic [ToSum-1:0] valid_q;
  position_t [ToSum-1:0] position_q;
  logic [ToLast-1:0] first_q, row_q;  // it is the first of a frame, of a row
  logic [ToLast:0] first, row;        // the same and the pixel that comes: [n] is [n] of the others in the next clock
  assign first = {first_q, frame_start};
  assign row = {row_q, in_valid & in_position.first_column};
  always_ff @(posedge clk) begin
    if (en) {first_q, row_q} <= {first[ToLast-1:0], row[ToLast-1:0]};
    if (rst) {first_q, row_q} <= '0;
  end

  // The tables of a colour change over with its first read; those of the last colour are the last.

  logic table_write, table_read;
  logic [IndexWidth-1:0] table_index;
  logic [WordWidth-1:0] table_word, fetched_word;
  logic [2*Colours-1:0] in_use, flips;
  logic [Colours-1:0] differs;
  logic [Colours:0] odd;  // what waits has a flipped bit
  logic [2*Colours-1:0][WordWidth-1:0] fetched_words;
  td_table_port #(.Select(TableSelectCoefficients), .IndexWidth(IndexWidth), .Width(WordWidth), .Signed(1)) u_port (
    .clk, .rst, .table_command, .table_answer, .write(table_write), .read(table_read), .index(table_index),
    .word(table_word), .free_word(fetched_word)
  );
  assign frame_start = in_valid & in_position.first_row & in_position.first_column;
  assign table_in_use = in_use[2*Colours-1];
  assign flipped = {flips, differs, odd} != '0;
  always_comb begin
    fetched_word = '0;
    for (int i = 0; i < 2 * Colours; i++) fetched_word = fetched_word | fetched_words[i];
  end

  // Deviations wait for their coefficients, which come from the tables alone: so those of a frame are checked.

  logic [Colours-1:0][DeviationWidth-1:0] deviation, late;
  logic [Colours-1:0][1:0][CoeffWidth-1:0] coefficients;
  assign deviation = {in_blue, in_green, in_red};
  for (genvar colour = 0; colour < Colours; colour++) begin : g_wait
    localparam int Ready = ToCoefficient + colour;
    td_delay_line #(.Width(DeviationWidth), .Delay(Ready + 1), .Style(4), .Parity(Parity)) u_wait (
      .clk, .rst, .en, .in(deviation[colour]), .out(late[colour]), .flipped(odd[colour])
    );
    if (Parity == 0) begin : g_plain
      assign differs[colour] = 1'b0;
    end else begin : g_check
      wire position_t at = position_q[Ready];
      td_repeat_check #(.Width(2 * CoeffWidth)) u_repeat (
        .clk, .rst, .en, .in_valid(valid_q[Ready]), .in_first(at.first_row & at.first_column),
        .in_last(at.last_row & at.last_column), .in_bank(in_use[colour]), .in_data(coefficients[colour]),
        .differs(differs[colour])
      );
    end
  end

  logic [2*Colours-1:0][SumWidth-1:0] sums;  // of the products up to each colour
  logic [1:0][Width-1:0] slopes;
  logic [1:0] clipped;

  logic [1:0][CorrectionWidth-1:0] corrections;
  td_delay_line #(.Width(2 * CorrectionWidth), .Delay(CorrectionDelay), .Style(4), .Parity(Parity)) u_corrections (
    .clk, .rst, .en, .in({correction_gy, correction_gx}), .out(corrections), .flipped(odd[Colours])
  );

  for (genvar axis = 0; axis < 2; axis++) begin : g_axis
    logic signed [CorrectionWidth-1:0] correction_q;
    logic signed [SumWidth-1:0] correction, scaled;
    assign correction_q = corrections[axis];
    always_comb begin  // a constant of few ones: adders, and no multiplier
      scaled = '0;
      for (int i = 0; i < 31; i++) if (CorrectionUnit[i]) scaled = scaled + (SumWidth'(correction_q) <<< i);
    end
    always_ff @(posedge clk) if (en) correction <= scaled;
    for (genvar colour = 0; colour < Colours; colour++) begin : g_colour
      localparam int Polynomial = Colours * axis + colour;
      localparam int Before = colour == 0 ? Polynomial : Polynomial - 1;

      // The words of this polynomial, one a cycle: at a frame's first pixel T to F, at that of another row W, G and U.
      // Of first pixels close together, where a frame was cut short, the last counts.
      logic [TermWidth-1:0] offset;  // of the entry on the bus
      logic own_entry, fetched;
      logic [WordWidth-1:0] word, free_word;
      logic [TermWidth-1:0] term;
      assign offset = TermWidth'(table_index - IndexWidth'(Terms * Polynomial));
      always_ff @(posedge clk) begin
        fetched <= table_read & own_entry;
        own_entry <= IndexWidth'(table_command.index) - IndexWidth'($unsigned(Terms * Polynomial))
            < IndexWidth'($unsigned(Terms));  // beside table_index
      end
      always_ff @(posedge clk) begin
        if (en) begin
          term <= '0;
          for (int k = Reads - 1; k >= 0; k--) begin
            if (row[k+colour]) term <= TermWidth'((first[k+colour] ? FrameTerms : RowTerms) >> k * TermWidth);
          end
        end
        if (rst) term <= '0;
      end
      td_banked_table #(
        .Width(WordWidth), .Depth(Terms), .Style(0), .File({TableFolder, "polynomial_", "0" + 8'(Polynomial), ".hex"}),
        .Parity(Parity)
      ) u_words (
        .clk, .rst, .en, .table_bank, .table_in_use(in_use[Polynomial]), .frame_start, .change(first_q[colour]),
        .read(1'b1), .read_address(term), .read_word(word),
        .free_write(table_write & own_entry), .free_write_address(offset), .free_write_word(table_word),
        .free_read(table_read & own_entry), .free_read_address(offset), .free_word,
        .flipped(flips[Polynomial])
      );
      assign fetched_words[Polynomial] = fetched ? free_word : '0;

      // Along the raster, by differences. Those of a row's first pixel are in a ring, in the order D, A, B, E, H, F.
      // From row to row one a cycle rises by the one two behind it or by a word; a frame's first row takes words. A
      // row's first pixel takes D and A while B is on its way into the ring; the clock after it takes B from there.
      logic [TotalWidth-1:0] coarse, fine;  // the word, with all fraction bits
      logic [Differences-1:0][TotalWidth-1:0] ring;
      logic [TotalWidth-1:0] rise, next, third, value, step, step_now, second;
      logic loads, moves, by_word, comes, begins_row, begins_row_q;
      assign comes = valid_q[ToCoefficient-2+colour];
      assign begins_row = row_q[ToCoefficient-2+colour];
      assign coarse = TotalWidth'(word) << FineBits;
      assign fine = TotalWidth'($signed(word));
      assign rise = by_word ? fine : ring[2];
      assign next = loads ? coarse : ring[0] + rise;
      assign step_now = begins_row_q ? ring[Differences-1] : step;
      always_ff @(posedge clk) begin
        if (en) begin
          loads <= |first[ToFirst+colour+:Differences];
          moves <= |row[ToFirst+colour+:Differences];
          by_word <= row[ToFirst+colour] | row[ToFirst+4+colour] | row[ToFirst+5+colour];
          if (moves) ring <= {next, ring[Differences-1:1]};
          if (first_q[1+colour]) third <= fine;
          begins_row_q <= begins_row;
          if (comes) begin
            value <= begins_row ? ring[Differences-1] : value + step_now;
            second <= begins_row ? ring[Differences-2] : second + third;
          end
          if (comes || begins_row_q) step <= step_now + (comes ? second : '0);
        end
        if (rst) {loads, moves, by_word, begins_row_q} <= '0;
      end

      // The product.
      logic signed [ProductWidth-1:0] product;
      td_multiply #(.AWidth(DeviationWidth), .BWidth(CoeffWidth)) u_product (
        .clk, .en, .a(late[colour]), .b(coefficients[colour][axis]), .product
      );
      always_ff @(posedge clk) if (en) coefficients[colour][axis] <= value[TotalWidth-1-:CoeffWidth];
      logic signed [SumWidth-1:0] sum_before;
      assign sum_before = colour == 0 ? correction : $signed(sums[Before]);
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
    if (rst) {valid_q, out_valid, saturations} <= '0;
  end

endmodule

`default_nettype wire
