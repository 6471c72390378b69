// SPDX-License-Identifier: Apache-2.0
// area_average: the mean colour of each block of Numerator / Denominator camera pixels, which is a pixel of the grid.
//
//   colour = gain sum w s / (2^(Bits - 8) sum w), rounded half to even once, clipped to 0..255
//
//   row_sums -> block_totals -> times the gain -> round_divide, one for each colour
//
// w is the area of a camera pixel in the block. RGB (Bayer 0): s has the three colours of a pixel. Bayer 1: s is one
// colour, which in_colour names, and the sums run over the pixels of that colour. The gains of a frame stand on
// in_gains with its first pixel and in the 5 cycles behind it.
// Stream in: the pixels of a window in raster order, in_row_start with the first of a row, in_frame_start with the
// first of all; gaps anywhere. Stream out: the grid in raster order, R in 23:16, B in 15:8, G in 7:0; out_user with the
// first of a frame, out_last with the last of a row. in_abort, in a cycle without a pixel, ends a frame that is not
// whole: one more word leaves, the first of a frame if none did, and its out_last is inverted, so that frame_guard
// drops the frame. Latency: 18 cycles with en, from the pixel that completes a block, and from in_abort. en low:
// nothing moves. Bit-accurate model: models/tactile_depth/chip/camera/area_average.py.

`default_nettype none

module area_average #(
  parameter int Rows        = 128,  // of the grid
  parameter int Columns     = 128,
  parameter int Numerator   = 15,
  parameter int Denominator = 4,
  parameter int Bits        = 10,  // 2^Bits is full scale of a sample
  parameter int Bayer       = 1,
  localparam int Channels = Bayer != 0 ? 1 : 3,
  localparam int Width = Bits + 2,
  localparam int GainWidth = 16
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      en,
  input  wire                      in_valid,
  input  wire [Channels*Width-1:0] in_samples,  // signed, red lowest
  input  wire [1:0]                in_colour,   // Bayer: bit 0 a column of blue, bit 1 a row of blue
  input  wire                      in_row_start,
  input  wire                      in_frame_start,
  input  wire                      in_abort,
  input  wire [3*GainWidth-1:0]    in_gains,    // 4 bits before the point, 12 behind it; red lowest
  output logic                     out_valid,
  output logic [23:0]              out_pixel,
  output logic                     out_last,
  output logic                     out_user
);

  localparam int RowSums = 3;
  localparam int BlockTotals = 3;
  localparam int Gain = 2;
  localparam int Divide = 10;
  localparam int Latency = RowSums + BlockTotals + Gain + Divide;
  localparam int GainFraction = 12;
  localparam int Sums = Bayer != 0 ? 2 : 3;
  localparam int BlockWidth = $clog2(Numerator + 1);
  localparam int SumWidth = Width + $clog2(Numerator);
  localparam int AreaWidth = $clog2(Numerator * Numerator + 1);
  localparam int TotalWidth = Width + $clog2(Numerator * Numerator);
  localparam int ScaledWidth = TotalWidth + GainWidth;
  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows);

  logic [Sums*SumWidth-1:0] sums;
  logic [BlockWidth-1:0] red_columns;
  logic ends, row_start, frame_start, blue_row;
  row_sums #(.Numerator(Numerator), .Denominator(Denominator), .Width(Width), .Bayer(Bayer)) u_row_sums (
    .clk, .rst, .en, .in_valid, .in_samples, .in_blue_column(in_colour[0]), .in_row_start,
    .out_ends(ends), .out_sums(sums), .out_red_columns(red_columns)
  );
  td_delay_line #(.Width(3), .Delay(RowSums)) u_marks (
    .clk, .rst, .en, .in({in_valid & in_row_start, in_frame_start, in_colour[1]}),
    .out({row_start, frame_start, blue_row}), .flipped()
  );

  logic complete;
  logic [3*TotalWidth-1:0] totals;
  logic [3*AreaWidth-1:0] areas;
  block_totals #(
    .Columns(Columns), .Numerator(Numerator), .Denominator(Denominator), .Width(Width), .Bayer(Bayer)
  ) u_block_totals (
    .clk, .rst, .en, .in_row_start(row_start), .in_frame_start(frame_start), .in_blue_row(blue_row),
    .in_ends(ends), .in_sums(sums), .in_red_columns(red_columns),
    .out_valid(complete), .out_totals(totals), .out_areas(areas)
  );

  // The first total of a frame leaves 6 cycles behind its first pixel at the earliest.
  logic [1:0] start_q;
  logic [3*GainWidth-1:0] gains;
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[0], row_start & frame_start};
      if (start_q[1]) gains <= in_gains;
    end
  end

  logic [3*AreaWidth-1:0] areas_q2;
  if (Bayer != 0) begin : g_areas
    td_delay_line #(.Width(3 * AreaWidth), .Delay(Gain)) u_areas (
      .clk, .rst, .en, .in(areas), .out(areas_q2), .flipped()
    );
  end else begin : g_area
    assign areas_q2 = areas;
  end

  logic [23:0] means;  // blue, green, red
  for (genvar c = 0; c < 3; c++) begin : g_colour
    logic signed [ScaledWidth-1:0] product, scaled;
    logic unused_top;  // repeats the sign
    td_multiply #(.AWidth(TotalWidth), .BWidth(GainWidth + 1)) u_gain (
      .clk, .en, .a(totals[c*TotalWidth+:TotalWidth]), .b({1'b0, gains[c*GainWidth+:GainWidth]}),
      .product({unused_top, product})
    );
    always_ff @(posedge clk) if (en) scaled <= product;
    round_divide #(.TotalWidth(ScaledWidth), .WeightWidth(AreaWidth), .Drop(Bits - 8 + GainFraction)) u_divide (
      .clk, .en, .total(scaled), .weight(areas_q2[c*AreaWidth+:AreaWidth]), .mean(means[8*c+:8])
    );
  end
  assign out_pixel = {means[7:0], means[23:16], means[15:8]};

  // The word that leaves next, and its position in the frame.
  logic [Latency-2:0] aborts;
  logic [Gain+Divide-2:0] completed;
  logic mean_next, abort_next, last_column, last_row;
  logic [ColumnWidth-1:0] column;
  logic [RowWidth-1:0] row;
  assign mean_next = completed[Gain+Divide-2];
  assign abort_next = aborts[Latency-2];
  assign last_column = column == ColumnWidth'(Columns - 1);
  assign last_row = row == RowWidth'(Rows - 1);
  always_ff @(posedge clk) begin
    if (en) begin
      aborts <= {aborts[Latency-3:0], in_abort};
      completed <= {completed[Gain+Divide-3:0], complete};
      out_valid <= mean_next | abort_next;
      out_user <= column == '0 & row == '0;
      out_last <= last_column ^ abort_next;
      if (mean_next) begin
        column <= last_column ? '0 : column + ColumnWidth'(1);
        if (last_column) row <= last_row ? '0 : row + RowWidth'(1);
      end
      if (abort_next) begin
        column <= '0;
        row <= '0;
      end
    end
    if (rst) {aborts, completed, out_valid, column, row} <= '0;
  end

endmodule

`default_nettype wire
