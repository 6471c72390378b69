// SPDX-License-Identifier: Apache-2.0
// cobs_encode: packets as they are on the line: a zero byte, the packet without zero bytes (COBS), a zero byte.
//
// A packet, with one more zero behind it, is cut behind each zero, and behind Run bytes without one. A code goes before
// each piece: n + 1 before n bytes and a zero, which is left out; Run + 1 before Run bytes. If the packet ends with
// such Run bytes, nothing is sent for the zero behind it.
// Stream in: bytes under valid and ready, last with the last of a packet. It takes bytes until a piece is whole, then
// sends the piece. Stream out: bytes of the line under valid and ready. Memory: the bytes of a piece. Latency: the
// first byte is offered 1 cycle after the piece is whole; then a byte leaves in each cycle with ready.
// Cycle-accurate model: models/tactile_depth/chip/link/cobs_encode.py.

`default_nettype none

module cobs_encode #(
  parameter int Run = 254  // smaller ones are not COBS, but shorter to prove
) (
  input  wire         clk,
  input  wire         rst,
  input  wire         in_valid,
  output logic        in_ready,
  input  wire  [7:0]  in_data,
  input  wire         in_last,
  output logic        out_valid,
  input  wire         out_ready,
  output logic [7:0]  out_data
);

  localparam int PlaceWidth = $clog2(Run);
  localparam int CountWidth = $clog2(Run + 1);

  typedef enum logic [2:0] {Collect, Begin, Code, Bytes, End} state_e;

  state_e state, after_piece;
  logic begun;                   // the packet has begun on the line
  logic ends, empty_follows;      // behind the piece: the packet ends; an empty piece, since its last byte is a zero
  logic [CountWidth-1:0] count;   // bytes of the piece
  logic [CountWidth-1:0] place;   // of the byte to read next
  logic [7:0] stored;
  logic zero, whole, leaves, reads;
  assign zero = in_data == '0;
  assign whole = zero | in_last | count == CountWidth'(Run - 1);
  assign leaves = out_valid & out_ready;
  assign reads = leaves & (state == Code | state == Bytes) & place != count;
  assign after_piece = empty_follows ? Code : ends ? End : Collect;

  assign in_ready = state == Collect;
  assign out_valid = state != Collect;
  assign out_data = state == Code ? 8'(count) + 8'd1 : state == Bytes ? stored : '0;

  td_ram #(.Width(8), .Depth(1 << PlaceWidth), .Style((8 << PlaceWidth) > td_memory_pkg::LateBits ? 1 : 0)) u_piece (
    .clk, .write_en(in_valid & in_ready), .write_address(PlaceWidth'(count)), .write_data(in_data),
    .read_en(reads), .read_address(PlaceWidth'(place)), .read_data(stored)
  );

  always_ff @(posedge clk) begin
    place <= place + CountWidth'(reads);
    if (state == Collect && in_valid) begin
      count <= count + CountWidth'(!zero);
      ends <= in_last;
      empty_follows <= in_last & zero;
      if (whole) state <= begun ? Code : Begin;
    end
    if (leaves) begin
      begun <= state != End;
      if (state == Begin) begin
        state <= Code;
      end else if (state == End) begin
        state <= Collect;
      end else if (reads) begin
        state <= Bytes;
      end else begin
        state <= after_piece;
        {count, place} <= '0;
        empty_follows <= 1'b0;
      end
    end
    if (rst) begin
      state <= Collect;
      begun <= 1'b0;
      {count, place} <= '0;
    end
  end

endmodule

`default_nettype wire
