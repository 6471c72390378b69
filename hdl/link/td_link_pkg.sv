// SPDX-License-Identifier: Apache-2.0
// td_link_pkg: kinds and sizes of the packets of the link, and its CRC-32. The protocol: docs/link.md.

`default_nettype none

package td_link_pkg;

  // First byte of a packet; 80 and more come from the device.
  localparam logic [7:0] Ask = 8'h01;
  localparam logic [7:0] Select = 8'h02;
  localparam logic [7:0] Read = 8'h03;
  localparam logic [7:0] Write = 8'h04;
  localparam logic [7:0] Picture = 8'h05;
  localparam logic [7:0] Status = 8'h81;
  localparam logic [7:0] ReadReply = 8'h83;
  localparam logic [7:0] WriteReply = 8'h84;
  localparam logic [7:0] Depth = 8'h90;  // plus the format
  localparam logic [7:0] Trailer = 8'h98;
  localparam logic [7:0] Record = 8'h99;

  localparam logic [7:0] Version = 8'd2;
  localparam int MostAccesses = 128;     // of registers, in a packet
  localparam int MostPixels = 256;       // in a packet
  localparam int ValuesAPacket = 256;    // of depth
  localparam int LongestPiece = 1398;    // bytes between two delimiters
  localparam int LargestShift = 16;

  // CRC-32 of IEEE 802.3, reflected. The state begins with CrcStart; a CRC is the inverted state, its low byte first;
  // behind data and CRC the state is CrcResidue.
  localparam logic [31:0] CrcStart = '1;
  localparam logic [31:0] CrcResidue = 32'hDEBB20E3;
  localparam logic [31:0] CrcPolynomial = 32'hEDB88320;

  function automatic logic [31:0] crc32_step(input logic [31:0] crc, input logic [7:0] data);
    logic [31:0] state;
    state = crc ^ {24'd0, data};
    for (int place = 0; place < 8; place++) state = (state >> 1) ^ (state[0] ? CrcPolynomial : 32'd0);
    return state;
  endfunction

endpackage

`default_nettype wire
