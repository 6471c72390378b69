// SPDX-License-Identifier: Apache-2.0
// camera_front_end: the pixels of the grid from the words of a camera.
//
//   s_axis -> td_axis_skid -> camera_window -> pixel_format -> black_level -> area_average -> td_axis_skid -> m_axis
//
// Stream in: AXI4-Stream Video of a camera's pictures in its format (pixel_format.sv), words or single bytes.
// Stream out: AXI4-Stream Video of the grid, 24-bit pixels as tactile_depth takes them. One pixel a cycle.
// A malformed picture raises one fault for one cycle (camera_window.sv). It leaves as one frame with a row too short or
// too long, which the frame_guard behind drops whole and flags once; m_axis carries no other malformed frame. levels
// show the size of the picture that came last (td_frame_size).
// Latency: 23 cycles from the word that completes a block, gaps or not; YUYV 25, or 26 from the second pixel of a pair.
// A stalled sink stops all of it. Bit-accurate model, parameters: models/tactile_depth/chip/camera/camera_front_end.py.

`default_nettype none

module camera_front_end
  import td_camera_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter int Rows        = 128,  // of the grid
  parameter int Columns     = 128,
  parameter int Numerator   = 15,   // camera pixels for a pixel of the grid: Numerator / Denominator
  parameter int Denominator = 4,
  parameter int Format      = CameraFormatRaw10,
  parameter int Phase       = 0
) (
  input  wire                   clk,
  input  wire                   rst,
  input  wire camera_settings_t settings,
  output camera_faults_t        faults,
  output camera_levels_t        levels,
  input  wire  [23:0]           s_axis_tdata,
  input  wire                   s_axis_tvalid,
  output logic                  s_axis_tready,
  input  wire                   s_axis_tlast,
  input  wire                   s_axis_tuser,
  output logic [23:0]           m_axis_tdata,
  output logic                  m_axis_tvalid,
  input  wire                   m_axis_tready,
  output logic                  m_axis_tlast,
  output logic                  m_axis_tuser
);

  localparam int WindowColumns = (Columns * Numerator + Denominator - 1) / Denominator;
  localparam int WindowRows = (Rows * Numerator + Denominator - 1) / Denominator;
  localparam int Bits = format_bits(Format);
  localparam int Bayer = format_is_bayer(Format);
  localparam int GainWidth = 16;
  localparam int SamplesWidth = (Bayer != 0 ? 1 : 3) * (Bits + 2);

  logic en;  // all of it moves, or nothing: low while the output is full

  logic held_valid, held_ready, held_last, held_user;
  logic [23:0] held_data;
  td_axis_skid #(.Width(26)) u_input (
    .clk, .rst,
    .s_valid(s_axis_tvalid), .s_ready(s_axis_tready), .s_data({s_axis_tuser, s_axis_tlast, s_axis_tdata}),
    .m_valid(held_valid), .m_ready(held_ready), .m_data({held_user, held_last, held_data})
  );

  logic waiting;
  logic [13:0] arrived_columns, arrived_rows;
  td_frame_size #(.CountWidth(14), .WordsPerPixel(format_words(Format))) u_size (
    .clk, .rst, .in_valid(held_valid & held_ready), .in_last(held_last), .in_user(held_user),
    .columns(arrived_columns), .rows(arrived_rows), .silent(waiting)
  );
  assign levels.waiting = waiting;
  assign levels.arrived_columns = arrived_columns;
  assign levels.arrived_rows = arrived_rows;

  logic word_valid, in_window, odd_row, odd_column, word_row_start, word_frame_start, word_abort;
  logic row_short, row_long, start_missing, start_early, window_outside, hunting;
  logic [23:0] word;
  camera_window #(
    .WindowColumns(WindowColumns), .WindowRows(WindowRows), .WordsPerPixel(format_words(Format)),
    .PixelPairs(format_is_yuyv(Format))
  ) u_window (
    .clk, .rst, .en, .columns(settings.columns), .rows(settings.rows), .window_x(settings.window_x),
    .window_y(settings.window_y), .s_valid(held_valid), .s_ready(held_ready), .s_data(held_data), .s_last(held_last),
    .s_user(held_user), .out_valid(word_valid), .out_data(word), .out_inside(in_window), .out_odd_row(odd_row),
    .out_odd_column(odd_column), .out_row_start(word_row_start), .out_frame_start(word_frame_start),
    .out_abort(word_abort), .row_short, .row_long, .start_missing, .start_early, .window_outside, .hunting
  );
  assign levels.hunting = hunting;
  assign faults.row_short = row_short;
  assign faults.row_long = row_long;
  assign faults.start_missing = start_missing;
  assign faults.start_early = start_early;
  assign faults.window_outside = window_outside;

  logic sample_valid, sample_row_start, sample_frame_start, sample_abort;
  logic [1:0] sample_colour;
  logic [SamplesWidth-1:0] samples;
  pixel_format #(.Format(Format), .Phase(Phase)) u_format (
    .clk, .rst, .en, .in_valid(word_valid), .in_data(word), .in_inside(in_window), .in_odd_row(odd_row),
    .in_odd_column(odd_column), .in_row_start(word_row_start), .in_frame_start(word_frame_start),
    .in_abort(word_abort), .out_valid(sample_valid), .out_samples(samples), .out_colour(sample_colour),
    .out_row_start(sample_row_start), .out_frame_start(sample_frame_start), .out_abort(sample_abort)
  );

  logic colour_valid, colour_row_start, colour_frame_start, colour_abort;
  logic [1:0] colour_site;
  logic [SamplesWidth-1:0] colours;
  logic [3*GainWidth-1:0] gains;
  black_level #(.Bits(Bits), .Channels(Bayer != 0 ? 1 : 3), .GainsWidth(3 * GainWidth)) u_black (
    .clk, .rst, .en, .level(settings.black_level[Bits-1:0]),
    .gains({settings.blue_gain, settings.green_gain, settings.red_gain}), .in_valid(sample_valid), .in_samples(samples),
    .in_colour(sample_colour), .in_row_start(sample_row_start), .in_frame_start(sample_frame_start),
    .in_abort(sample_abort), .out_valid(colour_valid), .out_samples(colours), .out_colour(colour_site),
    .out_row_start(colour_row_start), .out_frame_start(colour_frame_start), .out_abort(colour_abort), .out_gains(gains)
  );

  logic pixel_valid, pixel_last, pixel_user;
  logic [23:0] pixel;
  area_average #(
    .Rows(Rows), .Columns(Columns), .Numerator(Numerator), .Denominator(Denominator), .Bits(Bits), .Bayer(Bayer)
  ) u_average (
    .clk, .rst, .en, .in_valid(colour_valid), .in_samples(colours), .in_colour(colour_site),
    .in_row_start(colour_row_start), .in_frame_start(colour_frame_start), .in_abort(colour_abort), .in_gains(gains),
    .out_valid(pixel_valid), .out_pixel(pixel), .out_last(pixel_last), .out_user(pixel_user)
  );

  td_axis_skid #(.Width(26)) u_output (
    .clk, .rst,
    .s_valid(pixel_valid), .s_ready(en), .s_data({pixel_user, pixel_last, pixel}),
    .m_valid(m_axis_tvalid), .m_ready(m_axis_tready), .m_data({m_axis_tuser, m_axis_tlast, m_axis_tdata})
  );

endmodule

`default_nettype wire
