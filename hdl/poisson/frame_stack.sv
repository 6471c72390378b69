// SPDX-License-Identifier: Apache-2.0
// frame_stack: rows of a frame in, last row first out, through one memory that holds a frame.
//
// Stream in: bursts of Columns words, Rows of them a frame, gaps between bursts anywhere; rows count from a frame's
// start. Stream out: the rows without a pause, the last row first. Latency: 3 cycles from the first word of the last
// row to the first word out; nothing need follow, the reader runs by itself.
//
// The last row goes past the memory. In place: while a row is read, the row of the next frame that takes its place
// cannot have begun. So the writer of a frame goes the way that the reader of the frame before goes: upwards and
// downwards in turn.
//
// WordsPerRow words lie side by side in a row of the memory, collected before the write and taken apart after the read.
// Where Columns is no multiple of it the first row of a burst has fewer, so that a burst ends with a full one.
// Bit-accurate model: models/tactile_depth/chip/poisson/frame_stack.py.

`default_nettype none

module frame_stack #(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int WordsPerRow = 1,
  parameter int Style       = 1  // of the memory, hdl/common/td_ram.sv
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    in_start,
  input  wire                    in_frame_start,   // with in_start: the first burst of a frame
  input  wire  [Width-1:0]       in_data,          // a word of any format, unchanged in out_data
  output logic                   out_start,
  output logic                   out_frame_start,  // with out_start: the first burst of a frame
  output logic [Width-1:0]       out_data
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int Burst = (Columns + WordsPerRow - 1) / WordsPerRow;  // memory rows of a burst
  localparam int Depth = Rows * Burst;
  localparam int AddressWidth = $clog2(Depth);
  localparam int Top = Depth - Burst;  // the first memory row of the uppermost burst
  // The last memory row of the row before the last one, by the way of the writer.
  localparam int BeforeLastUp = Top - 1;
  localparam int BeforeLastDown = 2 * Burst - 1;
  localparam int RemainingWidth = WordsPerRow > 1 ? $clog2(WordsPerRow) : 1;
  localparam int Kept = WordsPerRow > 2 ? WordsPerRow - 1 : 1;
  localparam logic [PositionWidth-1:0] LastPosition = PositionWidth'(Columns - 1);
  // Words of a memory row that are still to come: of a burst's first, and of any other.
  localparam logic [RemainingWidth-1:0] FirstRemaining = RemainingWidth'((Columns - 1) % WordsPerRow);
  localparam logic [RemainingWidth-1:0] FullRemaining = RemainingWidth'(WordsPerRow - 1);

  function automatic logic [RemainingWidth-1:0] remaining_after(input logic [RemainingWidth-1:0] remaining);
    remaining_after = remaining == '0 ? FullRemaining : remaining - RemainingWidth'(1);
  endfunction

  function automatic logic [Width-1:0] word_of(
    input logic [WordsPerRow*Width-1:0] words, input logic [RemainingWidth-1:0] remaining
  );
    word_of = words[Width-1:0];
    for (int word = 1; word < WordsPerRow; word++) begin
      if (remaining == RemainingWidth'(word)) word_of = words[word*Width+:Width];
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
  logic [RemainingWidth-1:0] write_remaining, write_remaining_q;
  logic [AddressWidth-1:0] write_address, write_address_q;
  logic write_active, write_end, write_last_q, write_row;
  logic [Kept*Width-1:0] kept;  // words before in_data, the latest in the lowest bits
  logic [Width-1:0] kept_q;
  td_burst_counter #(.Words(Columns)) u_write (
    .clk, .rst, .en, .start(in_start), .position(write_position), .active(write_active)
  );
  assign write_remaining = in_start ? FirstRemaining : write_remaining_q;
  assign write_row = write_active & (write_remaining == '0);
  assign write_address = in_frame_start ? (down ? AddressWidth'(Top) : '0) : write_address_q;

  wire read_begin;  // the last row begins
  assign read_begin = in_start & ~in_frame_start & write_last_q;

  always_ff @(posedge clk) begin
    if (en) begin
      kept <= (Kept * Width)'({kept, in_data});
      kept_q <= kept[Width-1:0];
      write_remaining_q <= remaining_after(write_remaining);
      write_address_q <= write_row ? address_after(write_address, write_end, down) : write_address;
      write_end <= write_active & (write_position == LastPosition - PositionWidth'(1));
      if (write_end) begin  // of the row before the last
        write_last_q <= write_address == (down ? AddressWidth'(BeforeLastDown) : AddressWidth'(BeforeLastUp));
      end
      down <= down ^ read_begin;
    end
    if (rst) {down, write_end} <= '0;
  end

  // Reader. The first burst is the last row, which needs no memory; as it begins, the second row is addressed.
  logic [PositionWidth-1:0] read_position;
  logic [RemainingWidth-1:0] read_remaining, read_remaining_q, word_remaining;  // word: of the word that is read
  logic [AddressWidth-1:0] read_address;
  logic read_more, read_start, read_active, read_end, read_past, read_first_q, read_last;
  logic [1:0] read_past_q, start_q, frame_start_q;
  logic [Width-1:0] word_q;  // the word that is read stands in a register before it goes on
  logic [WordsPerRow*Width-1:0] read_data;
  td_burst_counter #(.Words(Columns)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );
  assign read_start = read_begin | read_more;
  assign read_past = read_begin | read_first_q;
  assign read_remaining = read_start ? FirstRemaining : read_remaining_q;
  assign read_last = read_address == (down ? AddressWidth'(Burst - 1) : AddressWidth'(Depth - 1));

  td_ram #(.Width(WordsPerRow * Width), .Depth(Depth), .Style(Style)) u_ram (
    .clk,
    .write_en     (en & write_row),
    .write_address(write_address),
    .write_data   ((WordsPerRow * Width)'({kept, in_data})),
    .read_en      (en & read_active & ~read_past & (read_start | (read_remaining == FullRemaining))),
    .read_address (read_address),
    .read_data    (read_data)
  );

  always_ff @(posedge clk) begin
    if (en) begin
      read_end <= read_active & (read_position == LastPosition - PositionWidth'(1));
      read_more <= read_end & (read_past | ~read_last);
      read_first_q <= read_past & ~read_end;
      read_remaining_q <= remaining_after(read_remaining);
      if (read_begin) read_address <= down ? AddressWidth'(Burst) : AddressWidth'(Top - Burst);  // `down` turns now
      else if (~read_first_q & read_active & read_remaining == '0) begin
        read_address <= address_after(read_address, read_end, down);
      end
      start_q <= {start_q[0], read_start};
      frame_start_q <= {frame_start_q[0], read_begin};
      read_past_q <= {read_past_q[0], read_past};
      word_remaining <= read_remaining;
      word_q <= word_of(read_data, word_remaining);
      out_start <= start_q[1];
      out_frame_start <= frame_start_q[1];
      out_data <= read_past_q[1] ? kept_q : word_q;
    end
    if (rst) begin
      read_more <= 1'b0;
      read_end <= 1'b0;
      start_q <= '0;
      frame_start_q <= '0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end

endmodule

`default_nettype wire
