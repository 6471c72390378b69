// SPDX-License-Identifier: Apache-2.0
// register_map_pkg: offsets, reset values and bits of the AXI4-Lite registers.
//
// Written by `python -m models.register_map` from models/register_map.py: change it there.

package register_map_pkg;

  // Byte offsets.
  parameter int AddressWidth = 7;
  parameter int IdOffset = 32'h00;
  parameter int GridOffset = 32'h04;
  parameter int FormatOffset = 32'h08;
  parameter int ControlOffset = 32'h0c;
  parameter int StatusOffset = 32'h10;
  parameter int ThresholdOffset = 32'h14;
  parameter int TimeoutOffset = 32'h18;
  parameter int FramesInOffset = 32'h1c;
  parameter int FramesOutOffset = 32'h20;
  parameter int FramesDroppedOffset = 32'h24;
  parameter int SaturationsOffset = 32'h28;
  parameter int FirstDepthLatencyOffset = 32'h2c;
  parameter int TableIndexOffset = 32'h30;
  parameter int TableGxOffset = 32'h34;
  parameter int TableGyOffset = 32'h38;

  // Values after reset that are not zero.
  parameter int IdReset = 32'h54444550;
  parameter int ThresholdReset = 32'h7fffffff;

  // Bits: number of a flag, lowest of a wider field.
  parameter int GridRowsLsb = 0;
  parameter int GridColumnsLsb = 16;
  parameter int FormatDataWidthLsb = 0;
  parameter int FormatGradientWidthLsb = 8;
  parameter int FormatGradientFractionLsb = 16;
  parameter int FormatBitsPerChannelLsb = 24;
  parameter int ControlHoldContactBit = 0;
  parameter int ControlClearCountersBit = 1;
  parameter int StatusRowShortBit = 0;
  parameter int StatusRowLongBit = 1;
  parameter int StatusStartMissingBit = 2;
  parameter int StatusStartEarlyBit = 3;
  parameter int StatusTimeoutBit = 4;
  parameter int StatusSaturationBit = 5;
  parameter int StatusOutOfStepBit = 6;
  parameter int StatusBusyBit = 8;
  parameter int StatusContactBit = 9;

endpackage
