// SPDX-License-Identifier: Apache-2.0
// wide_stack_steps: helps the proof of fv_wide_stack to end. Says of each last row on its way, by the clocks since its
// start, where the writer and the reader of the core are, and that the word followed stands in its memory until it is
// read. All together follow from themselves in one clock, so induction ends.

`default_nettype none

module wide_stack_steps #(
  parameter int Width    = 1,
  parameter int Rows     = 3,
  parameter int Columns  = 16,
  parameter int InWords  = 2,
  parameter int OutWords = 4,
  parameter int ToStart  = 3,
  parameter int Longest  = 20,
  localparam int Clocks = Columns / InWords,
  localparam int Beats = Columns / OutWords,
  localparam int AgeWidth = $clog2(Longest),
  localparam int BeatWidth = $clog2(Beats),
  localparam int OutWidth = $clog2(OutWords),
  localparam int PositionWidth = $clog2(Clocks),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input logic                          clk,
  input logic                          rst,
  input logic                          en,
  input logic                          started,
  input logic                          in_start,
  input logic                          active,
  input logic [PositionWidth-1:0]      position,
  input logic [RowWidth-1:0]           row,
  input logic                          last_row,
  input logic [PositionWidth:0]        left,       // of the protocol: clocks of the burst that are to come,
  input logic [RowWidth-1:0]           next_row,   // the next burst's, 0 if a frame must begin,
  input logic [RowWidth-1:0]           burst_row,  // that of the burst,
  input logic [15:0]                   wait_left,  // clocks to the next frame
  input logic [1:0]                    start_q,
  input logic [1:0]                    frame_start_q,
  input logic [1:0]                    active_q,
  input logic [1:0][PositionWidth-1:0] position_q,
  input logic [1:0][RowWidth-1:0]      row_q,
  input logic [Longest-1:0]            closes,
  input logic                          of_last,
  input logic                          in_last_row,
  input logic [RowWidth-1:0]           with_row,
  input logic [PositionWidth-1:0]      at_position,
  input logic [RowWidth-1:0]           own_row,
  input logic [BeatWidth-1:0]          beat,
  input logic [OutWidth-1:0]           lane,
  input logic [AgeWidth-1:0]           read_age,
  input logic                          has_open,
  input logic                          due,
  input logic [1:0]                    reads_q,
  input logic [Width-1:0]              open,
  input logic [Width-1:0]              closed,
  input logic [Width-1:0]              expected
);

  localparam int Pairs = (Rows + 1) / 2;
  localparam int PairBeats = 2 * Beats;
  localparam int All = Pairs * PairBeats;
  localparam int Wait = All > Rows * Clocks ? All - Rows * Clocks : 0;
  localparam int Frame = Rows * Clocks + Wait;  // clocks from a last row to the next one, or more
  localparam int Start = ToStart - 1;  // n of closes[n] as the first pair begins
  localparam int Read = Start + 4;     // and as its first words are read
  localparam int Group = 2 * InWords > OutWords ? OutWords / 2 : InWords;
  localparam int Groups = OutWords / Group;
  localparam int SlotWidth = $clog2(Rows - 1);
  localparam logic [PositionWidth-1:0] LastPosition = PositionWidth'(Clocks - 1);

  function automatic logic [Longest-1:0] from_to(input int from, input int to);  // bits from .. to - 1
    from_to = '0;
    for (int n = 0; n < Longest; n++) from_to[n] = n >= from && n < to;
  endfunction
  // The first clock of each pair of a frame, or all others.
  function automatic logic [Longest-1:0] each_pair(input int from, input logic first);
    each_pair = '0;
    for (int n = 0; n < Longest; n++)
      each_pair[n] = n >= from && n < from + All && ((n - from) % PairBeats == 0) == first;
  endfunction
  function automatic logic [SlotWidth-1:0] slot(input logic down, input int of_row);
    return SlotWidth'(down ? Rows - 2 - of_row : of_row);
  endfunction

  // Ways through the rows: of the frame being written, from its row 1 on, and of the last one whose last row began.
  logic opened, writes_down, close_down, left_some, starting;
  assign left_some = left != '0;
  assign starting = (closes & from_to(0, Start)) != '0;  // the reader of the last one is still to begin
  always_ff @(posedge clk) begin
    if (en && in_start && row == RowWidth'(1)) {opened, writes_down} <= {1'b1, fv_wide_stack.dut.down};
    if (en && in_start && last_row) {opened, close_down} <= {1'b0, writes_down};
    if (rst) {opened, close_down} <= 2'b01;
  end

  always_comb begin
    if (started) begin
      in_range: assert (32'(left) < Clocks && 32'(next_row) < Rows);
      now: assert (fv_wide_stack.dut.active == active && (!active
          || (fv_wide_stack.dut.position == position && fv_wide_stack.dut.row == row)));
      count: assert (fv_wide_stack.dut.u_write.running == left_some && (!left_some
          || fv_wide_stack.dut.u_write.count == PositionWidth'((PositionWidth + 1)'(Clocks) - left)));
      if (left_some) burst: assert (32'(burst_row) < Rows && fv_wide_stack.dut.row_q == burst_row
          && next_row == (burst_row == RowWidth'(Rows - 1) ? '0 : burst_row + RowWidth'(1)));
      else if (next_row != '0) row_to_come: assert (fv_wide_stack.dut.row_q == next_row
          && burst_row == next_row - RowWidth'(1));
      left_behind: assert (left == (active_q[0] ? (PositionWidth + 1)'(Clocks - 1) - (PositionWidth + 1)'(position_q[0])
          : '0) && (!active_q[0] || row_q[0] == burst_row));
      if (active_q[1] && position_q[1] != LastPosition) goes_on: assert (active_q[0] && row_q[0] == row_q[1]
          && position_q[0] == position_q[1] + PositionWidth'(1));
      else if (active_q[0]) begins: assert (position_q[0] == '0
          && (!active_q[1] || row_q[0] == (frame_start_q[0] ? '0 : row_q[1] + RowWidth'(1))));
      else if (active_q[1]) ends: assert (burst_row == row_q[1]);

      ways: assert (opened ? writes_down == ~close_down : closes == '0 || writes_down == close_down);
      way_to_come: assert (fv_wide_stack.dut.down == (starting ? close_down : ~close_down));
      if (left_some && burst_row != '0) way_taken: assert (burst_row == RowWidth'(Rows - 1)
          ? closes[AgeWidth'(Clocks-1-32'(left))] : opened);
      if (!left_some && 32'(next_row) >= 2) way_goes_on: assert (opened);
      if (left_some && burst_row != '0)
        slot_now: assert (fv_wide_stack.dut.slot_q == slot(writes_down, 32'(burst_row) - 1));
      if (!left_some && 32'(next_row) >= 2)
        slot_to_come: assert (fv_wide_stack.dut.slot_q == slot(writes_down, 32'(next_row) - 1));

      starts_run: assert (fv_wide_stack.dut.u_starts.running == ((closes & each_pair(Start, 1'b0)) != '0));
      reads_run: assert (fv_wide_stack.dut.u_read.running == ((closes & each_pair(Read, 1'b0)) != '0));
      if ((closes & from_to(Start, Start + All)) == '0) no_pair: assert (fv_wide_stack.dut.pair == '0);
    end
  end

  for (genvar i = 0; i < 2; i++) begin : g_late
    always_comb begin
      if (started) begin
        late_starts: assert (start_q[i] == (active_q[i] & (position_q[i] == '0))
            && frame_start_q[i] == (start_q[i] & (row_q[i] == '0)));
        late_writes: assert (fv_wide_stack.dut.write_last_q[i] == (active_q[i] & (row_q[i] == RowWidth'(Rows - 1)))
            && fv_wide_stack.dut.write_ahead_q[i] == (active_q[i] & (row_q[i] != '0)));
        if (active_q[i]) begin
          late_beats: assert (32'(row_q[i]) < Rows
              && fv_wide_stack.dut.even_q[i] == position_q[i][PositionWidth-1-:BeatWidth]
              && fv_wide_stack.dut.odd_q[i] == fv_wide_stack.dut.mirror(position_q[i][PositionWidth-1-:BeatWidth]));
          for (int g = 0; g < Groups; g++)
            assert (fv_wide_stack.dut.chosen_q[i][g] == (Group < InWords || 32'(position_q[i]) % Groups == g));
          if (row_q[i] != '0) late_slot: assert (fv_wide_stack.dut.write_slot_q[i]
              == slot(writes_down, 32'(row_q[i]) - 1) && (row_q[i] == RowWidth'(Rows - 1)
              ? closes[AgeWidth'(32'(position_q[i])+i)] : opened || (closes & from_to(0, i)) != '0));
        end
      end
    end
  end

  for (genvar i = 0; i < 4; i++) begin : g_start
    always_comb begin
      if (started) begin
        pair_starts: assert (fv_wide_stack.dut.start_q[i] == ((closes & each_pair(Start + i + 1, 1'b1)) != '0)
            && fv_wide_stack.dut.frame_start_q[i] == closes[Start+i+1]);
        if (fv_wide_stack.dut.start_q[i]) pair_alone: assert (fv_wide_stack.dut.alone_q[i]
            == (Rows % 2 != 0 && closes[Start+i+1+(Pairs-1)*PairBeats]));
      end
    end
  end

  logic [OutWords*Width-1:0] last_entry, last_word, word;
  logic [1:0][OutWords*Width-1:0] entry;  // of a frame on the way up, on the way down
  for (genvar g = 0; g < Groups; g++) begin : g_group
    localparam int Low = g * Group * Width;
    assign last_entry[Low+:Group*Width] = fv_wide_stack.dut.g_group[g].u_last.g_distributed.words[beat];
    assign last_word[Low+:Group*Width] = fv_wide_stack.dut.g_group[g].last_word;
    assign word[Low+:Group*Width] = fv_wide_stack.dut.g_group[g].word;
    for (genvar down = 0; down < 2; down++) begin : g_way
      assign entry[down][Low+:Group*Width]
          = fv_wide_stack.dut.g_group[g].u_rows.g_block.words[{slot(1'(down), 32'(own_row)), beat}];
    end
  end

  logic [1:0] pending, later;  // the word followed is on its way into the memory, or the words behind it
  logic [31:0] since;
  for (genvar i = 0; i < 2; i++) begin : g_word
    assign pending[i] = active_q[i] & (row_q[i] == with_row) & (position_q[i] == at_position);
    assign later[i] = row_q[i] > with_row || (row_q[i] == with_row && position_q[i] > at_position);
  end
  assign since = in_last_row ? 32'(at_position) + 2 : Clocks + 1;

  // By the clocks since the start of a last row.
  for (genvar n = 0; n < Longest; n++) begin : g_age
    localparam int Time = n - Start;
    localparam int ReadTime = n - Read;
    localparam int ReadRow = ReadTime / Beats;
    logic down;
    assign down = close_down ^ ((closes & from_to(0, n)) != '0);
    always_comb begin
      if (started && closes[n]) begin
        apart: assert ((closes & from_to(n + 1, n + Frame)) == '0);
        if (n < Clocks - 1) in_last: assert (32'(left) == Clocks - 1 - n && burst_row == RowWidth'(Rows - 1));
        else if (left_some) writer: assert (32'(burst_row) * Clocks + 2 * Clocks - 32'(left) + Wait <= n + 1);
        else if (next_row != '0) writer_to_come: assert (32'(next_row) * Clocks + Clocks + Wait <= n + 1);
        if (n < 2 * Clocks + Wait) not_opened: assert (!opened);
        if (n + 1 < Clocks + Wait) waits: assert (32'(wait_left) >= Clocks + Wait - 1 - n);
        for (int i = 0; i < 2; i++) begin
          if (n >= i && n < Clocks + i)
            assert (active_q[i] && row_q[i] == RowWidth'(Rows - 1) && 32'(position_q[i]) == n - i);
          if (n >= Clocks + i && active_q[i])
            assert (32'(row_q[i]) * Clocks + 32'(position_q[i]) + Clocks + Wait <= n - i);
        end

        if (Time >= 0 && Time < All) pair_now: assert (32'(fv_wide_stack.dut.pair) == Pairs - 1 - Time / PairBeats
            && (Time % PairBeats == 0 || 32'(fv_wide_stack.dut.u_starts.count) == Time % PairBeats));
        if (Time >= 0 && (closes & from_to(Start, n)) == '0)
          reader_way: assert (fv_wide_stack.dut.reads_down == ~(close_down ^ starting));
        if (ReadTime > 0 && ReadTime < All && ReadTime % PairBeats != 0)
          reader: assert (32'(fv_wide_stack.dut.u_read.count) == ReadTime % PairBeats
              && fv_wide_stack.dut.first_pair_q == (ReadTime < PairBeats)
              && fv_wide_stack.dut.alone_now == (Rows % 2 != 0 && ReadTime / PairBeats == Pairs - 1));
        if (ReadTime > 0 && ReadRow < Rows)
          reader_slot: assert (fv_wide_stack.dut.read_slot_q == slot(down, Rows - 2 - (ReadRow > 0 ? ReadRow - 1 : 0)));

        // The word followed.
        if (n == 0) open_at_close: assert (in_last_row || has_open || pending[1]);
        if (n > 0 && n <= Clocks) open_to_close: assert (in_last_row || has_open);
        if (n <= 32'(read_age) && n >= since) waits_for_read: assert (due
            && (of_last ? last_entry[lane*Width+:Width] : entry[down][lane*Width+:Width]) == closed);
      end
    end
  end

  always_comb begin
    if (started) begin
      place: assert (with_row != '0 && 32'(with_row) < Rows && (!of_last || in_last_row));
      if (has_open) begin
        open_kept: assert (!in_last_row && entry[writes_down][lane*Width+:Width] == open);
        if (!frame_start_q[1]) writer_behind: assert (!active_q[1] || later[1]);
        if (frame_start_q == '0) writer_soon: assert ((!active_q[0] || later[0])
            && (left_some || next_row == '0 || next_row > with_row));
      end
      if (!in_last_row && (left_some ? later[0] || pending[0] : next_row > with_row))
        row_came: assert (has_open || pending != '0);
      if (due) of_close: assert ((closes & from_to(since, 32'(read_age) + 1)) != '0);
      reads_behind: assert (reads_q == {closes[read_age+AgeWidth'(2)], closes[read_age+AgeWidth'(1)]});
      if (reads_q[0]) word_read: assert (fv_wide_stack.dut.from_last_q == of_last
          && (of_last ? last_word[lane*Width+:Width] : word[lane*Width+:Width]) == expected);
    end
  end

endmodule

`default_nettype wire
