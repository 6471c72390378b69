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

  // Values after reset that are not zero.
  localparam int IdReset = 32'h54444550;
  localparam int ThresholdReset = 32'h7fffffff;

  // Bits: number of a flag, lowest of a wider field.
  localparam int GridRowsLsb = 0;
  localparam int GridColumnsLsb = 16;
  localparam int FormatDataWidthLsb = 0;
  localparam int FormatGradientWidthLsb = 8;
  localparam int FormatGradientFractionLsb = 16;
  localparam int FormatBitsPerChannelLsb = 24;
  localparam int ControlHoldContactBit = 0;
  localparam int ControlClearCountersBit = 1;
  localparam int StatusRowShortBit = 0;
  localparam int StatusRowLongBit = 1;
  localparam int StatusStartMissingBit = 2;
  localparam int StatusStartEarlyBit = 3;
  localparam int StatusTimeoutBit = 4;
  localparam int StatusSaturationBit = 5;
  localparam int StatusOutOfStepBit = 6;
  localparam int StatusBusyBit = 8;
  localparam int StatusContactBit = 9;
  localparam int TableSelectSelectLsb = 0;
  localparam int TableSelectSelectWidth = 2;
  localparam int TableCommitGradientBit = 0;
  localparam int TableCommitCoefficientsBit = 1;
  localparam int TableCommitReferenceBit = 2;

  // Values of a field.
  localparam int TableSelectSelectCount = 3;
  localparam int TableSelectGradient = 0;
  localparam int TableSelectCoefficients = 1;
  localparam int TableSelectReference = 2;

endpackage
