// SPDX-License-Identifier: Apache-2.0
// register_map_pkg: offsets, reset values and bits of the AXI4-Lite registers.
//
// Written by `make registers` from registers/tactile_depth.rdl: change it there.

package register_map_pkg;

  // Byte offsets.
  localparam int AddressWidth = 8;
  localparam int IdOffset = 32'h00;
  localparam int GridOffset = 32'h04;
  localparam int FormatOffset = 32'h08;
  localparam int ControlOffset = 32'h0c;
  localparam int StatusOffset = 32'h10;
  localparam int ThresholdOffset = 32'h14;
  localparam int TimeoutOffset = 32'h18;
  localparam int FramesInOffset = 32'h1c;
  localparam int FramesOutOffset = 32'h20;
  localparam int FramesDroppedOffset = 32'h24;
  localparam int SaturationsOffset = 32'h28;
  localparam int FirstDepthLatencyOffset = 32'h2c;
  localparam int TableSelectOffset = 32'h30;
  localparam int TableIndexOffset = 32'h34;
  localparam int TableHighOffset = 32'h38;
  localparam int TableLowOffset = 32'h3c;
  localparam int TableCommitOffset = 32'h40;
  localparam int TableSizeOffset = 32'h44;
  localparam int DarkLevelOffset = 32'h48;
  localparam int CaptureOffset = 32'h4c;
  localparam int DarkPixelsOffset = 32'h50;
  localparam int DepthDroppedOffset = 32'h54;
  localparam int RecordsLostOffset = 32'h58;
  localparam int OffThresholdOffset = 32'h5c;
  localparam int MinimumAreaOffset = 32'h60;
  localparam int DebounceOffset = 32'h64;
  localparam int RecordEventOffset = 32'h68;
  localparam int RecordFrameOffset = 32'h6c;
  localparam int RecordTimeOffset = 32'h70;
  localparam int RecordAreaOffset = 32'h74;
  localparam int RecordPeakOffset = 32'h78;
  localparam int RecordPeakPlaceOffset = 32'h7c;
  localparam int RecordLeastOffset = 32'h80;
  localparam int RecordGreatestOffset = 32'h84;
  localparam int RecordSumColumnsOffset = 32'h88;
  localparam int RecordSumRowsOffset = 32'h8c;
  localparam int RecordVolumeLowOffset = 32'h90;
  localparam int RecordVolumeHighOffset = 32'h94;
  localparam int RecordCentroidOffset = 32'h98;
  localparam int FloorCaptureOffset = 32'h9c;

  // Values after reset that are not zero.
  localparam int IdReset = 32'h54444550;
  localparam int ThresholdReset = 32'h7fffffff;
  localparam int OffThresholdReset = 32'h7fffffff;
  localparam int MinimumAreaReset = 32'h00000001;
  localparam int DebounceReset = 32'h00000001;

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
  localparam int TableSelectSelectLsb = 0;
  localparam int TableSelectSelectWidth = 2;
  localparam int TableCommitGradientBit = 0;
  localparam int TableCommitCoefficientsBit = 1;
  localparam int TableCommitReferenceBit = 2;
  localparam int TableCommitFloorBit = 3;
  localparam int CaptureLog2FramesLsb = 0;
  localparam int CaptureStartBit = 8;
  localparam int CaptureBusyBit = 9;
  localparam int FloorCaptureLog2FramesLsb = 0;
  localparam int FloorCaptureStartBit = 8;
  localparam int FloorCaptureBusyBit = 9;

  // Values of a field.
  localparam int TableSelectSelectCount = 4;
  localparam int TableSelectGradient = 0;
  localparam int TableSelectCoefficients = 1;
  localparam int TableSelectReference = 2;
  localparam int TableSelectFloor = 3;

endpackage
