// SPDX-License-Identifier: Apache-2.0
// frame_stack: rows of a frame in, last row first out, through one memory that holds a frame, to one or more lanes.
//
// Stream in: bursts of Columns words, Rows of them a frame, gaps between bursts anywhere; rows count from a frame's
// start. Stream out: the rows in turn to the lanes, the last row to lane 0; every lane begins Columns / Lanes cycles
// after the lane before it and has its bursts without a pause. Latency: 3 cycles from the first word of the last row to
// the first word out of lane 0; nothing need follow, the readers run by themselves.
//
// Each lane has a bank of the memory, with all its rows. The last row goes past the memory. In place: while a row is
// read, the row of the next frame that takes its place cannot have begun. So the writer of a frame goes the way that
// the readers of the frame before go: upwards and downwards in a bank in turn.
//
// WordsPerRow words lie side by side in a row of the memory, collected before the write and taken apart after the read.
// Where Columns is no multiple of it the first row of a burst has fewer, so that a burst ends with a full one.
// Bit-accurate model: models/tactile_depth/poisson/frame_stack.py.

`default_nettype none

module frame_stack #(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Lanes       = 1,
  parameter int WordsPerRow = 1,
  parameter int Style       = 1  // of the memory, hdl/common/td_ram.sv
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    in_start,
  input  wire                    in_frame_start,   // with in_start: the first burst of a frame
  input  wire  [Width-1:0]       in_data,          // a word of any format, unchanged in out_data
  output logic [Lanes-1:0]       out_start,
  output logic [Lanes-1:0]       out_frame_start,  // with out_start: the first burst of a frame in this lane
  output logic [Lanes*Width-1:0] out_data
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int Step = Columns / Lanes;  // cycles from the start of a lane to that of the next one
  localparam int Levels = (Rows + Lanes - 1) / Lanes;  // bursts in a bank
  localparam int Burst = (Columns + WordsPerRow - 1) / WordsPerRow;  // memory rows of a burst
  localparam int Depth = Levels * Burst;
  localparam int AddressWidth = $clog2(Depth);
  localparam int BankWidth = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int Top = Depth - Burst;  // the first memory row of the uppermost burst
  // The last memory row of the row before the last one, by the way of the writer.
  localparam int BeforeLastUp = Lanes > 1 ? Depth - 1 : Top - 1;
  localparam int BeforeLastDown = Lanes > 1 ? Burst - 1 : 2 * Burst - 1;
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

  // The way of the readers, and of the writer until its last row begins: from the uppermost burst down, or up from 0.
  logic down;
  function automatic logic [AddressWidth-1:0] address_after(
    input logic [AddressWidth-1:0] address, input logic last_of_burst, input logic downwards
  );
    address_after = address + (last_of_burst & downwards ? AddressWidth'(1 - 2 * Burst) : AddressWidth'(1));
  endfunction

  // Writer. A row for each bank in turn, bank 0 the last; then the next burst of all banks.
  logic [PositionWidth-1:0] write_position;
  logic [RemainingWidth-1:0] write_remaining, write_remaining_q;
  logic [AddressWidth-1:0] write_address, write_address_q;
  logic [BankWidth-1:0] bank, bank_q;
  logic write_active, write_end, write_last_q, write_row;
  logic [Kept*Width-1:0] kept;  // words before in_data, the latest in the lowest bits
  logic [Width-1:0] kept_q;
  td_burst_counter #(.Words(Columns)) u_write (
    .clk, .rst, .en, .start(in_start), .position(write_position), .active(write_active)
  );
  assign write_remaining = in_start ? FirstRemaining : write_remaining_q;
  assign write_row = write_active & (write_remaining == '0);
  assign write_address = in_frame_start ? (down ? AddressWidth'(Top) : '0) : write_address_q;
  assign bank = Lanes == 1 ? '0 : in_frame_start ? BankWidth'((Rows - 1) % Lanes) : bank_q;

  wire [Lanes-1:0] read_begin;  // the first burst of a lane begins
  assign read_begin[0] = in_start & ~in_frame_start & write_last_q;

  always_ff @(posedge clk) begin
    if (en) begin
      kept <= (Kept * Width)'({kept, in_data});
      kept_q <= kept[Width-1:0];
      write_remaining_q <= remaining_after(write_remaining);
      if (!write_row) write_address_q <= write_address;
      else if (write_end && bank != '0) write_address_q <= write_address - AddressWidth'(Burst - 1);
      else write_address_q <= address_after(write_address, write_end, down);
      bank_q <= bank - BankWidth'(write_end);
      write_end <= write_active & (write_position == LastPosition - PositionWidth'(1));
      if (write_end) begin  // of the row before the last
        write_last_q <= write_address == (down ? AddressWidth'(BeforeLastDown) : AddressWidth'(BeforeLastUp))
            && (Lanes == 1 || bank == BankWidth'(1));
      end
      down <= down ^ read_begin[0];
    end
    if (rst) {down, write_end} <= '0;
  end

  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    localparam int Bursts = (Rows - lane + Lanes - 1) / Lanes;  // none in a lane beyond the rows

    // Reader. The first burst of lane 0 is the last row, which needs no memory.
    logic [PositionWidth-1:0] read_position;
    logic [RemainingWidth-1:0] read_remaining, read_remaining_q, word_remaining;  // word: of the word that is read
    logic [AddressWidth-1:0] read_address;
    logic read_more, read_start, read_active, read_end, read_first, read_first_q, read_past, read_last;
    logic [1:0] read_past_q, start_q, frame_start_q;
    logic [Width-1:0] word_q;  // the word that is read stands in a register before it goes on
    logic [WordsPerRow*Width-1:0] read_data;
    td_burst_counter #(.Words(Columns)) u_read (
      .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
    );
    assign read_start = read_begin[lane] | read_more;
    assign read_first = read_begin[lane] | read_first_q;
    assign read_past = lane == 0 ? read_first : 1'b0;
    assign read_remaining = read_start ? FirstRemaining : read_remaining_q;
    assign read_end = read_active & (read_position == LastPosition);
    assign read_last = read_address
        == (down ? AddressWidth'(Top - (Bursts - 1) * Burst + Burst - 1) : AddressWidth'(Bursts * Burst - 1));

    // A lane begins a step behind the one before it, with its address; lane 0 addresses its second row as it begins.
    logic begins_next;
    if (lane == 0) begin : g_first
      assign begins_next = read_begin[0];
    end else begin : g_behind
      logic begin_q;
      assign begins_next = g_lane[lane-1].read_first & g_lane[lane-1].read_active
          & (g_lane[lane-1].read_position == PositionWidth'(Step - 1)) & (lane < Rows);
      assign read_begin[lane] = begin_q;
      always_ff @(posedge clk) begin
        if (en) begin_q <= begins_next;
        if (rst) begin_q <= 1'b0;
      end
    end

    td_ram #(.Width(WordsPerRow * Width), .Depth(Depth), .Style(Style)) u_ram (
      .clk,
      .write_en     (en & write_row & (bank == BankWidth'(lane))),
      .write_address(write_address),
      .write_data   ((WordsPerRow * Width)'({kept, in_data})),
      .read_en      (en & read_active & ~read_past & (read_start | (read_remaining == FullRemaining))),
      .read_address (read_address),
      .read_data    (read_data)
    );

    always_ff @(posedge clk) begin
      if (en) begin
        read_more <= read_end & (read_past ? Bursts > 1 : ~read_last);
        read_first_q <= read_first & ~read_end;
        read_remaining_q <= remaining_after(read_remaining);
        if (begins_next) begin  // `down` turns as lane 0 begins
          if (lane == 0) read_address <= down ? AddressWidth'(Burst) : AddressWidth'(Top - Burst);
          else read_address <= down ? AddressWidth'(Top) : '0;
        end else if (~(lane == 0 & read_first_q) & read_active & read_remaining == '0) begin
          read_address <= address_after(read_address, read_end, down);
        end
        start_q <= {start_q[0], read_start};
        frame_start_q <= {frame_start_q[0], read_begin[lane]};
        read_past_q <= {read_past_q[0], read_past};
        word_remaining <= read_remaining;
        word_q <= word_of(read_data, word_remaining);
        out_start[lane] <= start_q[1];
        out_frame_start[lane] <= frame_start_q[1];
        out_data[lane*Width+:Width] <= read_past_q[1] ? kept_q : word_q;
      end
      if (rst) begin
        read_more <= 1'b0;
        start_q <= '0;
        frame_start_q <= '0;
        out_start[lane] <= 1'b0;
        out_frame_start[lane] <= 1'b0;
      end
    end
  end

  if (Columns < 2) begin : g_refused_0
    Columns_must_be_at_least_2 u_refused ();
  end
  if (Rows < 2) begin : g_refused_1
    Rows_must_be_at_least_2 u_refused ();
  end
  if (WordsPerRow < 1) begin : g_refused_2
    WordsPerRow_must_be_at_least_1 u_refused ();
  end
  if (Lanes < 1 || Lanes != (1 << $clog2(Lanes)) || Columns % Lanes != 0 || Columns / Lanes < 2) begin : g_refused_3
    Lanes_must_be_a_power_of_two_and_divide_Columns_into_steps_of_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
