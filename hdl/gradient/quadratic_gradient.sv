// SPDX-License-Identifier: Apache-2.0
// quadratic_gradient: slopes of a pixel from the deviations of its colours, linear in the three.
//
//   slope of an axis = sat( round( sum over red, green, blue of C[axis][colour] * deviation[colour] / 2^Drop ) )
//   C = upper CoeffWidth bits of A + B c + D c (c - 1) / 2 + E r + F r (r - 1) / 2 + H c r, column c, row r from 0
//
// Stream in: I / reference - 1 of each colour, raster order, gaps anywhere. Stream out: slopes dz/dx, dz/dy, z positive
// into the gel. Latency: 11 cycles. A frame has two rows or more, of four pixels or more; it begins afresh.
//
// The 36 words, at (3 axis + colour) 6 + term, terms A, B, D, E, F, H, modulo 2^WordWidth, are held in two banks, both
// with the calibration at power-up. A frame uses the bank that table_bank names when its first pixel is taken, or in
// reset; table_in_use says which. The other is written by table_write, whenever no change-over is due (table_bank is
// table_in_use), and read by table_read: the word stands on table_read_word until the next, en or not. Never both in
// one clock. Bit-accurate model: models/tactile_depth/gradient/quadratic_gradient.py;
// models/tactile_depth/rom_files.py writes the words.

module quadratic_gradient #(
  parameter int Width          = 21,  // of a slope
  parameter int DeviationWidth = 14,
  parameter int CoeffWidth     = 18,
  parameter int WordWidth      = 32,
  parameter int Drop           = 6,   // negative: shift left, exact
  localparam int Terms = 6,
  localparam int Words = 6 * Terms,
  localparam int IndexWidth = $clog2(Words)
) (
  input  logic                             clk,
  input  logic                             rst,
  input  logic                             en,
  input  logic                             table_bank,
  output logic                             table_in_use,
  input  logic                             table_write,
  input  logic                             table_read,
  input  logic [IndexWidth-1:0]            table_index,
  input  logic signed [WordWidth-1:0]      table_word,
  output logic signed [WordWidth-1:0]      table_read_word,
  input  logic                             in_valid,
  input  logic [3:0]                       in_place,  // in the first row, first column, last row, last column
  input  logic signed [DeviationWidth-1:0] in_red,
  input  logic signed [DeviationWidth-1:0] in_green,
  input  logic signed [DeviationWidth-1:0] in_blue,
  output logic                             out_valid,
  output logic [3:0]                       out_place,
  output logic signed [Width-1:0]          out_gx,
  output logic signed [Width-1:0]          out_gy,
  output logic [1:0]                       saturations  // values clipped in this cycle
);

  localparam int Colours = 3;
  localparam int TermWidth = $clog2(Terms);
  localparam int ToCoefficient = 5;  // cycles, of red; a cycle later that of green, then of blue
  localparam int LastLoad = ToCoefficient + Colours - 1;   // to the last word of a frame's first row
  localparam int LastUpdate = 3 + Colours - 1;             // of another row
  localparam int ToSum = ToCoefficient + 3 + Colours - 1;  // operands, product, sum
  localparam int ProductWidth = DeviationWidth + CoeffWidth;
  localparam int SumWidth = ProductWidth + 2;

  // Banks.

  logic bank, begins, used;
  assign begins = en & in_valid & in_place[0] & in_place[1];
  assign used = begins ? table_bank : bank;
  assign table_in_use = bank;
  always_ff @(posedge clk) if (rst || begins) bank <= table_bank;

  // A second read port, in the manner of distributed memories: all words once more.
  ram #(
    .Width(WordWidth),
    .Depth(2 * Words),
    .Style(0),
    .File ("quadratic.hex")
  ) u_read_back (
    .clk,
    .write_en     (table_write),
    .write_address({table_index, ~bank}),
    .write_data   (table_word),
    .read_en      (table_read),
    .read_address ({table_index, ~used}),
    .read_data    (table_read_word)
  );

  // A pixel and its place, by the clocks with en since it was taken.

  logic [ToSum:1] valid_q;
  logic [4*ToSum-1:0] place_q;  // the oldest on top
  logic [LastLoad:1] first;   // it is the first of a frame
  for (genvar age = 1; age <= LastLoad; age++) begin : g_first
    assign first[age] = valid_q[age] & place_q[4*age-4] & place_q[4*age-3];
  end
  logic [LastUpdate:1] row;   // it is the first of another row
  for (genvar age = 1; age <= LastUpdate; age++) begin : g_row
    assign row[age] = valid_q[age] & ~place_q[4*age-4] & place_q[4*age-3];
  end

  logic [Colours-1:0][DeviationWidth-1:0] deviation;
  assign deviation = {in_blue, in_green, in_red};

  logic [2*Colours*SumWidth-1:0] sums;  // of the products up to each colour
  logic [2*Width-1:0] slopes;
  logic [1:0] clipped;

  for (genvar axis = 0; axis < 2; axis++) begin : g_axis
    for (genvar colour = 0; colour < Colours; colour++) begin : g_colour
      localparam int Polynomial = Colours * axis + colour;
      localparam int Before = colour == 0 ? Polynomial : Polynomial - 1;

      // The words of this polynomial, one a clock: at a frame's first pixel A, B, D, E; at other rows' F, H.
      logic [IndexWidth-1:0] offset;  // of the entry on the bus
      logic own_entry;
      assign offset = table_index - IndexWidth'(Terms * Polynomial);
      assign own_entry = 32'(offset) < $unsigned(Terms);
      logic [TermWidth-1:0] term;
      assign term = first[1+colour] ? TermWidth'(0)
          : first[2+colour] ? TermWidth'(1)
          : first[3+colour] ? TermWidth'(2)
          : first[4+colour] ? TermWidth'(3)
          : row[1+colour] ? TermWidth'(4) : TermWidth'(5);
      logic [WordWidth-1:0] word;
      ram #(
        .Width(WordWidth),
        .Depth(2 * Terms),
        .Style(0),
        .File ({"quadratic_", 8'(48 + Polynomial), ".hex"})
      ) u_words (
        .clk,
        .write_en     (table_write & own_entry),
        .write_address({offset[TermWidth-1:0], ~bank}),
        .write_data   (table_word),
        .read_en      (en),
        .read_address ({term, bank}),
        .read_data    (word)
      );

      // Along the raster, by second differences. Those of the row are ready when its first pixel comes.
      logic begins_row;
      assign begins_row = place_q[4*(ToCoefficient-1+colour)-3];
      logic [WordWidth-1:0] row_value, row_step, row_rise, value, step, bend;
      always_ff @(posedge clk) begin
        if (en) begin
          if (first[2+colour]) row_value <= word;
          if (row[2+colour]) row_value <= row_value + row_rise;
          if (first[3+colour] | row[3+colour]) row_step <= word + (row[3+colour] ? row_step : '0);
          if (first[4+colour]) bend <= word;
          if (first[5+colour] | row[2+colour]) row_rise <= word + (row[2+colour] ? row_rise : '0);
          if (valid_q[ToCoefficient-1+colour]) begin
            value <= begins_row ? row_value : value + step;
            step <= begins_row ? row_step : step + bend;
          end
        end
      end

      // The product.
      localparam int Delay = ToCoefficient + colour;
      logic [Delay*DeviationWidth-1:0] waiting;  // the oldest on top
      logic signed [DeviationWidth-1:0] deviation_q;
      logic signed [CoeffWidth-1:0] coefficient_q;
      logic signed [ProductWidth-1:0] product;
      multiply #(.AWidth(DeviationWidth), .BWidth(CoeffWidth)) u_product (
        .clk, .en, .a(deviation_q), .b(coefficient_q), .product
      );
      always_ff @(posedge clk) begin
        if (en) begin
          waiting <= {waiting[(Delay-1)*DeviationWidth-1:0], deviation[colour]};
          deviation_q <= $signed(waiting[Delay*DeviationWidth-1-:DeviationWidth]);
          coefficient_q <= $signed(value[WordWidth-1-:CoeffWidth]);
        end
      end
      logic signed [SumWidth-1:0] sum_before;
      assign sum_before = colour == 0 ? '0 : $signed(sums[SumWidth*Before+:SumWidth]);
      always_ff @(posedge clk) if (en) sums[SumWidth*Polynomial+:SumWidth] <= sum_before + SumWidth'(product);
    end

    round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(Width)) u_round (
      .in($signed(sums[SumWidth*Colours*(axis+1)-1-:SumWidth])),
      .out(slopes[Width*axis+:Width]),
      .clipped(clipped[axis])
    );
  end

  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= {valid_q[ToSum-1:1], in_valid};
      place_q <= {place_q[4*ToSum-5:0], in_place};
      out_valid <= valid_q[ToSum];
      out_place <= place_q[4*ToSum-1-:4];
      {out_gy, out_gx} <= slopes;
    end
    saturations <= (en && valid_q[ToSum]) ? 2'(clipped[0]) + 2'(clipped[1]) : '0;
    if (rst) begin
      valid_q <= '0;
      out_valid <= 1'b0;
      saturations <= '0;
    end
  end

`ifndef SYNTHESIS
  initial if (CoeffWidth > WordWidth) $fatal(1, "%m: CoeffWidth must be at most WordWidth");
`endif

endmodule
