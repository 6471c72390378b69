// SPDX-License-Identifier: Apache-2.0
// gradient_unit: the slopes of the gel from the colours of its pixels.
//
//   pixel --> [flat_field] --> gradient_lookup or [light_gains] --> polynomial_gradient --> slope
//         \-> [reference_capture]                          \-> [gradient_lookup] -^
//
// In brackets: with FlatField, which makes colours relative to a frame without contact; with LightGains, which follow
// the light; with Corrections of slopes by colour. Without FlatField colours are as the camera sent them. Stream in:
// pixels R in 23:16, B in 15:8, G in 7:0, raster order. Stream out: slopes gx along the row and gy down the column,
// signed codes of GradientWidth bits; the tables say how many are fraction bits. Latency:
// models/tactile_depth/chip/latency.py; a gap in, a gap out. Behind a frame's last slope come its flags. Models:
// slopes_and_light and depth_and_flags in models/tactile_depth/chip/tactile_depth.py.

`default_nettype none

module gradient_unit
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows           = value(Config, RowsField),
  localparam int Columns        = value(Config, ColumnsField),
  localparam int GradientWidth  = value(Config, GradientWidthField),
  localparam int BitsPerChannel = value(Config, BitsPerChannelField),  // of a colour that index the table
  localparam int Parity         = value(Config, ParityField),  // of the memories
  localparam int FlatField      = value(Config, FlatFieldField),
  localparam int Polynomial     = value(Config, PolynomialField),  // 1 needs FlatField
  localparam int Corrections    = value(Config, CorrectionsField),  // 1 needs Polynomial
  localparam int LightGains     = value(Config, LightGainsField),  // 1 needs Polynomial
  localparam int BlockLog2      = value(Config, BlockLog2Field),  // from here: FlatField
  localparam int GainWidth      = value(Config, GainWidthField),
  localparam int CaptureLog2    = value(Config, CaptureLog2Field),
  localparam int ColourDrop     = value(Config, ColourDropField),
  localparam int SlopeDrop      = value(Config, SlopeDropField),  // from here: Polynomial
  localparam int FineBits       = value(Config, FineBitsField),
  localparam int CorrectionUnit = value(Config, CorrectionUnitField)
) (
  input  wire                             clk,
  input  wire                             rst,
  input  wire                             en,

  input  wire table_command_t             table_command,
  output table_answer_t                   table_answer,
  input  wire  [3:0]                      table_bank,
  output logic [3:0]                      table_in_use,
  input  wire  [7:0]                      dark_level,
  input  wire  [7:0]                      slope_limit,
  input  wire capture_command_t           capture_command,
  output capture_status_t                 capture_status,
  output logic                            dark,         // a pixel was held from its neighbour
  input  wire light_command_t             light_command,
  output logic [2:0][LightGainWidth-1:0]  light_gains,  // of red, green, blue from the lowest; 0 without LightGains
  output logic [3:0]                      saturations,  // clip count, delayed
  output logic                            flipped,      // a word that was read, or a gain, has a flipped bit

  input  wire                             pixel_valid,
  input  wire  [23:0]                     pixel_data,  // R in 23:16, B in 15:8, G in 7:0
  input  wire position_t                  pixel_position,
  input  wire                             pixel_bad,
  input  wire                             resumed,  // of the frame whose last pixel came last

  output logic                            slope_valid,
  output position_t                       slope_position,
  output logic signed [GradientWidth-1:0] slope_gx,  // slope code
  output logic signed [GradientWidth-1:0] slope_gy,  // slope code
  output logic                            slope_flags_valid,
  output frame_flags_t                    slope_flags  // those of solver and zero offset 0
);

  logic coefficients_in_use, gradient_in_use, reference_in_use;
  table_answer_t coefficients_answer, gradient_answer, reference_answer;
  assign table_answer = coefficients_answer | gradient_answer | reference_answer;
  assign table_in_use = (4'(coefficients_in_use) << TableSelectCoefficients)
      | (4'(gradient_in_use) << TableSelectGradient) | (4'(reference_in_use) << TableSelectReference);

  // Colours, relative to the reference if there is one.

  logic colour_valid, relative_ends, light_moves;
  position_t colour_position;
  logic [2:0][LightGainWidth-1:0] light_used;
  localparam int ColourWidth = Polynomial != 0 ? DeviationWidth : CodeWidth;
  logic [ColourWidth-1:0] red, green, blue;
  logic [1:0] ratio_saturations, light_saturations, slope_saturations;
  logic gains_flipped, light_flipped, correction_flipped, slope_flipped;
  always_ff @(posedge clk) begin
    flipped <= gains_flipped | light_flipped | correction_flipped | slope_flipped;
    saturations <= rst ? '0 : 4'(ratio_saturations) + 4'(light_saturations) + 4'(slope_saturations);
  end
  if (FlatField != 0) begin : g_flat_field
    localparam int NodeWidth = $clog2(nodes(Rows, Columns, BlockLog2));
    localparam int RelativeWidth = LightGains != 0 ? RatioWidth : ColourWidth;
    logic capture_write, capture_read, relative_valid;
    logic [2:0][RelativeWidth-1:0] relative;  // to the reference: red, green, blue from the lowest
    position_t relative_position;
    logic [NodeWidth-1:0] capture_write_node, capture_read_node;
    logic [3*GainWidth-1:0] capture_gains, capture_read_gains;
    flat_field #(
      .TableFolder(TableFolder),
      .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .GainWidth(GainWidth), .Drop(ColourDrop),
      .Offset(Polynomial != 0 && LightGains == 0 ? 1 << DeviationFraction : 0), .OutWidth(RelativeWidth),
      .Flat(Polynomial != 0 ? 0 : FlatCode), .Parity(Parity)
    ) u_flat_field (
      .clk, .rst, .en, .dark_level,
      .table_command, .table_answer(reference_answer), .table_bank(table_bank[TableSelectReference]),
      .table_in_use(reference_in_use), .capture_write, .capture_write_node, .capture_gains,
      .capture_read, .capture_read_node, .capture_read_gains,
      .in_valid(pixel_valid), .in_pixel(pixel_data), .in_position(pixel_position),
      .out_valid(relative_valid), .out_position(relative_position), .out_red(relative[0]), .out_green(relative[1]),
      .out_blue(relative[2]), .dark, .saturations(ratio_saturations), .flipped(gains_flipped)
    );
    if (LightGains != 0) begin : g_light
      light_gains #(
        .Rows(Rows), .Columns(Columns), .RatioWidth(RatioWidth), .RatioFraction(RatioFraction),
        .GainWidth(LightGainWidth), .OutWidth(DeviationWidth), .OutFraction(DeviationFraction), .Parity(Parity)
      ) u_light (
        .clk, .rst, .en, .follow(light_command.follow), .rate(light_command.rate), .write(light_command.write),
        .write_gain(light_command.gain), .gains(light_gains), .used(light_used), .moves(light_moves),
        .in_bad(pixel_valid & pixel_position.last_row & pixel_position.last_column & pixel_bad),
        .in_valid(relative_valid), .in_position(relative_position), .in_red(relative[0]), .in_green(relative[1]),
        .in_blue(relative[2]), .out_valid(colour_valid), .out_position(colour_position), .out_red(red),
        .out_green(green), .out_blue(blue), .saturations(light_saturations), .flipped(light_flipped)
      );
    end else begin : g_no_light
      assign {blue, green, red} = relative;
      assign {colour_valid, colour_position} = {relative_valid, relative_position};
      assign {light_gains, light_used, light_moves, light_saturations, light_flipped} = '0;
    end
    assign relative_ends = relative_valid & relative_position.last_row & relative_position.last_column;
    reference_capture #(
      .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(GainWidth),
      .GainFraction(GainWidth + DarkestLog2), .MaxLog2(CaptureLog2)
    ) u_capture (
      .clk, .rst, .en, .request(capture_command.request), .log2_frames(capture_command.log2_frames),
      .busy(capture_status.busy), .done(capture_status.done), .captured(capture_status.captured),
      .in_valid(pixel_valid), .in_pixel(pixel_data), .in_position(pixel_position), .in_bad(pixel_bad),
      .map_write(capture_write), .map_write_node(capture_write_node), .map_write_gains(capture_gains),
      .map_read(capture_read), .map_read_node(capture_read_node), .map_read_gains(capture_read_gains)
    );
  end else begin : g_as_sent
    assign {red, blue, green} = pixel_data;
    assign colour_valid = pixel_valid;
    assign colour_position = pixel_position;
    assign relative_ends = pixel_valid & pixel_position.last_row & pixel_position.last_column;
    assign {dark, ratio_saturations, light_saturations, light_gains, light_used, light_moves} = '0;
    assign {capture_status, reference_in_use, reference_answer, gains_flipped, light_flipped} = '0;
  end

  // Their slopes.

  if (Polynomial != 0) begin : g_polynomial
    logic signed [CorrectionWidth-1:0] correction_gx, correction_gy;
    if (Corrections != 0) begin : g_corrections
      // The middle entry has deviation 0 at its centre; what is brighter than the table has its last entry.
      localparam int PlaceWidth = ColourWidth + 1;
      localparam int Start = (1 << DeviationFraction) + (1 << (DeviationFraction - BitsPerChannel));
      logic [2:0][ColourWidth-1:0] colours;
      logic [2:0][7:0] codes;
      assign colours = {red, green, blue};
      for (genvar colour = 0; colour < 3; colour++) begin : g_colour
        logic signed [PlaceWidth-1:0] place;  // from the start of the table; a deviation is -1 or more
        assign place = PlaceWidth'($signed(colours[colour])) + PlaceWidth'(Start);
        assign codes[colour] = place[ColourWidth:DeviationFraction+1] != '0 ? '1 : place[DeviationFraction-:8];
      end
      gradient_lookup #(
        .File({TableFolder, "gradient.hex"}), .Width(CorrectionWidth), .BitsPerChannel(BitsPerChannel),
        .Parity(Parity)
      ) u_corrections (
        .clk, .rst, .en, .table_command, .table_answer(gradient_answer), .table_bank(table_bank[TableSelectGradient]),
        .table_in_use(gradient_in_use),
        .in_valid(colour_valid), .in_pixel({codes[2], codes[0], codes[1]}), .in_position(colour_position),
        .out_valid(), .out_position(), .out_gx(correction_gx), .out_gy(correction_gy),
        .flipped(correction_flipped)
      );
    end else begin : g_no_corrections
      assign {correction_gx, correction_gy, gradient_in_use, gradient_answer, correction_flipped} = '0;
    end
    polynomial_gradient #(
      .TableFolder(TableFolder), .Width(GradientWidth), .DeviationWidth(ColourWidth), .CoeffWidth(ColourCoeffWidth),
      .WordWidth(PolynomialWidth), .FineBits(FineBits), .CorrectionWidth(CorrectionWidth),
      .CorrectionUnit(CorrectionUnit), .Drop(SlopeDrop), .Parity(Parity)
    ) u_polynomial (
      .clk, .rst, .en, .table_command, .table_answer(coefficients_answer),
      .table_bank(table_bank[TableSelectCoefficients]), .table_in_use(coefficients_in_use),
      .in_valid(colour_valid), .in_position(colour_position), .in_red(red), .in_green(green), .in_blue(blue),
      .correction_gx, .correction_gy,
      .out_valid(slope_valid), .out_position(slope_position), .out_gx(slope_gx), .out_gy(slope_gy),
      .saturations(slope_saturations), .flipped(slope_flipped)
    );
  end else begin : g_lookup
    gradient_lookup #(
      .File({TableFolder, "gradient.hex"}), .Width(GradientWidth), .BitsPerChannel(BitsPerChannel), .Parity(Parity)
    ) u_lookup (
      .clk, .rst, .en, .table_command, .table_answer(gradient_answer), .table_bank(table_bank[TableSelectGradient]),
      .table_in_use(gradient_in_use),
      .in_valid(colour_valid), .in_pixel({red, blue, green}), .in_position(colour_position),
      .out_valid(slope_valid), .out_position(slope_position), .out_gx(slope_gx), .out_gy(slope_gy),
      .flipped(slope_flipped)
    );
    assign {slope_saturations, coefficients_in_use, coefficients_answer, correction_flipped} = '0;
  end

  frame_marks #(.Width(GradientWidth), .Pixels(Rows * Columns)) u_marks (
    .clk, .rst, .en, .slope_limit, .relative_ends, .relative_clipped(ratio_saturations != '0), .dark,
    .light_gains(light_used), .light_moves,
    .colour_ends(colour_valid & colour_position.last_row & colour_position.last_column),
    .colour_clipped(light_saturations != '0), .slope_valid,
    .slope_ends(slope_valid & slope_position.last_row & slope_position.last_column),
    .slope_clipped(slope_saturations != '0), .slope_gx, .slope_gy, .resumed,
    .out_valid(slope_flags_valid), .out_flags(slope_flags)
  );

endmodule

`default_nettype wire
