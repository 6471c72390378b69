// SPDX-License-Identifier: Apache-2.0
// camera_registers: the registers of the camera front end, behind the axil_port of axil_registers.
//
//   write -> setting_registers -> settings of camera_front_end
//   read <-- sticky bits and counters <- faults, frames_lost
//        <-- levels of camera_front_end
//        <-> camera_setup: restart, and its state
//
// The map is docs/generated/camera-registers.md; its offsets continue those of axil_registers. A write takes effect in
// its cycle, and shows in the next; a read shows the registers as they were before the write of the same cycle.
// read_data is the word at read_offset, 0 where there is none. An event counts for each cycle in which it is high, and
// reaches status and counters one cycle later. Model, and parameters:
// models/tactile_depth/chip/camera/camera_registers.py.

`default_nettype none

module camera_registers
  import td_camera_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter int PictureColumns = 640,  // after a reset, as the other settings
  parameter int PictureRows    = 480,
  parameter int WindowX        = 80,
  parameter int WindowY        = 0,
  parameter int BlackLevel     = 0,
  parameter int RedGain        = 4096,
  parameter int GreenGain      = 4096,
  parameter int BlueGain       = 4096,
  parameter int WindowColumns  = 480,  // of camera_front_end
  parameter int WindowRows     = 480,
  parameter int Format         = CameraFormatRaw10,
  parameter int Phase          = 0
) (
  input  wire                     clk,
  input  wire                     rst,

  input  wire                     write,
  input  wire  [31:0]             write_offset,
  input  wire  [31:0]             write_ones,     // the data, 0 in bytes without strobe
  input  wire  [31:0]             write_mask,     // ones in bytes with strobe
  output logic                    writable,       // write_offset is that of a register that takes writes
  input  wire  [31:0]             read_offset,
  output logic                    readable,       // read_offset is that of a register
  output logic [31:0]             read_data,

  output camera_settings_t        settings,       // of camera_front_end
  input  wire camera_faults_t     faults,
  input  wire camera_levels_t     levels,
  input  wire  [7:0]              frames_lost,    // of dvp_receive; 0 without one
  output logic                    setup_restart,  // of camera_setup; its other pins are 0 without one
  input  wire                     setup_done,
  input  wire                     setup_failed,
  input  wire  [7:0]              setup_entry,
  input  wire  [7:0]              setup_found
);

  // Settings.

  localparam int Width = 32 * CameraSettings;
  localparam logic [31:0] PictureWord =
    (PictureColumns << CameraPictureColumnsLsb) | (PictureRows << CameraPictureRowsLsb);
  localparam logic [31:0] WindowWord = (WindowX << CameraWindowXLsb) | (WindowY << CameraWindowYLsb);
  localparam logic [Width-1:0] Resets = (Width'(PictureWord) << (32 * CameraPictureSetting))
    | (Width'(WindowWord) << (32 * CameraWindowSetting))
    | (Width'($unsigned(BlackLevel)) << (32 * CameraBlackLevelSetting))
    | (Width'($unsigned(RedGain)) << (32 * CameraRedGainSetting))
    | (Width'($unsigned(GreenGain)) << (32 * CameraGreenGainSetting))
    | (Width'($unsigned(BlueGain)) << (32 * CameraBlueGainSetting));
  logic [31:0] setting_data;
  logic [CameraSettings-1:0][31:0] words;
  setting_registers #(
    .Count(CameraSettings), .Offsets(CameraSettingOffsets), .Masks(CameraSettingMasks), .Resets(Resets)
  ) u_settings (
    .clk, .rst, .write, .write_offset, .write_ones, .write_mask, .read_offset, .read_data(setting_data),
    .settings(words)
  );
  assign settings.columns = words[CameraPictureSetting][CameraPictureColumnsLsb+:13];
  assign settings.rows = words[CameraPictureSetting][CameraPictureRowsLsb+:13];
  assign settings.window_x = words[CameraWindowSetting][CameraWindowXLsb+:13];
  assign settings.window_y = words[CameraWindowSetting][CameraWindowYLsb+:13];
  assign settings.black_level = words[CameraBlackLevelSetting][11:0];
  assign settings.red_gain = words[CameraRedGainSetting][15:0];
  assign settings.green_gain = words[CameraGreenGainSetting][15:0];
  assign settings.blue_gain = words[CameraBlueGainSetting][15:0];

  // Events, in registers first, so that no path from the front end ends in the counters.

  camera_faults_t faults_q;
  logic [7:0] lost_q;
  logic [31:0] status, status_set, control, dropped, lost;
  assign status_set = (32'(faults_q.row_short) << CameraStatusRowShortBit)
    | (32'(faults_q.row_long) << CameraStatusRowLongBit)
    | (32'(faults_q.start_missing) << CameraStatusStartMissingBit)
    | (32'(faults_q.start_early) << CameraStatusStartEarlyBit)
    | (32'(faults_q.window_outside) << CameraStatusWindowOutsideBit)
    | (32'(lost_q != '0) << CameraStatusLostBit);
  assign control = write && write_offset == CameraControlOffset ? write_ones : '0;
  assign setup_restart = control[CameraControlRestartSetupBit];

  always_ff @(posedge clk) begin
    faults_q <= faults;
    lost_q <= frames_lost;
    status <= (status & ~(write && write_offset == CameraStatusOffset ? write_ones : '0)) | status_set;
    dropped <= counted(dropped, StepWidth'(|faults_q), control[CameraControlClearCountersBit]);
    lost <= counted(lost, StepWidth'(lost_q), control[CameraControlClearCountersBit]);
    if (rst) {faults_q, lost_q, status, dropped, lost} <= '0;
  end

  logic [31:0] level_bits, arrived;
  assign level_bits = (32'(levels.hunting) << CameraStatusHuntingBit) | (32'(levels.waiting) << CameraStatusWaitingBit);
  assign arrived =
    (32'(levels.arrived_columns) << CameraArrivedColumnsLsb) | (32'(levels.arrived_rows) << CameraArrivedRowsLsb);

  logic [31:0] word;  // that setting_registers does not hold
  always_comb begin
    case (read_offset)
      CameraWindowSizeOffset: begin
        word = (WindowColumns << CameraWindowSizeColumnsLsb) | (WindowRows << CameraWindowSizeRowsLsb);
      end
      CameraFormatOffset: begin
        word = (Format << CameraFormatPixelFormatLsb) | (Phase << CameraFormatPhaseLsb)
          | (format_bits(Format) << CameraFormatBitsLsb);
      end
      CameraStatusOffset: begin
        word = status | (32'(setup_done) << CameraStatusSetupDoneBit)
          | (32'(setup_failed) << CameraStatusSetupFailedBit) | level_bits;
      end
      CameraDroppedOffset: word = dropped;
      CameraLostOffset: word = lost;
      CameraArrivedOffset: word = arrived;
      CameraSetupOffset: begin
        word = (32'(setup_entry) << CameraSetupEntryLsb) | (32'(setup_found) << CameraSetupFoundLsb);
      end
      default: word = '0;
    endcase
  end
  assign writable = is_camera_writable(write_offset);
  assign readable = is_camera_register(read_offset);
  assign read_data = word | setting_data;

endmodule

`default_nettype wire
