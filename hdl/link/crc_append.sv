// SPDX-License-Identifier: Apache-2.0
// crc_append: puts a CRC-32 behind each packet, low byte first.
//
// Stream in: bytes of kind and fields under valid and ready, last with the last of a packet; what is offered stays
// until it is taken. Stream out: the same bytes, then the four of the CRC over them, last with the last of these.
// Latency: bytes pass without a register; the CRC follows in the cycles behind the last byte, in which none is taken.
// Model: to_line of models/tactile_depth/chip/link/framing.py, before COBS.

`default_nettype none

module crc_append (
  input  wire         clk,
  input  wire         rst,
  input  wire         in_valid,
  output logic        in_ready,
  input  wire  [7:0]  in_data,
  input  wire         in_last,
  output logic        out_valid,
  input  wire         out_ready,
  output logic [7:0]  out_data,
  output logic        out_last
);

  import td_link_pkg::CrcStart;
  import td_link_pkg::crc32_step;

  logic appends;       // a byte of the CRC is offered
  logic [1:0] place;   // which
  logic [31:0] state;  // of the CRC; its next byte is the lowest
  logic leaves;
  assign leaves = out_valid & out_ready;
  assign in_ready = out_ready & ~appends;
  assign out_valid = in_valid | appends;
  assign out_data = appends ? ~state[7:0] : in_data;
  assign out_last = appends & place == 2'd3;

  always_ff @(posedge clk) begin
    if (leaves && !appends) begin
      state <= crc32_step(state, in_data);
      appends <= in_last;
    end
    if (leaves && appends) begin
      state <= {CrcStart[7:0], state[31:8]};  // behind the four bytes it is CrcStart
      appends <= ~out_last;
      place <= place + 2'd1;
    end
    if (rst) begin
      state <= CrcStart;
      appends <= 1'b0;
      place <= '0;
    end
  end

endmodule

`default_nettype wire
