// SPDX-License-Identifier: Apache-2.0
// td_config_pkg: the configuration of a pipeline as one value, and constants that no configuration changes.
//
// Written by `make registers` from models/tactile_depth/chip/tactile_depth.py: change it there.

`default_nettype none

package td_config_pkg;

  localparam int GuardBits = 3;  // bits of the arithmetic below a stored word
  localparam int PolynomialWords = 60;  // of the polynomial models: slopes, colours, terms
  localparam int PolynomialWidth = 32;  // bits of such a word
  localparam int CorrectionWidth = 8;  // bits of a correction by colour
  localparam int ColourCoeffWidth = 18;  // its upper bits, which are multiplied
  localparam int DeviationWidth = 17;  // bits of a colour relative to the reference
  localparam int DeviationFraction = 15;  // fraction bits of it
  localparam int RatioWidth = 17;  // bits of a colour relative to the reference, before the light gains
  localparam int RatioFraction = 15;  // fraction bits of it
  localparam int LightGainWidth = 16;  // bits of a light gain, one bit less of them is fraction
  localparam int CodeWidth = 8;  // bits of a colour that indexes the gradient table
  localparam int FlatCode = 128;  // code of a colour that equals the reference
  localparam int DarkestLog2 = 3;  // fraction bits of a gain beyond its width
  localparam int ZeroLog2 = 8;  // base-2 logarithm of the most frames in a capture of the zero offset

  // A configuration is one vector: 32 bits for each number, by its field.
  localparam int ConfigBits = 2144;
  localparam int ColumnsField = 0;
  localparam int RowsField = 1;
  localparam int LanesField = 2;
  localparam int TridiagonalField = 3;
  localparam int CoeffWidthField = 4;
  localparam int DataWidthField = 5;
  localparam int RowForwardOutField = 6;
  localparam int ColumnForwardInField = 7;
  localparam int ColumnInverseOutField = 8;
  localparam int RowInverseInField = 9;
  localparam int RowInverseOutField = 10;
  localparam int StoreStyleField = 11;
  localparam int DivideShiftWidthField = 12;
  localparam int DivideDropField = 13;
  localparam int NeumannField = 14;
  localparam int BitsPerChannelField = 15;
  localparam int GradientWidthField = 16;
  localparam int GradientFractionField = 17;
  localparam int FrameLatencyField = 18;
  localparam int FlatFieldField = 19;
  localparam int PolynomialField = 20;
  localparam int LightGainsField = 21;
  localparam int CorrectionsField = 22;
  localparam int BlockLog2Field = 23;
  localparam int ColourDropField = 24;
  localparam int GainWidthField = 25;
  localparam int CaptureLog2Field = 26;
  localparam int SlopeDropField = 27;
  localparam int FineBitsField = 28;
  localparam int CorrectionUnitField = 29;
  localparam int ZeroOffsetField = 30;
  localparam int ParityField = 31;
  localparam int CheckDroppedField = 32;
  localparam int CheckInDroppedField = 33;
  localparam int CheckScaleField = 34;
  localparam int CheckScaleFractionField = 35;
  localparam int CheckSumWidthField = 36;
  localparam int ResidualBoundField = 37;
  localparam int DepthMantissaField = 38;
  localparam int DepthExponentField = 39;
  localparam int SlopeMantissaField = 40;
  localparam int SlopeExponentField = 41;
  localparam int PitchNmField = 42;
  localparam int DownWordsField = 43;
  localparam int DownTableWordsField = 44;
  localparam int DownSettledWidthField = 45;
  localparam int LastShiftWidthField = 46;
  localparam int UpTableWordsField = 47;
  localparam int UpSettledWidthField = 48;
  localparam int MomentDropField = 49;
  localparam int MeanReciprocalField = 50;
  localparam int MeanDropField = 51;
  localparam int WordsPerRowField = 52;
  localparam int CameraField = 53;
  localparam int CameraNumeratorField = 54;
  localparam int CameraDenominatorField = 55;
  localparam int CameraFormatField = 56;
  localparam int CameraPhaseField = 57;
  localparam int CameraPictureColumnsField = 58;
  localparam int CameraPictureRowsField = 59;
  localparam int CameraWindowXField = 60;
  localparam int CameraWindowYField = 61;
  localparam int CameraBlackLevelField = 62;
  localparam int CameraRedGainField = 63;
  localparam int CameraGreenGainField = 64;
  localparam int CameraBlueGainField = 65;
  localparam int TablesCrcField = 66;

  // The default configuration; options that it leaves out have the numbers of a configuration with the option.
  localparam logic [ConfigBits-1:0] DefaultConfig = {
    32'd0,  // TablesCrc
    32'd4096,  // CameraBlueGain
    32'd4096,  // CameraGreenGain
    32'd4096,  // CameraRedGain
    32'd0,  // CameraBlackLevel
    32'd0,  // CameraWindowY
    32'd80,  // CameraWindowX
    32'd480,  // CameraPictureRows
    32'd640,  // CameraPictureColumns
    32'd0,  // CameraPhase
    32'd6,  // CameraFormat
    32'd4,  // CameraDenominator
    32'd15,  // CameraNumerator
    32'd0,  // Camera
    32'd1,  // WordsPerRow
    32'd16,  // MeanDrop
    32'd65536,  // MeanReciprocal
    32'd7,  // MomentDrop
    32'd6,  // UpSettledWidth
    32'd777,  // UpTableWords
    32'd1,  // LastShiftWidth
    32'd7,  // DownSettledWidth
    32'd1379,  // DownTableWords
    32'd1,  // DownWords
    32'd0,  // PitchNm
    -32'sd43,  // SlopeExponent
    32'd8388608,  // SlopeMantissa
    -32'sd41,  // DepthExponent
    32'd9437184,  // DepthMantissa
    32'd0,  // ResidualBound
    32'd0,  // CheckSumWidth
    32'd0,  // CheckScaleFraction
    32'd0,  // CheckScale
    32'd0,  // CheckInDropped
    32'd0,  // CheckDropped
    32'd0,  // Parity
    32'd0,  // ZeroOffset
    32'd2097152,  // CorrectionUnit
    32'd4,  // FineBits
    32'd9,  // SlopeDrop
    32'd8,  // CaptureLog2
    32'd24,  // GainWidth
    32'd20,  // ColourDrop
    32'd3,  // BlockLog2
    32'd0,  // Corrections
    32'd0,  // LightGains
    32'd0,  // Polynomial
    32'd0,  // FlatField
    32'd17188,  // FrameLatency
    32'd20,  // GradientFraction
    32'd21,  // GradientWidth
    32'd4,  // BitsPerChannel
    32'd0,  // Neumann
    32'd23,  // DivideDrop
    32'd4,  // DivideShiftWidth
    32'd1,  // StoreStyle
    -32'sd1,  // RowInverseOut
    -32'sd3,  // RowInverseIn
    -32'sd1,  // ColumnInverseOut
    32'd1,  // ColumnForwardIn
    32'd3,  // RowForwardOut
    32'd24,  // DataWidth
    32'd18,  // CoeffWidth
    32'd0,  // Tridiagonal
    32'd1,  // Lanes
    32'd128,  // Rows
    32'd128  // Columns
  };

  // The fields that the register ARITHMETIC holds.
  localparam logic [ConfigBits/32-1:0] ArithmeticFields = 67'he43c07bfbf1fb;

  // Return the number in a field of a configuration.
  function automatic int value(input logic [ConfigBits-1:0] config_word, input int field);
    value = config_word[32*field+:32];
  endfunction

endpackage

`default_nettype wire
