// SPDX-License-Identifier: Apache-2.0
// row_sums: sums of the pixels of a camera row over each block of columns, by colour.
//
//   sum = sum w s,  w the width of the pixel in the block in units of 1 / Denominator (block_weights)
//
// RGB (Bayer 0): a sum for each colour. Bayer 1: a sample is one colour; sum 0 runs over the columns of red, sum 1 over
// those of blue, and red_columns is sum w of the columns of red.
// Stream in: the pixels of a row, in_row_start with the first; gaps anywhere. Stream out: a word with the last pixel of
// each block. Latency: 3 cycles with en; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/camera/row_sums.py.

`default_nettype none

module row_sums #(
  parameter int Numerator   = 15,  // Bayer: at least 2 Denominator, or some blocks lack a colour
  parameter int Denominator = 4,
  parameter int Width       = 12,  // of a sample
  parameter int Bayer       = 1,
  localparam int Channels = Bayer != 0 ? 1 : 3,
  localparam int Sums = Bayer != 0 ? 2 : 3,
  localparam int SumWidth = Width + $clog2(Numerator),
  localparam int BlockWidth = $clog2(Numerator + 1)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_valid,
  input  wire [Channels*Width-1:0]  in_samples,      // signed, red lowest
  input  wire                       in_blue_column,  // Bayer
  input  wire                       in_row_start,
  output logic                      out_ends,  // the block ends with this pixel; the outputs below belong to it
  output logic [Sums*SumWidth-1:0] out_sums,  // signed
  output logic [BlockWidth-1:0]     out_red_columns
);

  localparam int WeightWidth = $clog2(Denominator + 1);
  localparam int ProductWidth = Width + WeightWidth + 1;
  localparam logic signed [WeightWidth:0] Pixel = (WeightWidth + 1)'($unsigned(Denominator));

  logic block_ends, valid_q, ends_q, row_start_q, blue_q;
  logic valid_q2, ends_q2, row_start_q2, blue_q2;
  logic [WeightWidth-1:0] weight, weight_q, weight_q2;
  block_weights #(.Numerator(Numerator), .Denominator(Denominator)) u_weights (
    .clk, .en, .step(in_valid), .restart(in_row_start), .weight, .block_ends
  );

  logic [Channels*Width-1:0] samples_q;
  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= in_valid;
      ends_q <= block_ends;
      row_start_q <= in_row_start;
      blue_q <= in_blue_column;
      weight_q <= weight;
      samples_q <= in_samples;
      valid_q2 <= valid_q;
      ends_q2 <= ends_q;
      row_start_q2 <= row_start_q;
      blue_q2 <= blue_q;
      weight_q2 <= weight_q;
      out_ends <= valid_q2 & ends_q2;
    end
    if (rst) {valid_q, valid_q2, out_ends} <= '0;
  end

  // The part of the sample in the present block, and the whole.
  logic [Channels*SumWidth-1:0] parts, wholes;
  for (genvar c = 0; c < Channels; c++) begin : g_product
    logic signed [ProductWidth-1:0] part, whole;
    td_multiply #(.AWidth(Width), .BWidth(WeightWidth + 1)) u_part (
      .clk, .en, .a(samples_q[c*Width+:Width]), .b({1'b0, weight_q}), .product(part)
    );
    td_multiply #(.AWidth(Width), .BWidth(WeightWidth + 1)) u_whole (
      .clk, .en, .a(samples_q[c*Width+:Width]), .b(Pixel), .product(whole)
    );
    assign parts[c*SumWidth+:SumWidth] = SumWidth'(part);
    assign wholes[c*SumWidth+:SumWidth] = SumWidth'(whole);
  end

  for (genvar n = 0; n < Sums; n++) begin : g_sum
    localparam int Channel = Bayer != 0 ? 0 : n;
    logic [SumWidth-1:0] sum, sum_now, part, rest;  // of the present block; of the pixel in it and in the next
    logic counts;
    assign counts = Bayer == 0 | blue_q2 == (n != 0);
    assign part = counts ? parts[Channel*SumWidth+:SumWidth] : '0;
    assign rest = counts ? wholes[Channel*SumWidth+:SumWidth] - part : '0;
    assign sum_now = (row_start_q2 ? '0 : sum) + part;
    always_ff @(posedge clk) begin
      if (en && valid_q2) begin
        sum <= ends_q2 ? rest : sum_now;
        out_sums[n*SumWidth+:SumWidth] <= sum_now;
      end
    end
  end

  if (Bayer != 0) begin : g_red_columns
    logic [BlockWidth-1:0] sum, sum_now, part, rest;
    assign part = blue_q2 ? '0 : BlockWidth'(weight_q2);
    assign rest = blue_q2 ? '0 : BlockWidth'($unsigned(Denominator)) - part;
    assign sum_now = (row_start_q2 ? '0 : sum) + part;
    always_ff @(posedge clk) begin
      if (en && valid_q2) begin
        sum <= ends_q2 ? rest : sum_now;
        out_red_columns <= sum_now;
      end
    end
  end else begin : g_no_red_columns
    assign out_red_columns = '0;
  end

endmodule

`default_nettype wire
