// SPDX-License-Identifier: Apache-2.0
// camera_unit: a camera in front of tactile_depth: the pixels of the grid, and the registers of the front end.
//
//   s_axis -> camera_front_end -> m_axis        register_command, register_answer <-> camera_registers
//
// Stream in: AXI4-Stream Video in the camera's format. Stream out: that which tactile_depth takes. Latency:
// camera_front_end.sv. Parameters: models/tactile_depth/chip/camera/camera_unit.py.

`default_nettype none

module camera_unit
  import td_camera_map_pkg::*;
  import td_config_pkg::*;
  import td_types_pkg::*;
#(
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows           = value(Config, RowsField),
  localparam int Columns        = value(Config, ColumnsField),
  localparam int Numerator      = value(Config, CameraNumeratorField),
  localparam int Denominator    = value(Config, CameraDenominatorField),
  localparam int Format         = value(Config, CameraFormatField),
  localparam int Phase          = value(Config, CameraPhaseField),
  localparam int PictureColumns = value(Config, CameraPictureColumnsField),
  localparam int PictureRows    = value(Config, CameraPictureRowsField),
  localparam int WindowX        = value(Config, CameraWindowXField),
  localparam int WindowY        = value(Config, CameraWindowYField),
  localparam int BlackLevel     = value(Config, CameraBlackLevelField),
  localparam int RedGain        = value(Config, CameraRedGainField),
  localparam int GreenGain      = value(Config, CameraGreenGainField),
  localparam int BlueGain       = value(Config, CameraBlueGainField),
  localparam int WindowColumns  = (Columns * Numerator + Denominator - 1) / Denominator,
  localparam int WindowRows     = (Rows * Numerator + Denominator - 1) / Denominator
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire register_command_t register_command,
  output register_answer_t       register_answer,

  input  wire  [7:0]             frames_lost,    // of dvp_receive; 0 without one
  output logic                   setup_restart,  // of camera_setup; its other pins are 0 without one
  input  wire                    setup_done,
  input  wire                    setup_failed,
  input  wire  [7:0]             setup_entry,
  input  wire  [7:0]             setup_found,

  input  wire  [23:0]            s_axis_tdata,
  input  wire                    s_axis_tvalid,
  output logic                   s_axis_tready,
  input  wire                    s_axis_tlast,
  input  wire                    s_axis_tuser,
  output logic [23:0]            m_axis_tdata,
  output logic                   m_axis_tvalid,
  input  wire                    m_axis_tready,
  output logic                   m_axis_tlast,
  output logic                   m_axis_tuser
);

  camera_settings_t settings;
  camera_faults_t faults;
  camera_levels_t levels;
  camera_front_end #(
    .Rows(Rows), .Columns(Columns), .Numerator(Numerator), .Denominator(Denominator), .Format(Format), .Phase(Phase)
  ) u_front_end (
    .clk, .rst, .settings, .faults, .levels, .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast,
    .s_axis_tuser, .m_axis_tdata, .m_axis_tvalid, .m_axis_tready, .m_axis_tlast, .m_axis_tuser
  );

  logic writable, readable;
  logic [31:0] read_data;
  camera_registers #(
    .PictureColumns(PictureColumns), .PictureRows(PictureRows), .WindowX(WindowX), .WindowY(WindowY),
    .WindowColumns(WindowColumns), .WindowRows(WindowRows), .BlackLevel(BlackLevel), .RedGain(RedGain),
    .GreenGain(GreenGain), .BlueGain(BlueGain), .Format(Format), .Phase(Phase)
  ) u_registers (
    .clk, .rst, .write(register_command.write), .write_offset(register_command.write_offset),
    .write_ones(register_command.write_ones), .write_mask(register_command.write_mask), .writable,
    .read_offset(register_command.read_offset), .readable, .read_data, .settings, .faults, .levels, .frames_lost,
    .setup_restart, .setup_done, .setup_failed, .setup_entry, .setup_found
  );
  assign register_answer.writable = writable;
  assign register_answer.readable = readable;
  assign register_answer.data = read_data;

  // Refused.

  if (Format < 0 || Format >= CameraFormatPixelFormatCount) begin : g_refused_0
    Format_is_a_number_of_camera_format_e u_refused ();
  end
  if (Phase < 0 || Phase >= CameraFormatPhaseCount) begin : g_refused_1
    Phase_is_0_to_3 u_refused ();
  end
  if (Rows < 2 || Columns < 4) begin : g_refused_2
    Rows_must_be_at_least_2_and_Columns_4 u_refused ();
  end
  if (Denominator < 1 || Numerator < Denominator) begin : g_refused_3
    Numerator_must_be_at_least_Denominator_and_Denominator_at_least_1 u_refused ();
  end
  if (format_is_bayer(Format) != 0 && Numerator < 2 * Denominator) begin : g_refused_4
    below_a_ratio_of_2_some_blocks_lack_a_colour u_refused ();
  end
  if (((PictureColumns | PictureRows | WindowX | WindowY | WindowColumns | WindowRows) >>> 13) != 0)
  begin : g_refused_5
    pictures_and_windows_have_up_to_8191_rows_and_columns u_refused ();
  end
  if ((BlackLevel >>> 12) != 0 || ((RedGain | GreenGain | BlueGain) >>> 16) != 0) begin : g_refused_6
    BlackLevel_must_fit_12_bits_and_gains_16 u_refused ();
  end

endmodule

`default_nettype wire
