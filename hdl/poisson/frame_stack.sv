// SPDX-License-Identifier: Apache-2.0
// frame_stack: rows of a frame in, last row first out, through one memory that holds a frame.
//
// Stream in: bursts of Size words, Rows of them a frame, gaps between bursts anywhere; rows count from a frame's start.
// Stream out: Rows bursts without a pause. Latency: 3 cycles from the first word of the last row to the first word out;
// nothing need follow, the reader runs by itself.
//
// The last row goes past the memory. In place: while row Rows - 1 - r of a frame is read, row r of the next frame
// cannot have begun; it is written into the freed place. So the writer of a frame goes the way that the reader of the
// frame before goes: rows upwards and downwards in turn.
//
// WordsPerRow words lie side by side in a row of the memory, collected before the write and taken apart after the read.
// Where Size is no multiple of it the first row of a burst has fewer, so that a burst ends with a full one.
// Bit-accurate model: models/tactile_depth/poisson/frame_stack.py.

module frame_stack #(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Size        = 128,
  parameter int WordsPerRow = 1,
  parameter int Style       = 1   // of the memory, hdl/common/ram.sv
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_start,
  input  logic             in_frame_start,   // with in_start: the first burst of a frame
  input  logic [Width-1:0] in_data,
  output logic             out_start,
  output logic             out_frame_start,
  output logic [Width-1:0] out_data
);

  localparam int PositionWidth = $clog2(Size);
  localparam int Burst = (Size + WordsPerRow - 1) / WordsPerRow;  // memory rows of a burst
  localparam int Depth = Rows * Burst;
  localparam int AddressWidth = $clog2(Depth);
  localparam int Top = Depth - Burst;  // the first memory row of the uppermost burst
  localparam int LeftWidth = WordsPerRow > 1 ? $clog2(WordsPerRow) : 1;
  localparam int Kept = WordsPerRow > 2 ? WordsPerRow - 1 : 1;
  localparam logic [PositionWidth-1:0] LastPosition = PositionWidth'(Size - 1);
  // Words of a memory row that are still to come: of a burst's first, and of any other.
  localparam logic [LeftWidth-1:0] FirstLeft = LeftWidth'((Size - 1) % WordsPerRow);
  localparam logic [LeftWidth-1:0] FullLeft = LeftWidth'(WordsPerRow - 1);

  function automatic logic [LeftWidth-1:0] left_after(input logic [LeftWidth-1:0] left);
    left_after = left == '0 ? FullLeft : left - LeftWidth'(1);
  endfunction

  function automatic logic [Width-1:0] word_of(
    input logic [WordsPerRow*Width-1:0] words, input logic [LeftWidth-1:0] left
  );
    word_of = words[Width-1:0];
    for (int word = 1; word < WordsPerRow; word++) begin
      if (left == LeftWidth'(word)) word_of = words[word*Width+:Width];
    end
  endfunction

  // The way of the reader, and of the writer until its last row begins: from the uppermost burst down, or up from 0.
  logic down;
  function automatic logic [AddressWidth-1:0] address_after(
    input logic [AddressWidth-1:0] address, input logic last_of_burst, input logic downwards
  );
    address_after = address + (last_of_burst & downwards ? AddressWidth'(1 - 2 * Burst) : AddressWidth'(1));
  endfunction

  // Writer.
  logic [PositionWidth-1:0] write_position;
  logic [LeftWidth-1:0] write_left, write_left_q;
  logic [AddressWidth-1:0] write_address, write_address_q;
  logic write_active, write_end, write_last_q, write_row;
  logic [Kept*Width-1:0] kept;  // words before in_data, the latest in the lowest bits
  burst_counter #(.Size(Size)) u_write (
    .clk, .rst, .en, .start(in_start), .position(write_position), .active(write_active)
  );
  assign write_end = write_active & (write_position == LastPosition);
  assign write_left = in_start ? FirstLeft : write_left_q;
  assign write_row = write_active & (write_left == '0);
  assign write_address = in_frame_start ? (down ? AddressWidth'(Top) : '0) : write_address_q;

  // Reader. Its first burst is the last row, which needs no memory.
  logic [PositionWidth-1:0] read_position;
  logic [LeftWidth-1:0] read_left, read_left_q, read_left_q2;
  logic [AddressWidth-1:0] read_address;
  logic read_begin, read_more, read_start, read_active, read_end, read_past, read_past_q, read_past_q2, read_last;
  logic start_q, start_q2, frame_start_q, frame_start_q2, read_past_q3;
  logic [Width-1:0] kept_q, word_q;  // the word that is read stands in a register before it goes on
  logic [WordsPerRow*Width-1:0] read_data;
  burst_counter #(.Size(Size)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );
  assign read_begin = in_start & ~in_frame_start & write_last_q;
  assign read_start = read_begin | read_more;
  assign read_past = read_begin | read_past_q;
  assign read_left = read_start ? FirstLeft : read_left_q;
  assign read_end = read_active & (read_position == LastPosition);
  assign read_last = read_address == (down ? AddressWidth'(Burst - 1) : AddressWidth'(Depth - 1));

  ram #(.Width(WordsPerRow * Width), .Depth(Depth), .Style(Style)) u_ram (
    .clk,
    .write_en     (en & write_row),
    .write_address(write_address),
    .write_data   ((WordsPerRow * Width)'({kept, in_data})),
    .read_en      (en & read_active & ~read_past & (read_start | (read_left == FullLeft))),
    .read_address (read_address),
    .read_data    (read_data)
  );

  always_ff @(posedge clk) begin
    if (en) begin
      kept <= (Kept * Width)'({kept, in_data});
      write_left_q <= left_after(write_left);
      write_address_q <= write_row ? address_after(write_address, write_end, down) : write_address;
      if (write_end) begin  // of the row before the last
        write_last_q <= write_address == (down ? AddressWidth'(2 * Burst - 1) : AddressWidth'(Top - 1));
      end
      read_more <= read_end & (read_past | ~read_last);
      down <= down ^ read_begin;
      read_past_q <= read_past & ~read_end;
      read_left_q <= left_after(read_left);
      if (read_begin) read_address <= down ? AddressWidth'(Burst) : AddressWidth'(Top - Burst);
      else if (~read_past_q & read_active & read_left == '0) begin
        read_address <= address_after(read_address, read_end, down);
      end
      start_q <= read_start;
      frame_start_q <= read_begin;
      read_past_q2 <= read_past;
      read_left_q2 <= read_left;
      start_q2 <= start_q;
      frame_start_q2 <= frame_start_q;
      read_past_q3 <= read_past_q2;
      kept_q <= kept[Width-1:0];
      word_q <= word_of(read_data, read_left_q2);
      out_start <= start_q2;
      out_frame_start <= frame_start_q2;
      out_data <= read_past_q3 ? kept_q : word_q;
    end
    if (rst) begin
      read_more <= 1'b0;
      down <= 1'b0;
      start_q <= 1'b0;
      frame_start_q <= 1'b0;
      start_q2 <= 1'b0;
      frame_start_q2 <= 1'b0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial begin
    if (Size < 2) $fatal(1, "%m: Size must be at least 2");
    if (Rows < 2) $fatal(1, "%m: Rows must be at least 2");
    if (WordsPerRow < 1) $fatal(1, "%m: WordsPerRow must be at least 1");
  end
`endif

endmodule
