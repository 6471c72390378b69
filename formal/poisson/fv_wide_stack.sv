// SPDX-License-Identifier: Apache-2.0
// fv_wide_stack: the word of an arbitrary place of every frame leaves unchanged in its beat and at its place of it, the
// last row first; the first words out Latency enabled clocks behind those of the last row, and no pause in a frame;
// starts, frame_start and alone 6 clocks before. Any gaps between bursts, any en, and frames that begin afresh.

parameter int Width = 1, Rows = 3, Columns = 16, InWords = 2, OutWords = 4;
localparam int InWidth = $clog2(InWords), PositionWidth = $clog2(Columns / InWords), RowWidth = $clog2(Rows + 1);
input logic choose_last;  // the word followed is one of in_last
input logic [RowWidth-1:0] choose_row;
input logic [PositionWidth-1:0] choose_position;
input logic [InWidth-1:0] choose_word;  // of a clock

localparam int OutWidth = $clog2(OutWords), Clocks = Columns / InWords, Beats = Columns / OutWords,
    Pairs = (Rows + 1) / 2, Latency = Clocks - Beats / 2 + 2;
localparam int ToStart = Latency + 2 - 6;  // clocks from the start of the last row to the first start
localparam int Longest = Latency + Pairs * 2 * Beats + 1;  // to the last word, and one more
localparam int AgeWidth = $clog2(Longest), BeatWidth = $clog2(Beats);

wire active = u_protocol.active, last_row = u_protocol.last_row;
wire [PositionWidth-1:0] position = u_protocol.position;
wire [RowWidth-1:0] row = u_protocol.row;

// All of the input as late as the words are, and the starts of last rows as late as anything that follows from them.
logic [1:0] start_q, frame_start_q, active_q;
logic [1:0][PositionWidth-1:0] position_q;
logic [1:0][RowWidth-1:0] row_q;
logic [Longest-1:0] closes;  // closes[n]: a last row began n + 1 enabled clocks ago
always_ff @(posedge clk) begin
  if (en) begin
    start_q <= {start_q[0], in_start};
    frame_start_q <= {frame_start_q[0], in_frame_start};
    active_q <= {active_q[0], active};
    position_q <= {position_q[0], position};
    row_q <= {row_q[0], row};
    closes <= {closes[Longest-2:0], in_start & last_row};
  end
  if (rst) begin
    start_q <= '0;
    frame_start_q <= '0;
    active_q <= '0;
    closes <= '0;
  end
end

// The word followed, the same in every frame: chosen in the first clock, then constant. It comes with row `with_row`.
logic of_last, in_last_row;
logic [RowWidth-1:0] with_row;
logic [PositionWidth-1:0] at_position;
logic [InWidth-1:0] word;
assign in_last_row = with_row == RowWidth'(Rows - 1);
always_ff @(posedge clk) begin
  if (!started) begin
    of_last <= choose_last;
    with_row <= choose_last || 32'(choose_row) >= Rows ? RowWidth'(Rows - 1)
        : choose_row == '0 ? RowWidth'(1) : choose_row;
    at_position <= choose_position;
    word <= choose_word;
  end
end

// Where it leaves: its block of OutWords / 2 positions gives the beat and the half of it.
function automatic logic [BeatWidth-1:0] mirror(input logic [BeatWidth-1:0] beat);
  logic above;
  above = 1'b0;
  for (int b = BeatWidth - 1; b >= 0; b--) begin
    mirror[b] = beat[b] ^ above;
    above = above | beat[b];
  end
endfunction
logic [31:0] in_row, block;
logic [BeatWidth-1:0] beat;
logic [OutWidth-1:0] lane;
logic [RowWidth-1:0] own_row;
logic [AgeWidth-1:0] read_age;  // the n of closes[n] in the clock in which the memory is read, 2 before it leaves
assign in_row = 32'(at_position) * InWords + 32'(word);
assign block = in_row / (OutWords / 2);
assign beat = block[0] ? mirror(BeatWidth'(block >> 1)) : BeatWidth'(block >> 1);
assign lane = OutWidth'(32'(block[0]) * (OutWords / 2) + in_row % (OutWords / 2));
assign own_row = of_last ? with_row : with_row - RowWidth'(1);
assign read_age = AgeWidth'(Latency - 1 + (Rows - 1 - 32'(own_row)) * Beats + 32'(beat));

// A word of the last two rows comes behind the start of the last row and waits in `closed` for its read. Any other is
// in `open` until the next frame could begin, because that has words of its own before the last of this one are read.
logic comes, closing, has_open, due, reads, held;
logic [1:0] reads_q;
logic [Width-1:0] in_word, open, closed, expected, out_word;
assign comes = active_q[1] & (row_q[1] == with_row) & (position_q[1] == at_position);
assign closing = in_last_row ? comes : closes[Clocks];
assign in_word = of_last ? in_last[word*Width+:Width] : in_ahead[word*Width+:Width];
assign reads = closes[read_age];
assign out_word = out_data[lane*Width+:Width];
kept #(.Width(OutWords * Width)) u_kept (.clk, .rst, .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) begin
    if (comes) open <= in_word;
    has_open <= ~in_last_row & (comes | (has_open & ~closing & ~frame_start_q[1]));
    if (closing) closed <= in_last_row ? in_word : open;
    due <= closing | (due & ~reads);
    if (reads) expected <= closed;
    reads_q <= {reads_q[0], reads};
  end
  if (rst) begin
    has_open <= 1'b0;
    due <= 1'b0;
    reads_q <= '0;
  end
end

logic [Pairs-1:0] pairs;  // that begin
for (genvar pair = 0; pair < Pairs; pair++) begin : g_pair
  assign pairs[pair] = closes[ToStart-1+pair*2*Beats];
end

always_comb begin
  if (started) begin
    start_when_due: assert (out_start == (pairs != '0));
    frame_start_when_due: assert (out_frame_start == pairs[0]);
    if (out_start) alone_when_due: assert (out_alone == (Rows % 2 != 0 && pairs[Pairs-1]));
    if (closing) complete: assert (!due && (in_last_row || has_open));
    if (reads) came_before: assert (due);
    if (reads_q[1]) in_place: assert (out_word == expected);
    first_row_last: cover (reads_q[1] && own_row == '0 && 32'(beat) == Beats - 1 && held && expected != '0);
    behind_next: cover (reads_q[1] && active && en && expected != '0);
  end
end

// What makes the proof end.
// Steps of the proof: of each last row on its way, by the clocks since its start, where the writer and the reader of the
// core are, and that the word followed stands in its memory until it is read. All together follow from themselves in one
// clock, so induction ends.
if (1) begin : g_steps
  wire [PositionWidth:0] left = u_protocol.u_bursts.left;  // of the protocol: clocks of the burst that are to come,
  wire [RowWidth-1:0] next_row = u_protocol.u_bursts.next_row;  // the next burst's, 0 if a frame must begin,
  wire [RowWidth-1:0] burst_row = u_protocol.u_bursts.row_q;  // that of the burst,
  wire [15:0] wait_left = u_protocol.wait_left;  // clocks to the next frame
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
    if (en && in_start && row == RowWidth'(1)) {opened, writes_down} <= {1'b1, dut.down};
    if (en && in_start && last_row) {opened, close_down} <= {1'b0, writes_down};
    if (rst) {opened, close_down} <= 2'b01;
  end

  always_comb begin
    if (started) begin
      in_range: assert (32'(left) < Clocks && 32'(next_row) < Rows);
      now: assert (dut.active == active && (!active
          || (dut.position == position && dut.row == row)));
      count: assert (dut.u_write.running == left_some && (!left_some
          || dut.u_write.count == PositionWidth'((PositionWidth + 1)'(Clocks) - left)));
      if (left_some) burst: assert (32'(burst_row) < Rows && dut.row_q == burst_row
          && next_row == (burst_row == RowWidth'(Rows - 1) ? '0 : burst_row + RowWidth'(1)));
      else if (next_row != '0) row_to_come: assert (dut.row_q == next_row
          && burst_row == next_row - RowWidth'(1));
      left_behind: assert (left == (active_q[0] ? (PositionWidth + 1)'(Clocks - 1) - (PositionWidth + 1)'(position_q[0])
          : '0) && (!active_q[0] || row_q[0] == burst_row));
      if (active_q[1] && position_q[1] != LastPosition) goes_on: assert (active_q[0] && row_q[0] == row_q[1]
          && position_q[0] == position_q[1] + PositionWidth'(1));
      else if (active_q[0]) begins: assert (position_q[0] == '0
          && (!active_q[1] || row_q[0] == (frame_start_q[0] ? '0 : row_q[1] + RowWidth'(1))));
      else if (active_q[1]) ends: assert (burst_row == row_q[1]);

      ways: assert (opened ? writes_down == ~close_down : closes == '0 || writes_down == close_down);
      way_to_come: assert (dut.down == (starting ? close_down : ~close_down));
      if (left_some && burst_row != '0) way_taken: assert (burst_row == RowWidth'(Rows - 1)
          ? closes[AgeWidth'(Clocks-1-32'(left))] : opened);
      if (!left_some && 32'(next_row) >= 2) way_goes_on: assert (opened);
      if (left_some && burst_row != '0)
        slot_now: assert (dut.slot_q == slot(writes_down, 32'(burst_row) - 1));
      if (!left_some && 32'(next_row) >= 2)
        slot_to_come: assert (dut.slot_q == slot(writes_down, 32'(next_row) - 1));

      starts_run: assert (dut.u_starts.running == ((closes & each_pair(Start, 1'b0)) != '0));
      reads_run: assert (dut.u_read.running == ((closes & each_pair(Read, 1'b0)) != '0));
      if ((closes & from_to(Start, Start + All)) == '0) no_pair: assert (dut.pair == '0);
    end
  end

  for (genvar i = 0; i < 2; i++) begin : g_late
    always_comb begin
      if (started) begin
        late_starts: assert (start_q[i] == (active_q[i] & (position_q[i] == '0))
            && frame_start_q[i] == (start_q[i] & (row_q[i] == '0)));
        late_writes: assert (dut.write_last_q[i] == (active_q[i] & (row_q[i] == RowWidth'(Rows - 1)))
            && dut.write_ahead_q[i] == (active_q[i] & (row_q[i] != '0)));
        if (active_q[i]) begin
          late_beats: assert (32'(row_q[i]) < Rows
              && dut.even_q[i] == position_q[i][PositionWidth-1-:BeatWidth]
              && dut.odd_q[i] == dut.mirror(position_q[i][PositionWidth-1-:BeatWidth]));
          for (int g = 0; g < Groups; g++)
            assert (dut.chosen_q[i][g] == (Group < InWords || 32'(position_q[i]) % Groups == g));
          if (row_q[i] != '0) late_slot: assert (dut.write_slot_q[i]
              == slot(writes_down, 32'(row_q[i]) - 1) && (row_q[i] == RowWidth'(Rows - 1)
              ? closes[AgeWidth'(32'(position_q[i])+i)] : opened || (closes & from_to(0, i)) != '0));
        end
      end
    end
  end

  for (genvar i = 0; i < 4; i++) begin : g_start
    always_comb begin
      if (started) begin
        pair_starts: assert (dut.start_q[i] == ((closes & each_pair(Start + i + 1, 1'b1)) != '0)
            && dut.frame_start_q[i] == closes[Start+i+1]);
        if (dut.start_q[i]) pair_alone: assert (dut.alone_q[i]
            == (Rows % 2 != 0 && closes[Start+i+1+(Pairs-1)*PairBeats]));
      end
    end
  end

  logic [OutWords*Width-1:0] last_entry, last_word, word;
  logic [1:0][OutWords*Width-1:0] entry;  // of a frame on the way up, on the way down
  for (genvar g = 0; g < Groups; g++) begin : g_group
    localparam int Low = g * Group * Width;
    assign last_entry[Low+:Group*Width] = dut.g_group[g].u_last.g_distributed.words[beat];
    assign last_word[Low+:Group*Width] = dut.g_group[g].last_word;
    assign word[Low+:Group*Width] = dut.g_group[g].word;
    for (genvar down = 0; down < 2; down++) begin : g_way
      assign entry[down][Low+:Group*Width]
          = dut.g_group[g].u_rows.g_block.words[{slot(1'(down), 32'(own_row)), beat}];
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

        if (Time >= 0 && Time < All) pair_now: assert (32'(dut.pair) == Pairs - 1 - Time / PairBeats
            && (Time % PairBeats == 0 || 32'(dut.u_starts.count) == Time % PairBeats));
        if (Time >= 0 && (closes & from_to(Start, n)) == '0)
          reader_way: assert (dut.reads_down == ~(close_down ^ starting));
        if (ReadTime > 0 && ReadTime < All && ReadTime % PairBeats != 0)
          reader: assert (32'(dut.u_read.count) == ReadTime % PairBeats
              && dut.first_pair_q == (ReadTime < PairBeats)
              && dut.alone_now == (Rows % 2 != 0 && ReadTime / PairBeats == Pairs - 1));
        if (ReadTime > 0 && ReadRow < Rows)
          reader_slot: assert (dut.read_slot_q == slot(down, Rows - 2 - (ReadRow > 0 ? ReadRow - 1 : 0)));

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
      if (reads_q[0]) word_read: assert (dut.from_last_q == of_last
          && (of_last ? last_word[lane*Width+:Width] : word[lane*Width+:Width]) == expected);
    end
  end
end

bind td_ram ram_check #(.Depth(Depth), .Defined(0), .Covered(0)) u_check (.*);

// Protocol: bursts of Columns / InWords clocks as protocol_bursts allows them, no faster in all than a frame of them
// leaves; pairs of rows going out, 6 enabled clocks behind their starts.
module protocol_wide_stack;
  localparam int Clocks = Columns / InWords, Beats = Columns / OutWords, PositionWidth = $clog2(Clocks),
      RowWidth = $clog2(Rows + 1);
  logic active;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  logic last_row;
  // Clocks that a frame of an odd number of rows waits, where rows come as fast as they leave.
  localparam int Wait = (Rows + 1) / 2 * 2 * Beats > Rows * Clocks ? (Rows + 1) / 2 * 2 * Beats - Rows * Clocks : 0;
  logic bursts;
  logic [15:0] wait_left = '0, out_left = '0;
  logic [5:0] start_q = '0;
  assign holds = bursts & ~(in_start & in_frame_start & wait_left != '0);
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[5] | out_left != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row,
    .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations(),
    .counts()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start & last_row) wait_left <= 16'(Clocks + Wait - 1);
      else wait_left <= wait_left - 16'(wait_left != '0);
      start_q <= 6'({start_q, out_start});
      out_left <= start_q[5] ? 16'(2 * Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (reset) begin
      wait_left <= '0;
      start_q <= '0;
      out_left <= '0;
    end
  end
endmodule
