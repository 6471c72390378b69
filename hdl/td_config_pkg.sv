// SPDX-License-Identifier: Apache-2.0
// td_config_pkg: constants, parameters of the default configuration, and of options that it leaves out.
//
// Written by `make registers` from models/tactile_depth/configuration.py: change it there.

`default_nettype none

package td_config_pkg;

  localparam int GuardBits = 3;  // bits of the arithmetic below a stored word
  localparam int PolynomialWords = 36;  // of the quadratic model: slopes, colours, terms
  localparam int PolynomialWidth = 32;  // bits of such a word
  localparam int ColourCoeffWidth = 18;  // its upper bits, which are multiplied
  localparam int DeviationWidth = 14;  // bits of a colour relative to the reference
  localparam int DeviationFraction = 12;  // fraction bits of it
  localparam int CodeWidth = 8;  // bits of a colour that indexes the gradient table
  localparam int FlatCode = 128;  // code of a colour that equals the reference
  localparam int DarkestLog2 = 3;  // fraction bits of a gain beyond its width
  localparam int ZeroLog2 = 8;  // base-2 logarithm of the most frames in a capture of the zero offset

  localparam int DefaultSize = 128;
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
  localparam int DefaultFlatField = 0;
  localparam int DefaultQuadratic = 0;
  localparam int DefaultBlockLog2 = 3;
  localparam int DefaultColourDrop = 20;
  localparam int DefaultGainWidth = 24;
  localparam int DefaultCaptureLog2 = 8;
  localparam int DefaultSlopeDrop = 6;
  localparam int DefaultZeroOffset = 0;
  localparam int DefaultDepthMantissa = 9437184;
  localparam int DefaultDepthExponent = -41;
  localparam int DefaultSlopeMantissa = 8388608;
  localparam int DefaultSlopeExponent = -43;
  localparam int DefaultPitchNm = 0;
  localparam int DefaultTableWords = 1379;
  localparam int DefaultSettledWidth = 7;
  localparam int DefaultLastShiftWidth = 1;
  localparam int DefaultMomentDrop = 7;
  localparam int DefaultMeanReciprocal = 65536;
  localparam int DefaultMeanDrop = 16;
  localparam int DefaultWordsPerRow = 1;

endpackage

`default_nettype wire
