// SPDX-License-Identifier: Apache-2.0
// td_config_pkg: parameters of the default configuration, and of options that it leaves out.
//
// Written by `make registers` from models/tactile_depth/configuration.py: change it there.

`default_nettype none

package td_config_pkg;

  localparam int DefaultSize = 128;
  localparam int DefaultWidth = 27;
  localparam int DefaultCoeffWidth = 18;
  localparam int DefaultDataWidth = 24;
  localparam int DefaultRowForwardOut = 3;
  localparam int DefaultColumnForwardIn = 1;
  localparam int DefaultColumnInverseOut = -1;
  localparam int DefaultRowInverseIn = -3;
  localparam int DefaultRowInverseOut = -1;
  localparam int DefaultStoreStyle = 1;
  localparam int DefaultDivideShiftWidth = 4;
  localparam int DefaultDivideDrop = 23;
  localparam int DefaultNeumann = 0;
  localparam int DefaultRows = 128;
  localparam int DefaultLanes = 1;
  localparam int DefaultTridiagonal = 0;
  localparam int DefaultBitsPerChannel = 4;
  localparam int DefaultGradientWidth = 21;
  localparam int DefaultGradientFraction = 20;
  localparam int DefaultFrameLatency = 17221;
  localparam int DefaultColourDrop = 20;
  localparam int DefaultColourOffset = 0;
  localparam int DefaultColourFlat = 128;
  localparam int DefaultFlatField = 0;
  localparam int DefaultQuadratic = 0;
  localparam int DefaultBlockLog2 = 3;
  localparam int DefaultGainWidth = 24;
  localparam int DefaultGainFraction = 27;
  localparam int DefaultColourWidth = 8;
  localparam int DefaultCaptureLog2 = 8;
  localparam int DefaultPolynomialWords = 36;
  localparam int DefaultPolynomialWidth = 32;
  localparam int DefaultColourCoeffWidth = 18;
  localparam int DefaultSlopeDrop = 6;
  localparam int DefaultZeroOffset = 0;
  localparam int DefaultDepthMantissa = 9437184;
  localparam int DefaultDepthExponent = -41;
  localparam int DefaultSlopeMantissa = 8388608;
  localparam int DefaultSlopeExponent = -43;
  localparam int DefaultPitchNm = 0;
  localparam int DefaultZeroLog2 = 8;
  localparam int DefaultStoreDrop = 3;
  localparam int DefaultTableWords = 1379;
  localparam int DefaultSettledWidth = 7;
  localparam int DefaultLastShiftWidth = 1;
  localparam int DefaultMomentDrop = 7;
  localparam int DefaultMeanReciprocal = 65536;
  localparam int DefaultMeanDrop = 16;
  localparam int DefaultWordsPerRow = 1;

endpackage

`default_nettype wire
