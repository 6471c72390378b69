// SPDX-License-Identifier: Apache-2.0
// packet_check: takes the CRC-32 off a packet, and says whether it is right.
//
// Bytes in, then in_end without a byte. Out: the same bytes but the last 4, each when the fourth behind it has come;
// then out_end with out_good if the packet was not bad, had 5 bytes or more, and its CRC is right (td_link_pkg).
// Latency: 1 cycle. Cycle-accurate model: models/tactile_depth/chip/link/packet_check.py.

`default_nettype none

module packet_check
  import td_link_pkg::*;
(
  input  wire        clk,
  input  wire        rst,
  input  wire        in_valid,
  input  wire  [7:0] in_data,
  input  wire        in_end,    // without in_valid
  input  wire        in_bad,    // counts with in_end
  output logic       out_valid,
  output logic [7:0] out_data,
  output logic       out_end,   // without out_valid
  output logic       out_good   // counts with out_end
);

  localparam int CrcBytes = 4;
  localparam logic [2:0] Full = 3'd4;    // as many bytes as are held back
  localparam logic [2:0] Enough = 3'd5;

  logic [8*CrcBytes-1:0] held;  // the last bytes, the oldest on top
  logic [2:0] length;           // bytes that came; Enough stands for more
  logic [31:0] crc;             // state behind these bytes

  always_ff @(posedge clk) begin
    out_valid <= in_valid & (length >= Full);
    out_data <= held[8*CrcBytes-1:8*CrcBytes-8];
    out_end <= in_end;
    out_good <= ~in_bad & (length == Enough) & (crc == CrcResidue);
    if (in_valid) begin
      held <= {held[8*CrcBytes-9:0], in_data};
      crc <= crc32_step(crc, in_data);
      if (length != Enough) length <= length + 3'd1;
    end
    if (in_end || rst) begin
      crc <= CrcStart;
      length <= '0;
    end
    if (rst) begin
      out_valid <= 1'b0;
      out_end <= 1'b0;
    end
  end

endmodule

`default_nettype wire
