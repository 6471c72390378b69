// SPDX-License-Identifier: Apache-2.0
// DP16KD: the block memory of an ECP5, as far as Yosys and commands/hardware/ecp5.py use it: written at port A, read at port
// B, words of 18 bits or, over both ports, of 36. Under OUTREG a register with an enable of its own is behind the words.
// Contents at power-up, resets and other widths are not modelled. To simulate netlists; not for synthesis.

module DP16KD #(
  parameter DATA_WIDTH_A        = 18,
  parameter DATA_WIDTH_B        = 18,
  parameter REGMODE_A           = "NOREG",
  parameter REGMODE_B           = "NOREG",
  parameter CLKAMUX             = "CLKA",
  parameter CLKBMUX             = "CLKB",
  parameter CSDECODE_A          = "0b000",
  parameter CSDECODE_B          = "0b000",
  parameter WRITEMODE_A         = "NORMAL",
  parameter WRITEMODE_B         = "NORMAL",
  parameter GSR                 = "ENABLED",
  parameter RESETMODE           = "SYNC",
  parameter ASYNC_RESET_RELEASE = "SYNC"
) (
  input  logic DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14, DIA15,
  input  logic DIA16, DIA17,
  input  logic DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14, DIB15,
  input  logic DIB16, DIB17,
  input  logic ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
  input  logic ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
  input  logic CEA, OCEA, CLKA, WEA, RSTA, CSA0, CSA1, CSA2, CEB, OCEB, CLKB, WEB, RSTB, CSB0, CSB1, CSB2,
  output logic DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14, DOA15,
  output logic DOA16, DOA17,
  output logic DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14, DOB15,
  output logic DOB16, DOB17
);

  localparam Wide = DATA_WIDTH_A == 36;
  logic [35:0] words[1024];
  logic [35:0] word, word_q;
  logic [17:0] low, high;
  logic [9:0] write_address, read_address;
  assign low = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2,
    DIA1, DIA0};
  assign high = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2,
    DIB1, DIB0};
  assign write_address = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4 & ~Wide};
  assign read_address = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4 & ~Wide};

  // The lowest bits of the write address enable the bytes: here all or none.
  always_ff @(posedge CLKA) if (CEA & WEA & ADA0) words[write_address] <= {high, low};
  always_ff @(posedge CLKB) begin
    if (CEB & ~WEB) word <= words[read_address];
    if (OCEB) word_q <= word;
  end

  // A wide word has its lower half at port A.
  logic [35:0] out;
  assign out = REGMODE_B == "OUTREG" ? word_q : word;
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1,
    DOB0} = Wide ? out[35:18] : out[17:0];
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1,
    DOA0} = out[17:0];

endmodule
