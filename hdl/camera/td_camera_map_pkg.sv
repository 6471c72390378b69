// SPDX-License-Identifier: Apache-2.0
// td_camera_map_pkg: offsets, reset values and bits of the AXI4-Lite registers of the camera front end.
//
// Written by `make registers` from registers/camera.rdl: change it there.

`default_nettype none

package td_camera_map_pkg;

  // Byte offsets.
  localparam int CameraAddressWidth = 10;
  localparam int CameraPictureOffset = 32'h100;
  localparam int CameraWindowOffset = 32'h104;
  localparam int CameraWindowSizeOffset = 32'h108;
  localparam int CameraFormatOffset = 32'h10c;
  localparam int CameraBlackLevelOffset = 32'h110;
  localparam int CameraRedGainOffset = 32'h114;
  localparam int CameraGreenGainOffset = 32'h118;
  localparam int CameraBlueGainOffset = 32'h11c;
  localparam int CameraStatusOffset = 32'h120;
  localparam int CameraControlOffset = 32'h124;
  localparam int CameraDroppedOffset = 32'h128;
  localparam int CameraLostOffset = 32'h12c;
  localparam int CameraSetupOffset = 32'h130;
  localparam int CameraArrivedOffset = 32'h134;

  // Bits: number of a flag, lowest of a wider field.
  localparam int CameraPictureColumnsLsb = 0;
  localparam int CameraPictureRowsLsb = 16;
  localparam int CameraWindowXLsb = 0;
  localparam int CameraWindowYLsb = 16;
  localparam int CameraWindowSizeColumnsLsb = 0;
  localparam int CameraWindowSizeRowsLsb = 16;
  localparam int CameraFormatPixelFormatLsb = 0;
  localparam int CameraFormatPixelFormatWidth = 4;
  localparam int CameraFormatPhaseLsb = 4;
  localparam int CameraFormatPhaseWidth = 2;
  localparam int CameraFormatBitsLsb = 8;
  localparam int CameraStatusRowShortBit = 0;
  localparam int CameraStatusRowLongBit = 1;
  localparam int CameraStatusStartMissingBit = 2;
  localparam int CameraStatusStartEarlyBit = 3;
  localparam int CameraStatusWindowOutsideBit = 4;
  localparam int CameraStatusLostBit = 5;
  localparam int CameraStatusSetupDoneBit = 8;
  localparam int CameraStatusSetupFailedBit = 9;
  localparam int CameraStatusHuntingBit = 10;
  localparam int CameraStatusWaitingBit = 11;
  localparam int CameraControlClearCountersBit = 0;
  localparam int CameraControlRestartSetupBit = 1;
  localparam int CameraSetupEntryLsb = 0;
  localparam int CameraSetupFoundLsb = 8;
  localparam int CameraArrivedColumnsLsb = 0;
  localparam int CameraArrivedRowsLsb = 16;

  // Values of a field.
  localparam int CameraFormatPixelFormatCount = 10;
  localparam int CameraFormatRgb888 = 0;
  localparam int CameraFormatRgb565 = 1;
  localparam int CameraFormatRgb565Bytes = 2;
  localparam int CameraFormatYuyv = 3;
  localparam int CameraFormatYuyvBytes = 4;
  localparam int CameraFormatRaw8 = 5;
  localparam int CameraFormatRaw10 = 6;
  localparam int CameraFormatRaw10Lsb = 7;
  localparam int CameraFormatRaw12 = 8;
  localparam int CameraFormatRaw12Lsb = 9;
  localparam int CameraFormatPhaseCount = 4;
  localparam int CameraFormatRggb = 0;
  localparam int CameraFormatGrbg = 1;
  localparam int CameraFormatGbrg = 2;
  localparam int CameraFormatBggr = 3;

  // Registers that software alone writes, by number, in words of 32 bits, the lowest first.
  localparam int CameraSettings = 6;
  localparam int CameraPictureSetting = 0;
  localparam int CameraWindowSetting = 1;
  localparam int CameraBlackLevelSetting = 2;
  localparam int CameraRedGainSetting = 3;
  localparam int CameraGreenGainSetting = 4;
  localparam int CameraBlueGainSetting = 5;
  localparam logic [32*CameraSettings-1:0] CameraSettingOffsets = {
    CameraBlueGainOffset, CameraGreenGainOffset, CameraRedGainOffset, CameraBlackLevelOffset, CameraWindowOffset,
    CameraPictureOffset
  };
  localparam logic [32*CameraSettings-1:0] CameraSettingMasks = {
    32'h0000ffff, 32'h0000ffff, 32'h0000ffff, 32'h00000fff, 32'h1fff1fff, 32'h1fff1fff
  };
  localparam logic [32*CameraSettings-1:0] CameraSettingResets = {
    32'h00000000, 32'h00000000, 32'h00000000, 32'h00000000, 32'h00000000, 32'h00000000
  };

  // Offsets that can be read, and those that can be written.
  function automatic logic is_camera_register(input logic [31:0] offset);
    case (offset)
      CameraPictureOffset, CameraWindowOffset, CameraWindowSizeOffset, CameraFormatOffset,
      CameraBlackLevelOffset, CameraRedGainOffset, CameraGreenGainOffset, CameraBlueGainOffset,
      CameraStatusOffset, CameraControlOffset, CameraDroppedOffset, CameraLostOffset,
      CameraSetupOffset, CameraArrivedOffset: is_camera_register = 1'b1;
      default: is_camera_register = 1'b0;
    endcase
  endfunction
  function automatic logic is_camera_writable(input logic [31:0] offset);
    case (offset)
      CameraPictureOffset, CameraWindowOffset, CameraBlackLevelOffset, CameraRedGainOffset,
      CameraGreenGainOffset, CameraBlueGainOffset, CameraStatusOffset, CameraControlOffset: is_camera_writable = 1'b1;
      default: is_camera_writable = 1'b0;
    endcase
  endfunction

  // Of a pixel format: bits of a sample, words of a pixel, 1 for a Bayer pattern, 1 for YUYV.
  function automatic int format_bits(input int pixel_format);
    case (pixel_format)
      CameraFormatYuyv, CameraFormatYuyvBytes, CameraFormatRaw10, CameraFormatRaw10Lsb: format_bits = 10;
      CameraFormatRaw12, CameraFormatRaw12Lsb: format_bits = 12;
      default: format_bits = 8;
    endcase
  endfunction
  function automatic int format_words(input int pixel_format);
    case (pixel_format)
      CameraFormatRgb565Bytes, CameraFormatYuyvBytes: format_words = 2;
      default: format_words = 1;
    endcase
  endfunction
  function automatic int format_is_bayer(input int pixel_format);
    case (pixel_format)
      CameraFormatRaw8, CameraFormatRaw10, CameraFormatRaw10Lsb, CameraFormatRaw12, CameraFormatRaw12Lsb:
      format_is_bayer = 1;
      default: format_is_bayer = 0;
    endcase
  endfunction
  function automatic int format_is_yuyv(input int pixel_format);
    case (pixel_format)
      CameraFormatYuyv, CameraFormatYuyvBytes: format_is_yuyv = 1;
      default: format_is_yuyv = 0;
    endcase
  endfunction

  // Coefficients of BT.601, full range, in units of 2^-12.
  localparam int RedCr = 5743;
  localparam int GreenCb = -1410;
  localparam int GreenCr = -2925;
  localparam int BlueCb = 7258;

endpackage

`default_nettype wire
