// SPDX-License-Identifier: Apache-2.0
// transpose: rows of a frame in, columns out, through one memory of exactly Columns x Columns words.
//
// Stream in: bursts of Columns words, Columns of them a frame, gaps between bursts anywhere; rows count from a frame's
// start. Stream out: Columns bursts without a pause, one a column. Starts of both come 2 cycles before the first word.
// Latency: 3 cycles from the first word of the last row to the first word of the first column; nothing need follow, the
// reader runs by itself.
//   MakhoulIn = 1:  the words of a row come in Makhoul order (0, 2, 4, .., 5, 3, 1)
//   MakhoulOut = 1: the words of a column leave in Makhoul order
//
// In place: column c of a frame is read in the Columns cycles before row c of the next frame can arrive, which is
// written into the positions just read. So rows and columns of the memory change roles from the frame read last. A
// column is read out wholly before the first word is written over it, so the order inside a column is free.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/transpose.py.

`default_nettype none

module transpose #(
  parameter int Width      = 24,
  parameter int Columns    = 128,  // a power of two, at least 4
  parameter int MakhoulIn  = 0,
  parameter int MakhoulOut = 1,
  parameter int Style      = 1,  // of the memory, hdl/common/td_ram.sv
  parameter int Parity     = 0  // 1: a parity bit in each word of a memory
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              en,
  input  wire              in_start,
  input  wire              in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Width-1:0] in_data,         // a word of any format, unchanged in out_data
  output logic             out_start,
  output logic             out_frame_start,
  output logic [Width-1:0] out_data,
  output logic             flipped   // a word that was read has a flipped bit
);

  localparam int IndexWidth = $clog2(Columns);

  function automatic logic [IndexWidth-1:0] makhoul(input logic [IndexWidth-1:0] p);
    makhoul = {p[IndexWidth-2:0] ^ {(IndexWidth - 1){p[IndexWidth-1]}}, p[IndexWidth-1]};
  endfunction

  // Starts with the words.
  logic [1:0] start_q, frame_start_q;
  logic start, frame_start;
  assign start = start_q[1];
  assign frame_start = frame_start_q[1];

  // Writer: row counts bursts, transposed says whether rows of this frame lie along the memory's columns.
  logic [IndexWidth-1:0] row, row_q, write_position, write_column;
  logic write_active, write_transposed, write_transposed_q, read_transposed, last_row_start;
  assign write_active = start | (write_position != '0);
  assign row = start & frame_start ? '0 : row_q;
  assign write_transposed = start & frame_start ? ~read_transposed : write_transposed_q;
  assign write_column = MakhoulIn != 0 ? makhoul(write_position) : write_position;
  assign last_row_start = start & (row == IndexWidth'(Columns - 1));

  // Reader: one burst of Columns^2 from the cycle after the last row begins. Both counters rest at 0.
  logic read_start, read_active;
  logic [2*IndexWidth-1:0] read_position;
  logic [IndexWidth-1:0] column, read_row;
  assign read_active = read_start | (read_position != '0);
  assign column = read_position[2*IndexWidth-1:IndexWidth];
  assign read_row = MakhoulOut != 0 ? makhoul(read_position[IndexWidth-1:0]) : read_position[IndexWidth-1:0];

  td_parity_ram #(.Width(Width), .Depth(Columns * Columns), .Style(Style), .Latency(2), .Parity(Parity)) u_ram (
    .clk, .en,
    .write_en     (en & write_active),
    .write_address(write_transposed ? {write_column, row} : {row, write_column}),
    .write_data   (in_data),
    .read_en      (en & read_active),
    .read_address (read_transposed ? {column, read_row} : {read_row, column}),
    .read_data    (out_data),
    .flipped
  );

  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[0], in_start};
      frame_start_q <= {frame_start_q[0], in_frame_start};
      if (write_active) write_position <= write_position + IndexWidth'(1);
      if (read_active) read_position <= read_position + (2 * IndexWidth)'(1);
      row_q <= row + IndexWidth'(write_active & (write_position == IndexWidth'(Columns - 1)));
      write_transposed_q <= write_transposed;
      if (last_row_start) read_transposed <= write_transposed;
      read_start <= last_row_start;
    end
    if (rst) {start_q, read_start, read_transposed, write_position, read_position} <= '0;
  end
  assign out_frame_start = read_start;
  assign out_start = read_active & (read_position[IndexWidth-1:0] == '0);

endmodule

`default_nettype wire
