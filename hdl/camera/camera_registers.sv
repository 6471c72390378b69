// SPDX-License-Identifier: Apache-2.0
// camera_registers: the registers of the camera front end, on AXI4-Lite.
//
//   s_axil <-> axil_port -> setting_registers -> settings of camera_front_end
//                        <- faults, frames_lost: sticky bits and counters
//                        <> camera_setup: restart, and how it stands
//
// The map is docs/camera-registers.md; its offsets continue those of axil_registers. A write takes effect in the clock
// in which axil_port raises `write`, and shows in the next; a read shows the registers as they were before the write of
// the same clock. An event counts for each clock in which it is high, and reaches status and counters one clock later.
// Model: models/tactile_depth/camera/camera_registers.py, which also has the parameters.

`default_nettype none

module camera_registers
  import td_camera_map_pkg::*;
  import td_register_map_pkg::AddressWidth;
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
  parameter int Format         = 0,
  parameter int Bits           = 10,
  parameter int Phase          = 0
) (
  input  wire                     clk,
  input  wire                     rst,

  input  wire  [AddressWidth-1:0] s_axil_awaddr,
  input  wire  [2:0]              s_axil_awprot,  // no effect
  input  wire                     s_axil_awvalid,
  output logic                    s_axil_awready,
  input  wire  [31:0]             s_axil_wdata,
  input  wire  [3:0]              s_axil_wstrb,
  input  wire                     s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  wire                     s_axil_bready,
  input  wire  [AddressWidth-1:0] s_axil_araddr,
  input  wire  [2:0]              s_axil_arprot,  // no effect
  input  wire                     s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  wire                     s_axil_rready,

  output camera_settings_t        settings,       // of camera_front_end
  input  wire camera_faults_t     faults,
  input  wire  [7:0]              frames_lost,    // of dvp_receive; 0 without one
  output logic                    setup_restart,  // of camera_setup; its other pins are 0 without one
  input  wire                     setup_done,
  input  wire                     setup_failed,
  input  wire  [7:0]              setup_entry,
  input  wire  [7:0]              setup_found
);

  logic write, read, write_refused;
  logic [31:0] write_offset, write_ones, write_mask, read_offset, read_data;
  assign write_refused = !is_camera_writable(write_offset);
  axil_port u_port (
    .clk, .rst, .s_axil_awaddr, .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb, .s_axil_wvalid,
    .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr, .s_axil_arvalid, .s_axil_arready,
    .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready, .write, .write_offset, .write_ones, .write_mask,
    .write_refused, .read, .read_offset, .read_data, .read_refused(!is_camera_register(read_offset)),
    .read_late(1'b0), .late_data(32'd0), .late_refused(1'b0)
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
  assign settings = {
    words[CameraPictureSetting][CameraPictureColumnsLsb+:13], words[CameraPictureSetting][CameraPictureRowsLsb+:13],
    words[CameraWindowSetting][CameraWindowXLsb+:13], words[CameraWindowSetting][CameraWindowYLsb+:13],
    words[CameraBlackLevelSetting][11:0], words[CameraRedGainSetting][15:0], words[CameraGreenGainSetting][15:0],
    words[CameraBlueGainSetting][15:0]
  };

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

  // A counter that counts on, and stays at all ones.
  function automatic logic [31:0] counted(input logic [31:0] count, input logic [7:0] step);
    logic [32:0] sum;
    sum = {1'b0, count} + 33'(step);
    counted = sum[31:0] | {32{sum[32]}};
  endfunction

  always_ff @(posedge clk) begin
    faults_q <= faults;
    lost_q <= frames_lost;
    status <= (status & ~(write && write_offset == CameraStatusOffset ? write_ones : '0)) | status_set;
    dropped <= counted(control[CameraControlClearCountersBit] ? '0 : dropped, 8'(|faults_q));
    lost <= counted(control[CameraControlClearCountersBit] ? '0 : lost, lost_q);
    if (rst) {faults_q, lost_q, status, dropped, lost} <= '0;
  end

  logic [31:0] word;  // that setting_registers does not hold
  always_comb begin
    case (read_offset)
      CameraWindowSizeOffset: begin
        word = (WindowColumns << CameraWindowSizeColumnsLsb) | (WindowRows << CameraWindowSizeRowsLsb);
      end
      CameraFormatOffset: begin
        word = (Format << CameraFormatPixelFormatLsb) | (Phase << CameraFormatPhaseLsb) | (Bits << CameraFormatBitsLsb);
      end
      CameraStatusOffset: begin
        word = status | (32'(setup_done) << CameraStatusSetupDoneBit)
          | (32'(setup_failed) << CameraStatusSetupFailedBit);
      end
      CameraDroppedOffset: word = dropped;
      CameraLostOffset: word = lost;
      CameraSetupOffset: begin
        word = (32'(setup_entry) << CameraSetupEntryLsb) | (32'(setup_found) << CameraSetupFoundLsb);
      end
      default: word = '0;
    endcase
  end
  assign read_data = word | setting_data;

  logic unused_pins;
  assign unused_pins = ^{read, s_axil_awprot, s_axil_arprot};

  if (((PictureColumns | PictureRows | WindowX | WindowY | WindowColumns | WindowRows) >>> 13) != 0)
  begin : g_refused_0
    pictures_and_windows_have_up_to_8191_rows_and_columns u_refused ();
  end
  if ((BlackLevel >>> 12) != 0 || ((RedGain | GreenGain | BlueGain) >>> 16) != 0) begin : g_refused_1
    BlackLevel_must_fit_12_bits_and_gains_16 u_refused ();
  end

endmodule

`default_nettype wire
