// SPDX-License-Identifier: Apache-2.0
// td_register_map_pkg: offsets, reset values and bits of the AXI4-Lite registers.
//
// Written by `make registers` from registers/tactile_depth.rdl: change it there.

`default_nettype none

package td_register_map_pkg;

  // Byte offsets.
  localparam int AddressWidth = 10;
  localparam int IdOffset = 32'h000;
  localparam int GridOffset = 32'h004;
  localparam int FormatOffset = 32'h008;
  localparam int ControlOffset = 32'h00c;
  localparam int StatusOffset = 32'h010;
  localparam int ThresholdOffset = 32'h014;
  localparam int TimeoutOffset = 32'h018;
  localparam int FramesInOffset = 32'h01c;
  localparam int FramesOutOffset = 32'h020;
  localparam int FramesDroppedOffset = 32'h024;
  localparam int SaturationsOffset = 32'h028;
  localparam int FirstDepthLatencyOffset = 32'h02c;
  localparam int TableSelectOffset = 32'h030;
  localparam int TableIndexOffset = 32'h034;
  localparam int TableHighOffset = 32'h038;
  localparam int TableLowOffset = 32'h03c;
  localparam int TableCommitOffset = 32'h040;
  localparam int TableSizeOffset = 32'h044;
  localparam int DarkLevelOffset = 32'h048;
  localparam int ReferenceCaptureOffset = 32'h04c;
  localparam int DarkPixelsOffset = 32'h050;
  localparam int DepthDroppedOffset = 32'h054;
  localparam int RecordsLostOffset = 32'h058;
  localparam int OffThresholdOffset = 32'h05c;
  localparam int MinimumAreaOffset = 32'h060;
  localparam int DebounceOffset = 32'h064;
  localparam int RecordEventOffset = 32'h068;
  localparam int RecordFrameOffset = 32'h06c;
  localparam int RecordTimeOffset = 32'h070;
  localparam int RecordPeakOffset = 32'h074;
  localparam int RecordPeakPositionOffset = 32'h078;
  localparam int RecordAreaThresholdOffset = 32'h07c;
  localparam int RecordAreaOffset = 32'h080;
  localparam int RecordLeastOffset = 32'h084;
  localparam int RecordGreatestOffset = 32'h088;
  localparam int RecordWeightLowOffset = 32'h08c;
  localparam int RecordWeightHighOffset = 32'h090;
  localparam int RecordCentroidOffset = 32'h094;
  localparam int AreaThresholdOffset = 32'h098;
  localparam int ZeroCaptureOffset = 32'h09c;
  localparam int InterruptStatusOffset = 32'h0a0;
  localparam int InterruptMaskOffset = 32'h0a4;
  localparam int ArrivedOffset = 32'h0a8;
  localparam int RecordFlagsOffset = 32'h0ac;
  localparam int RecordLightOffset = 32'h0b0;
  localparam int RecordPixelsOffset = 32'h0b4;
  localparam int TableSignatureOffset = 32'h0b8;
  localparam int ArithmeticOffset = 32'h0bc;
  localparam int DeviceOffset = 32'h0c0;
  localparam int DepthUnitOffset = 32'h0c4;
  localparam int SlopeUnitOffset = 32'h0c8;
  localparam int PitchOffset = 32'h0cc;
  localparam int LightOffset = 32'h0d0;
  localparam int LightGainRedOffset = 32'h0d4;
  localparam int LightGainGreenOffset = 32'h0d8;
  localparam int LightGainBlueOffset = 32'h0dc;
  localparam int SelfTestOffset = 32'h0e0;
  localparam int SlopeLimitOffset = 32'h0e4;
  localparam int FlipsOffset = 32'h0e8;
  localparam int ResidualsOffset = 32'h0ec;
  localparam int LargestResidualOffset = 32'h0f0;
  localparam int ResidualBoundOffset = 32'h0f4;

  // Words of a record of contact, and their offsets, the first in the lowest bits.
  localparam int RecordWords = 15;
  localparam logic [32*RecordWords-1:0] RecordOffsets = {
    RecordPixelsOffset, RecordLightOffset, RecordFlagsOffset, RecordCentroidOffset, RecordWeightHighOffset,
    RecordWeightLowOffset, RecordGreatestOffset, RecordLeastOffset, RecordAreaOffset, RecordAreaThresholdOffset,
    RecordPeakPositionOffset, RecordPeakOffset, RecordTimeOffset, RecordFrameOffset, RecordEventOffset
  };

  // Values after reset that are not zero.
  localparam int IdReset = 32'h54444550;
  localparam int ThresholdReset = 32'h7fffffff;
  localparam int OffThresholdReset = 32'h7fffffff;
  localparam int MinimumAreaReset = 32'h00000001;
  localparam int DebounceReset = 32'h00000001;
  localparam int DeviceReset = 32'h01000000;
  localparam int LightReset = 32'h00000001;
  localparam int SlopeLimitReset = 32'h000000ff;

  // Bits: number of a flag, lowest of a wider field.
  localparam int GridRowsLsb = 0;
  localparam int GridColumnsLsb = 16;
  localparam int FormatDataWidthLsb = 0;
  localparam int FormatGradientWidthLsb = 8;
  localparam int FormatGradientFractionLsb = 16;
  localparam int FormatBitsPerChannelLsb = 24;
  localparam int ControlHoldContactBit = 0;
  localparam int ControlClearCountersBit = 1;
  localparam int ControlDropFramesBit = 2;
  localparam int ControlSelfTestBit = 3;
  localparam int StatusRowShortBit = 0;
  localparam int StatusRowLongBit = 1;
  localparam int StatusStartMissingBit = 2;
  localparam int StatusStartEarlyBit = 3;
  localparam int StatusTimeoutBit = 4;
  localparam int StatusSaturationBit = 5;
  localparam int StatusOutOfStepBit = 6;
  localparam int StatusDarkBit = 7;
  localparam int StatusBusyBit = 8;
  localparam int StatusContactBit = 9;
  localparam int StatusTouchingBit = 10;
  localparam int StatusDepthDroppedBit = 11;
  localparam int StatusHuntingBit = 12;
  localparam int StatusStalledBit = 13;
  localparam int StatusFlippedBit = 14;
  localparam int StatusResidualBit = 15;
  localparam int TableSelectSelectLsb = 0;
  localparam int TableSelectSelectWidth = 2;
  localparam int TableCommitGradientBit = 0;
  localparam int TableCommitCoefficientsBit = 1;
  localparam int TableCommitReferenceBit = 2;
  localparam int TableCommitZeroBit = 3;
  localparam int ReferenceCaptureLog2FramesLsb = 0;
  localparam int ReferenceCaptureStartBit = 8;
  localparam int ReferenceCaptureBusyBit = 9;
  localparam int ReferenceCaptureHeldBit = 10;
  localparam int ZeroCaptureLog2FramesLsb = 0;
  localparam int ZeroCaptureStartBit = 8;
  localparam int ZeroCaptureBusyBit = 9;
  localparam int ZeroCaptureHeldBit = 10;
  localparam int InterruptStatusRecordBit = 0;
  localparam int InterruptStatusFrameDroppedBit = 1;
  localparam int InterruptStatusFlippedBit = 2;
  localparam int InterruptStatusResidualBit = 3;
  localparam int InterruptMaskRecordBit = 0;
  localparam int InterruptMaskFrameDroppedBit = 1;
  localparam int InterruptMaskFlippedBit = 2;
  localparam int InterruptMaskResidualBit = 3;
  localparam int ArrivedRowsLsb = 0;
  localparam int ArrivedColumnsLsb = 16;
  localparam int DeviceSolverBit = 0;
  localparam int DeviceBoundaryBit = 1;
  localparam int DeviceGradientModelBit = 2;
  localparam int DeviceFlatFieldBit = 3;
  localparam int DeviceZeroOffsetBit = 4;
  localparam int DeviceLightGainsBit = 5;
  localparam int DeviceLanesLsb = 8;
  localparam int DeviceGainWidthLsb = 16;
  localparam int DeviceVersionLsb = 24;
  localparam int DepthUnitMantissaLsb = 0;
  localparam int DepthUnitExponentLsb = 24;
  localparam int SlopeUnitMantissaLsb = 0;
  localparam int SlopeUnitExponentLsb = 24;
  localparam int LightFollowBit = 0;
  localparam int LightRateLsb = 4;

  // Values of a field.
  localparam int TableSelectSelectCount = 4;
  localparam int TableSelectGradient = 0;
  localparam int TableSelectCoefficients = 1;
  localparam int TableSelectReference = 2;
  localparam int TableSelectZero = 3;
  localparam int DeviceSpectral = 0;
  localparam int DeviceTridiagonal = 1;
  localparam int DeviceDirichlet = 0;
  localparam int DeviceNeumann = 1;
  localparam int DeviceLut = 0;
  localparam int DevicePolynomials = 1;

  // Registers that software alone writes, by number, in words of 32 bits, the lowest first.
  localparam int Settings = 15;
  localparam int ControlSetting = 0;
  localparam int ThresholdSetting = 1;
  localparam int TimeoutSetting = 2;
  localparam int TableSelectSetting = 3;
  localparam int DarkLevelSetting = 4;
  localparam int ReferenceCaptureSetting = 5;
  localparam int OffThresholdSetting = 6;
  localparam int MinimumAreaSetting = 7;
  localparam int DebounceSetting = 8;
  localparam int AreaThresholdSetting = 9;
  localparam int ZeroCaptureSetting = 10;
  localparam int InterruptMaskSetting = 11;
  localparam int PitchSetting = 12;
  localparam int LightSetting = 13;
  localparam int SlopeLimitSetting = 14;
  localparam logic [32*Settings-1:0] SettingOffsets = {
    SlopeLimitOffset, LightOffset, PitchOffset, InterruptMaskOffset, ZeroCaptureOffset, AreaThresholdOffset,
    DebounceOffset, MinimumAreaOffset, OffThresholdOffset, ReferenceCaptureOffset, DarkLevelOffset,
    TableSelectOffset, TimeoutOffset, ThresholdOffset, ControlOffset
  };
  localparam logic [32*Settings-1:0] SettingMasks = {
    32'h000000ff, 32'h00000071, 32'hffffffff, 32'h0000000f, 32'h0000000f, 32'hffffffff, 32'h000000ff, 32'hffffffff,
    32'hffffffff, 32'h0000000f, 32'h000000ff, 32'h00000003, 32'hffffffff, 32'hffffffff, 32'h00000005
  };
  localparam logic [32*Settings-1:0] SettingResets = {
    32'h000000ff, 32'h00000001, 32'h00000000, 32'h00000000, 32'h00000000, 32'h00000000, 32'h00000001, 32'h00000001,
    32'h7fffffff, 32'h00000000, 32'h00000000, 32'h00000000, 32'h00000000, 32'h7fffffff, 32'h00000000
  };

  // Offsets that can be read, and those that can be written.
  function automatic logic is_register(input logic [31:0] offset);
    case (offset)
      IdOffset, GridOffset, FormatOffset, ControlOffset, StatusOffset, ThresholdOffset,
      TimeoutOffset, FramesInOffset, FramesOutOffset, FramesDroppedOffset, SaturationsOffset,
      FirstDepthLatencyOffset, TableSelectOffset, TableIndexOffset, TableHighOffset,
      TableLowOffset, TableCommitOffset, TableSizeOffset, DarkLevelOffset,
      ReferenceCaptureOffset, DarkPixelsOffset, DepthDroppedOffset, RecordsLostOffset,
      OffThresholdOffset, MinimumAreaOffset, DebounceOffset, RecordEventOffset,
      RecordFrameOffset, RecordTimeOffset, RecordPeakOffset, RecordPeakPositionOffset,
      RecordAreaThresholdOffset, RecordAreaOffset, RecordLeastOffset, RecordGreatestOffset,
      RecordWeightLowOffset, RecordWeightHighOffset, RecordCentroidOffset, AreaThresholdOffset,
      ZeroCaptureOffset, InterruptStatusOffset, InterruptMaskOffset, ArrivedOffset,
      RecordFlagsOffset, RecordLightOffset, RecordPixelsOffset, TableSignatureOffset,
      ArithmeticOffset, DeviceOffset, DepthUnitOffset, SlopeUnitOffset, PitchOffset,
      LightOffset, LightGainRedOffset, LightGainGreenOffset, LightGainBlueOffset,
      SelfTestOffset, SlopeLimitOffset, FlipsOffset, ResidualsOffset, LargestResidualOffset,
      ResidualBoundOffset: is_register = 1'b1;
      default: is_register = 1'b0;
    endcase
  endfunction
  function automatic logic is_writable(input logic [31:0] offset);
    case (offset)
      ControlOffset, StatusOffset, ThresholdOffset, TimeoutOffset, TableSelectOffset,
      TableIndexOffset, TableHighOffset, TableLowOffset, TableCommitOffset, DarkLevelOffset,
      ReferenceCaptureOffset, OffThresholdOffset, MinimumAreaOffset, DebounceOffset,
      AreaThresholdOffset, ZeroCaptureOffset, InterruptStatusOffset, InterruptMaskOffset,
      PitchOffset, LightOffset, LightGainRedOffset, LightGainGreenOffset, LightGainBlueOffset,
      SlopeLimitOffset: is_writable = 1'b1;
      default: is_writable = 1'b0;
    endcase
  endfunction

endpackage

`default_nettype wire
