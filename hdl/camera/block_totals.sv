// SPDX-License-Identifier: Apache-2.0
// block_totals: sums of camera pixels over each block of rows and columns, by colour, from those of row_sums.
//
//   total = sum w s,  area = sum w,  w the area of a camera pixel in the block, in units of 1 / Denominator^2
//
// RGB (Bayer 0): every area is Numerator^2. Bayer 1: an area is that of the pixels of its colour.
// Stream in: sums of a block's columns, in the order of the raster, and the marks of the pixels: in_row_start with the
// first of a row, and in_frame_start if no row is before it. Stream out: a word for each block that is complete.
// Memory: a line of totals. Latency: 3 cycles with en; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/camera/block_totals.py.

`default_nettype none

module block_totals #(
  parameter int Columns     = 128,  // of the grid, at least 4: a word is read before it is written
  parameter int Numerator   = 15,
  parameter int Denominator = 4,
  parameter int Width       = 12,  // of a sample
  parameter int Bayer       = 1,
  localparam int Sums = Bayer != 0 ? 2 : 3,
  localparam int BlockWidth = $clog2(Numerator + 1),
  localparam int SumWidth = Width + $clog2(Numerator),
  localparam int AreaWidth = $clog2(Numerator * Numerator + 1),
  localparam int TotalWidth = Width + $clog2(Numerator * Numerator)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_row_start,
  input  wire                       in_frame_start,
  input  wire                       in_blue_row,  // Bayer
  input  wire                       in_ends,      // a block's columns end; the inputs below belong to them
  input  wire [Sums*SumWidth-1:0]   in_sums,      // signed
  input  wire [BlockWidth-1:0]      in_red_columns,
  output logic                      out_valid,
  output logic [3*TotalWidth-1:0]   out_totals,  // signed, red lowest
  output logic [3*AreaWidth-1:0]    out_areas
);

  localparam int WeightWidth = $clog2(Denominator + 1);
  localparam int ColumnWidth = $clog2(Columns);
  localparam logic [WeightWidth-1:0] Pixel = WeightWidth'($unsigned(Denominator));
  localparam logic [BlockWidth-1:0] Block = BlockWidth'($unsigned(Numerator));
  localparam logic [AreaWidth-1:0] Area = AreaWidth'($unsigned(Numerator * Numerator));

  // The first pixel of a row brings the row's weight, which holds for the whole row.

  logic [WeightWidth-1:0] new_weight, weight, row_weight;
  logic new_ends, ends_row, row_ends, in_first_row, first_row;
  logic [ColumnWidth-1:0] column, next_column;
  block_weights #(.Numerator(Numerator), .Denominator(Denominator)) u_weights (
    .clk, .en, .step(in_row_start), .restart(in_frame_start), .weight(new_weight), .block_ends(new_ends)
  );
  assign weight = in_row_start ? new_weight : row_weight;
  assign ends_row = in_row_start ? new_ends : row_ends;
  assign in_first_row = in_row_start ? in_frame_start : first_row;
  assign column = in_row_start ? '0 : next_column;
  always_ff @(posedge clk) begin
    if (en) begin
      row_weight <= weight;
      row_ends <= ends_row;
      first_row <= in_first_row;
      next_column <= column + ColumnWidth'(in_ends);
    end
  end

  // Operands of the multipliers, beside the memory's word; products, beside the sums of the block's earlier rows; the
  // total, beside what the memory takes: the total, or, as the block ends, the part of the row in the next one.

  logic ends_q, ends_q2, ends_q3, complete_q, complete_q2, first_q, first_q2, blue_q, blue_q2;
  logic [ColumnWidth-1:0] column_q, column_q2, column_q3;
  logic [WeightWidth-1:0] weight_q;
  logic [Sums*SumWidth-1:0] sums_q;
  logic [3*TotalWidth-1:0] earlier, earlier_q, stored;
  always_ff @(posedge clk) begin
    if (en) begin
      {ends_q, ends_q2, ends_q3} <= {in_ends, ends_q, ends_q2};
      {complete_q, complete_q2, out_valid} <= {in_ends & ends_row, complete_q, complete_q2};
      {first_q, first_q2} <= {in_first_row, first_q};
      earlier_q <= earlier;
      {blue_q, blue_q2} <= {in_blue_row, blue_q};
      {column_q, column_q2, column_q3} <= {column, column_q, column_q2};
      weight_q <= weight;
      sums_q <= in_sums;
    end
    if (rst) {ends_q, ends_q2, ends_q3, complete_q, complete_q2, out_valid} <= '0;
  end
  td_ram #(.Width(3 * TotalWidth), .Depth(Columns)) u_line (
    .clk, .write_en(en & ends_q3), .write_address(column_q3), .write_data(stored),
    .read_en(en & in_ends & ~in_first_row), .read_address(column), .read_data(earlier)
  );

  logic [Sums*TotalWidth-1:0] parts, wholes;
  for (genvar n = 0; n < Sums; n++) begin : g_product
    logic signed [SumWidth+WeightWidth:0] part, whole;
    td_multiply #(.AWidth(SumWidth), .BWidth(WeightWidth + 1)) u_part (
      .clk, .en, .a(sums_q[n*SumWidth+:SumWidth]), .b({1'b0, weight_q}), .product(part)
    );
    td_multiply #(.AWidth(SumWidth), .BWidth(WeightWidth + 1)) u_whole (
      .clk, .en, .a(sums_q[n*SumWidth+:SumWidth]), .b({1'b0, Pixel}), .product(whole)
    );
    assign parts[n*TotalWidth+:TotalWidth] = TotalWidth'(part);
    assign wholes[n*TotalWidth+:TotalWidth] = TotalWidth'(whole);
  end

  for (genvar c = 0; c < 3; c++) begin : g_colour
    logic counts;
    logic [TotalWidth-1:0] part, whole, total;
    if (Bayer == 0) begin : g_rgb
      assign counts = 1'b1;
      assign part = parts[c*TotalWidth+:TotalWidth];
      assign whole = wholes[c*TotalWidth+:TotalWidth];
    end else if (c == 1) begin : g_green  // in the columns of blue where the row has red, and the other way round
      assign counts = 1'b1;
      assign part = blue_q2 ? parts[0+:TotalWidth] : parts[TotalWidth+:TotalWidth];
      assign whole = blue_q2 ? wholes[0+:TotalWidth] : wholes[TotalWidth+:TotalWidth];
    end else begin : g_red_or_blue
      assign counts = blue_q2 == (c == 2);
      assign part = parts[c/2*TotalWidth+:TotalWidth];
      assign whole = wholes[c/2*TotalWidth+:TotalWidth];
    end
    assign total = (first_q2 ? '0 : earlier_q[c*TotalWidth+:TotalWidth]) + (counts ? part : '0);
    always_ff @(posedge clk) begin
      if (en) begin
        out_totals[c*TotalWidth+:TotalWidth] <= total;
        if (!complete_q2) stored[c*TotalWidth+:TotalWidth] <= total;
        else stored[c*TotalWidth+:TotalWidth] <= counts ? whole - part : '0;
      end
    end
  end

  if (Bayer != 0) begin : g_areas
    // Red has its rows times its columns, blue the others of both, green the rest of the block. The others are counted
    // beside the rows of red, because their weight comes late.
    logic blue_row;
    logic [BlockWidth-1:0] carried, red_rows, row_red_rows, red_rows_q, red_columns_q, red_weight;
    logic [BlockWidth-1:0] carried_blue, blue_rows, row_blue_rows, blue_rows_q, blue_columns_q;
    logic signed [2*BlockWidth+1:0] red, blue;
    assign carried = ~row_ends ? row_red_rows : blue_row ? '0 : BlockWidth'(Pixel - row_weight);
    assign carried_blue = ~row_ends ? row_blue_rows : blue_row ? Block : Block - BlockWidth'(Pixel - row_weight);
    assign red_weight = in_blue_row ? '0 : BlockWidth'(new_weight);
    always_comb begin
      {red_rows, blue_rows} = {row_red_rows, row_blue_rows};
      if (in_row_start) begin
        red_rows = (in_frame_start ? '0 : carried) + red_weight;
        blue_rows = (in_frame_start ? Block : carried_blue) - red_weight;
      end
    end
    always_ff @(posedge clk) begin
      if (en) begin
        {row_red_rows, row_blue_rows} <= {red_rows, blue_rows};
        if (in_row_start) blue_row <= in_blue_row;
        red_rows_q <= red_rows;
        red_columns_q <= in_red_columns;
        blue_rows_q <= blue_rows;
        blue_columns_q <= Block - in_red_columns;
        out_areas <= {blue[AreaWidth-1:0], Area - red[AreaWidth-1:0] - blue[AreaWidth-1:0], red[AreaWidth-1:0]};
      end
    end
    td_multiply #(.AWidth(BlockWidth + 1), .BWidth(BlockWidth + 1)) u_red (
      .clk, .en, .a({1'b0, red_rows_q}), .b({1'b0, red_columns_q}), .product(red)
    );
    td_multiply #(.AWidth(BlockWidth + 1), .BWidth(BlockWidth + 1)) u_blue (
      .clk, .en, .a({1'b0, blue_rows_q}), .b({1'b0, blue_columns_q}), .product(blue)
    );
  end else begin : g_area
    assign out_areas = {3{Area}};
  end

endmodule

`default_nettype wire
