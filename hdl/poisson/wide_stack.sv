// SPDX-License-Identifier: Apache-2.0
// wide_stack: rows of a frame in, a few words a clock; last row first out, more words a clock, in pairs of rows.
//
// Stream in: bursts of Columns / InWords clocks, Rows of them a frame, any gaps between bursts; a start comes 2 clocks
// before the first words. With each row come its own words, which count in the last row, and those of the row above.
// Stream out: pairs of rows without a pause, the last row first, each row Beats = Columns / OutWords clocks; a start
// comes 6 clocks before the first words of a pair. Latency: Columns / InWords - Beats / 2 + 2 clocks from the first
// words of the last row in to its first words out; nothing need follow. Rows come at least as slowly as they leave.
//
// Beat u of a row has two blocks of OutWords / 2 positions: block 2 u in the lower words, and in the upper words block
// 2 mirror(u) + 1, where mirror inverts all bits below the leading one: so mode k and mode N - k leave together. With
// an odd number of rows the last pair is a row alone; what leaves behind it has no meaning.
//
// In place: the reader is always ahead of the writer of the next frame, which goes the way that the reader goes, up and
// down in turn. The last row has a memory of its own. Only beats of the upper half of a row need its last words, so the
// reader begins half a row before these. Bit-accurate model: models/tactile_depth/chip/poisson/wide_stack.py.

`default_nettype none

module wide_stack #(
  parameter int Width    = 24,
  parameter int Rows     = 128,
  parameter int Columns  = 128,
  parameter int InWords  = 2,  // a power of two up to Columns / 8
  parameter int OutWords = 8,  // a power of two, InWords to Columns / 2
  parameter int Style    = 1  // of the memory, hdl/common/td_ram.sv
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      en,
  input  wire                      in_start,         // 2 clocks before the first words
  input  wire                      in_frame_start,   // with in_start: the first burst of a frame
  input  wire  [InWords*Width-1:0] in_last,          // words of any format; those of the last row count
  input  wire  [InWords*Width-1:0] in_ahead,         // of the row above
  output logic                     out_start,        // 6 clocks before the first words of a pair
  output logic                     out_frame_start,
  output logic                     out_alone,        // with out_start: the pair is one row
  output logic [OutWords*Width-1:0] out_data
);

  localparam int Clocks = Columns / InWords;
  localparam int Beats = Columns / OutWords;
  // A memory holds the words of a clock, or those of them that are in one block.
  localparam int Group = 2 * InWords > OutWords ? OutWords / 2 : InWords;
  localparam int Groups = OutWords / Group;
  localparam int Pairs = (Rows + 1) / 2;
  localparam int ClockWidth = $clog2(Clocks);
  localparam int BeatWidth = $clog2(Beats);
  localparam int GroupWidth = $clog2(OutWords / InWords);
  localparam int RowWidth = $clog2(Rows + 1);
  localparam int SlotWidth = Rows > 2 ? $clog2(Rows - 1) : 1;
  localparam int PairWidth = $clog2(Pairs + 1);
  localparam int Lead = 6;
  localparam int ToRead = Lead - 2;  // clocks from out_start to the read of the first words
  localparam logic [SlotWidth-1:0] TopSlot = SlotWidth'(Rows - 2);

  function automatic logic [BeatWidth-1:0] mirror(input logic [BeatWidth-1:0] beat);
    mirror = beat;
    for (int b = 0; b < BeatWidth - 1; b++) begin
      if (|(beat >> (b + 1))) mirror[b] = ~beat[b];
    end
  endfunction

  // The way of the writer through the rows: from row 0 in slot 0 up, or from row 0 in the top slot down.
  logic down;

  // Writer: a group a clock. Everything follows the start by 2 clocks, as the words do.
  logic [ClockWidth-1:0] position;
  logic active, burst_end, first_row, last_row;
  logic [RowWidth-1:0] row, row_q;
  logic [SlotWidth-1:0] slot, slot_q;  // of the row above
  td_burst_counter #(.Words(Clocks)) u_write (
    .clk, .rst, .en, .start(in_start), .position, .active
  );
  assign row = in_frame_start ? '0 : row_q;
  assign first_row = row == '0;
  assign last_row = row == RowWidth'(Rows - 1);  // behind it no row counts until a frame begins
  assign slot = in_start & (row == RowWidth'(1)) ? (down ? TopSlot : '0) : slot_q;
  assign burst_end = active & (position == ClockWidth'(Clocks - 1));

  // The position in a row: pair of blocks, block of the pair, words in the block; the last two choose the memory. A
  // clock that has words of both blocks writes two memories.
  logic [BeatWidth-1:0] block_pair;
  logic [1:0][BeatWidth-1:0] even_q, odd_q;  // beat of the pair's first block, and of its second one
  wire [Groups-1:0] chosen;
  logic [1:0][Groups-1:0] chosen_q;
  assign block_pair = position[ClockWidth-1-:BeatWidth];
  for (genvar g = 0; g < Groups; g++) begin : g_chosen
    if (Group < InWords) begin : g_always
      assign chosen[g] = 1'b1;
    end else begin : g_in_turn
      assign chosen[g] = position[GroupWidth-1:0] == GroupWidth'(g);
    end
  end

  logic [1:0][SlotWidth-1:0] write_slot_q;
  logic [1:0] write_last_q, write_ahead_q;
  logic begins;  // the reader begins
  assign begins = active & last_row & (position == ClockWidth'(Clocks - 3 - Beats / 2));
  always_ff @(posedge clk) begin
    if (en) begin
      row_q <= row + RowWidth'(burst_end & (row != RowWidth'(Rows)));
      slot_q <= !burst_end | first_row ? slot : down ? slot - SlotWidth'(1) : slot + SlotWidth'(1);
      even_q <= {even_q[0], block_pair};
      odd_q <= {odd_q[0], mirror(block_pair)};
      chosen_q <= {chosen_q[0], chosen};
      write_slot_q <= {write_slot_q[0], slot};
      write_last_q <= {write_last_q[0], active & last_row};
      write_ahead_q <= {write_ahead_q[0], active & ~first_row & (row != RowWidth'(Rows))};
    end
    if (rst) {write_last_q, write_ahead_q} <= '0;
  end

  // Reader: starts of the pairs, and behind them the reads.
  logic [PairWidth-1:0] pair;  // that are still to begin
  logic starts_active, pair_end, read_active;
  logic [BeatWidth:0] start_time, read_time;  // in a pair
  logic [ToRead-1:0] start_q, frame_start_q, alone_q;
  td_burst_counter #(.Words(2 * Beats)) u_starts (
    .clk, .rst, .en, .start(out_start), .position(start_time), .active(starts_active)
  );
  td_burst_counter #(.Words(2 * Beats)) u_read (
    .clk, .rst, .en, .start(start_q[ToRead-1]), .position(read_time), .active(read_active)
  );
  assign pair_end = starts_active & (start_time == (BeatWidth + 1)'(2 * Beats - 1));

  logic first_pair, first_pair_q, alone, alone_now, reads_down, from_last, read_row;
  logic [SlotWidth-1:0] read_slot, read_slot_q;
  assign first_pair = start_q[ToRead-1] ? frame_start_q[ToRead-1] : first_pair_q;
  assign alone = start_q[ToRead-1] ? alone_q[ToRead-1] : alone_now;
  assign from_last = first_pair & ~read_time[BeatWidth];
  assign read_row = read_active & ~from_last & ~(alone & read_time[BeatWidth]);
  assign read_slot = start_q[ToRead-1] & frame_start_q[ToRead-1] ? (reads_down ? TopSlot : '0) : read_slot_q;

  always_ff @(posedge clk) begin
    if (en) begin
      out_start <= begins | (pair_end & (pair != '0));
      out_frame_start <= begins;
      out_alone <= Rows % 2 != 0 && !begins && pair == PairWidth'(1);
      if (begins) pair <= PairWidth'(Pairs - 1);
      else if (pair_end && pair != '0) pair <= pair - PairWidth'(1);
      start_q <= {start_q[ToRead-2:0], out_start};
      frame_start_q <= {frame_start_q[ToRead-2:0], out_frame_start};
      alone_q <= {alone_q[ToRead-2:0], out_alone};
      first_pair_q <= first_pair;
      alone_now <= alone;
      if (begins) begin
        down <= ~down;
        reads_down <= ~down;
      end
      // A frame that was written upwards is read from the top slot down.
      read_slot_q <= !read_row | (read_time[BeatWidth-1:0] != BeatWidth'(Beats - 1)) ? read_slot
          : reads_down ? read_slot - SlotWidth'(1) : read_slot + SlotWidth'(1);
    end
    if (rst) {down, pair, out_start, out_frame_start, out_alone, start_q, frame_start_q} <= '0;
  end

  logic from_last_q;
  always_ff @(posedge clk) if (en) from_last_q <= from_last;
  for (genvar g = 0; g < Groups; g++) begin : g_group
    localparam int First = Group < InWords ? g * Group : 0;  // of its words in a clock
    logic [Group*Width-1:0] last_word, word;
    logic [BeatWidth-1:0] write_beat;
    assign write_beat = 2 * g < Groups ? even_q[1] : odd_q[1];
    td_ram #(.Width(Group * Width), .Depth(Beats), .Style(0)) u_last (
      .clk,
      .write_en     (en & write_last_q[1] & chosen_q[1][g]),
      .write_address(write_beat),
      .write_data   (in_last[First*Width+:Group*Width]),
      .read_en      (en & read_active & from_last),
      .read_address (read_time[BeatWidth-1:0]),
      .read_data    (last_word)
    );
    td_ram #(.Width(Group * Width), .Depth((Rows - 1) * Beats), .Style(Style)) u_rows (
      .clk,
      .write_en     (en & write_ahead_q[1] & chosen_q[1][g]),
      .write_address({write_slot_q[1], write_beat}),
      .write_data   (in_ahead[First*Width+:Group*Width]),
      .read_en      (en & read_row),
      .read_address ({read_slot, read_time[BeatWidth-1:0]}),
      .read_data    (word)
    );
    always_ff @(posedge clk) begin
      if (en) out_data[g*Group*Width+:Group*Width] <= from_last_q ? last_word : word;
    end
  end

endmodule

`default_nettype wire
