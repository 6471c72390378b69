// SPDX-License-Identifier: Apache-2.0
// fv_frame_stack: an arbitrary word leaves at its place of its row, last row first, unchanged, in the lower or the upper
// half of the words; the first words Latency enabled clocks behind the first ones of the last row, pair behind pair as
// the header says; starts, frame_start and alone 6 clocks before. Any gaps between bursts, any en, any frame number, and
// frames that begin before the last one is whole.

parameter int Width = 1, Rows = 5, Columns = 8, InWords = 1, Lanes = 1, WordsPerRow = 1;
localparam int Paths = Lanes > 1 ? Lanes / 2 : 1, Clocks = Columns / InWords, Beats = Columns / Paths,
    Period = 2 * Columns / Lanes, Pairs = (Rows + 1) / 2, Leaves = (Pairs - 1) * Period + Beats,  // clocks of a frame
    Latency = InWords == Paths ? 1 : Clocks - Beats + 4;
localparam int PositionWidth = $clog2(Clocks), RowWidth = $clog2(Rows + 1), PlaceWidth = $clog2(Leaves), Lead = 6,
    InWidth = InWords > 1 ? $clog2(InWords) : 1, OutWidth = $clog2(2 * Paths), Longest = Latency + Lead - 1 + Leaves;
input logic pick, of_last;
input logic [InWidth-1:0] choose;  // of the words of a clock

// All of the input as late as the words are. starts[n]: the last row of a frame began n + 1 enabled clocks ago.
logic [Longest-1:0] starts;
logic [Lead-1:0] active_q;
logic [Lead-1:0][PositionWidth-1:0] position_q;
logic [Lead-1:0][RowWidth-1:0] row_q;
wire [PositionWidth-1:0] position = position_q[Lead-1];
wire [RowWidth-1:0] row = row_q[Lead-1];
wire active = active_q[Lead-1], last_row = active & (row == RowWidth'(Rows - 1));
function automatic logic pair_begins(input int late);  // so many enabled clocks ago
  pair_begins = 1'b0;
  for (int pair = 0; pair < Pairs; pair++) pair_begins |= starts[Latency-1+late+pair*Period];
endfunction

// The word, its own row counted from the last one, and its place: a clock of the frame that leaves, a word of it.
logic [31:0] up, in_row;
logic [PlaceWidth-1:0] place;
logic [InWidth-1:0] word;
logic [OutWidth-1:0] half;
logic [Width-1:0] value;
logic [$clog2(Longest+1)-1:0] age;  // of the last row of its frame, as in starts; 0: it is still to begin
logic following, watched, dropped, held;
assign word = InWords > 1 ? choose : '0;
assign up = 32'(Rows) - 1 - 32'(row) + (of_last ? 0 : 1);
assign in_row = 32'(position) * InWords + 32'(word);
assign watched = following & (32'(age) == Latency + Lead - 1 + 32'(place));
assign dropped = active & (row == '0) & (age == '0);  // a frame begins before its own is whole
kept #(.Width(2 * Paths * Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) begin
    starts <= {starts[Longest-2:0], in_start & u_protocol.last_row};
    active_q <= {active_q[Lead-2:0], u_protocol.active};
    position_q <= {position_q[Lead-2:0], u_protocol.position};
    row_q <= {row_q[Lead-2:0], u_protocol.row};
    if (following && age != '0) age <= age + 1'b1;
    else age <= last_row ? $bits(age)'(Lead + 32'(position)) : '0;
    if (!following) begin
      following <= pick & active & (of_last ? last_row : row != '0);
      place <= PlaceWidth'(up / 2 * Period + in_row / Paths);
      half <= OutWidth'(up % 2 * Paths + in_row % Paths);
      value <= of_last ? in_last[word*Width+:Width] : in_ahead[word*Width+:Width];
    end else begin
      following <= ~watched & ~dropped;
    end
  end
  if (rst) {starts, active_q, following} <= '0;
end

always_comb begin
  if (started) begin
    start_when_due: assert (out_start == pair_begins(0));
    frame_start_when_due: assert (out_frame_start == starts[Latency-1]);
    if (out_start) alone_when_due: assert (out_alone == (Rows % 2 != 0 && starts[Latency-1+(Pairs-1)*Period]));
    if (watched) in_place: assert (out_data[half*Width+:Width] == value);
    last_word: cover (watched && 32'(place) == Leaves - 1);
    behind_next: cover (watched && 32'(place) >= Leaves - 2 && active && held);
  end
end

// What makes the proof end.
// Steps of the proof: by the clocks since a last row began, where the reader of the core is; by row and position, where
// the writer is, and when it may come there; that the word followed stands in its memory until it is read. All together
// follow from themselves in one clock, so induction ends.
if (1) begin : g_steps
  localparam int Begins = Latency - 1, Reads = Begins + 3, RowWords = Paths > 1 ? Paths : WordsPerRow,
      Gather = RowWords / InWords, Serve = RowWords / Paths, Burst = (Columns + RowWords - 1) / RowWords;
  localparam int Whole = (Pairs - 1) * Period + (Rows % 2 != 0 ? Beats : Period),
      Frame = Whole > Rows * Clocks ? Whole : Rows * Clocks,  // clocks between two last rows, at least
      Wait = Frame - Rows * Clocks;
  wire [PositionWidth:0] left = u_protocol.u_bursts.left;  // of the protocol: clocks of the burst that are to come,
  wire [RowWidth-1:0] next_row = u_protocol.u_bursts.next_row;  // the next burst's, 0 if a frame must begin,
  wire [RowWidth-1:0] burst_row = u_protocol.u_bursts.row_q;  // that of the burst

  function automatic logic [Longest-1:0] from_to(input int from, input int to);  // bits from .. to - 1
    from_to = '0;
    for (int n = 0; n < Longest; n++) from_to[n] = n >= from && n < to;
  endfunction

  // The way through the memories of the frame that comes, of that which leaves, of that of the word followed.
  logic known, comes_down, leaves_down, word_down;  // known: a row of a frame came since the reset
  logic [RowWidth-1:0] written_q;  // rows of which words came
  logic [Lead-1:0] start_q;
  assign start_q[Lead-2:0] = dut.start_q;
  always_ff @(posedge clk) begin
    if (en) begin
      written_q <= dut.written;
      start_q[Lead-1] <= dut.start_q[Lead-2];
      known <= known | active;
      if (active && position == '0 && row == '0) comes_down <= dut.down;
      if (starts[Reads]) leaves_down <= ~dut.down;
      if (!following) word_down <= comes_down;
    end
    if (rst) {known, start_q[Lead-1]} <= '0;
  end

  logic [31:0] now;  // clock of the frame that comes, or the one before which it pauses
  assign now = active ? 32'(row) * Clocks + 32'(position) : 32'(written_q) * Clocks;

  wire ends_row = active && (Clocks - 1 - 32'(position)) % Gather == 0;  // a row of a memory

  // What comes: the protocol, the rows on their way, the writer.
  always_comb begin
    if (started) begin
      count: assert (dut.u_clocks.running == (left != '0) && (left == '0
          || dut.u_clocks.count == PositionWidth'((PositionWidth + 1)'(Clocks) - left)));
      rows: assert (32'(next_row) == (32'(dut.begun_q) < Rows ? 32'(dut.begun_q) : 0));
      burst_left: assert (left == (active_q[0] ? (PositionWidth + 1)'(Clocks - 1) - position_q[0] : '0));
      if (active_q[0]) burst: assert (row_q[0] == burst_row && 32'(dut.begun_q) == 32'(row_q[0]) + 1);
      if (start_q == '0) none_on_way: assert (dut.begun_q == (known ? written_q : Rows));
      comes: assert (dut.coming == active_q[Lead-2]);
      if (active_q[Lead-2]) coming: assert ((known || start_q[Lead-1:Lead-2] != '0)
          && dut.coming_position == position_q[Lead-2]
          && 32'(dut.coming_written) == 32'(row_q[Lead-2]) + 1
          && 32'(dut.gather) == (Clocks - 1 - 32'(position_q[Lead-2])) % Gather);
      if (known) same_row: assert (dut.written == (start_q[Lead-1] ? dut.begun_q : written_q));
      for (int side = 0; side < 2; side++)
        assert (dut.stores[side] == (ends_row && row != '0 && 32'(row) != Rows - 1
            && 32'(row) % 2 == (Rows - side) % 2));
      if (active) present: assert ((known || start_q[Lead-1]) && 32'(dut.written) == 32'(row) + 1
          && dut.ends_burst == (32'(position) == Clocks - 1));
      if (known) way: assert (comes_down == (dut.down
          ^ (32'(written_q) == Rows ? (starts & from_to(0, Begins)) == '0
          : 32'(written_q) == Rows - 1 && (starts & from_to(Begins, Lead)) != '0)));
    end
  end
  for (genvar i = 0; i < Lead; i++) begin : g_late
    always_comb begin
      if (started) begin
        starts_late: assert (start_q[i] == (active_q[i] && position_q[i] == '0));
        if (active_q[i]) in_frame: assert (32'(row_q[i]) < Rows);
        if (active_q[i] && 32'(row_q[i]) == Rows - 1) last_began: assert (starts[i+32'(position_q[i])]);
        for (int n = i; n < i + Clocks && n < Longest; n++)
          if (starts[n]) assert (active_q[i] && 32'(row_q[i]) == Rows - 1 && 32'(position_q[i]) == n - i);
        if (start_q[i]) on_way: assert (row_q[i] == '0 || (known && written_q == row_q[i]));
        if (i > 0 && active_q[i] && position_q[i] != '1)
          goes_on: assert (active_q[i-1] && position_q[i-1] == position_q[i] + 1'b1 && row_q[i-1] == row_q[i]);
        else if (i > 0 && active_q[i-1]) begins: assert (position_q[i-1] == '0);
        for (int n = i + 1; n < Longest; n++) begin
          if (starts[n] && active_q[i] && 32'(row_q[i]) < Rows - 1)
            assert (n >= Clocks + Wait + i + 32'(row_q[i]) * Clocks + 32'(position_q[i]));
        end
      end
    end
  end

  // What leaves, by the clocks since the last row began.
  for (genvar n = 0; n < Longest; n++) begin : g_age
    localparam int Due = n - Begins, Read = n - Reads;  // since the first start out, since the first read
    always_comb begin
      if (started && starts[n]) begin
        apart: assert ((starts & from_to(n + 1, n + Frame)) == '0);
        if ((starts & from_to(0, n)) == '0 && next_row == '0)
          waits: assert (32'(u_protocol.wait_left) == (n < Clocks + Wait - 1 ? Clocks + Wait - 1 - n : 0));
        if (next_row != '0) next_frame: assert (n + 32'(left) >= Clocks + Wait + 32'(next_row) * Clocks - 1);
        if (Due >= 0 && Due < (Pairs - 1) * Period) pairs_to_begin: assert (dut.starts_active
            && 32'(dut.start_time) == Due % Period && 32'(dut.pair) == Pairs - 1 - Due / Period);
        if (Read >= 0 && Read < Leaves) first: assert (dut.first_pair == (Read < Period));
        if (Read >= -1 && Read + 1 < Leaves) next_first: assert (dut.next_first_pair == (Read + 1 < Period));
        if (Read >= -1 && Read + 1 < Leaves && (Read + 1) % Period < Beats) comes: assert (
            32'(dut.next_time) == (Read + 1) % Period
            && 32'(dut.next_serve) == (Beats - 1 - (Read + 1) % Period) % Serve);
        if (Read >= 0 && Read < Leaves && Read % Period < Beats) reader: assert (
            dut.ends_read == (Read % Period == Beats - Serve)
            && 32'(dut.serve) == (Beats - 1 - Read % Period) % Serve);
        for (int i = 0; i < 2; i++) begin
          if (Due > i && Due <= i + Leaves)
            assert (dut.alone_q[i] == (Rows % 2 != 0 && Due > i + (Pairs - 1) * Period));
        end
        if (Read > 0 && Read <= Leaves && (Read - 1) % Period < Beats) behind: assert (dut.past_q[0] == (Read <= Period)
            && 32'(dut.serve_q[0]) == (Beats - 1 - (Read - 1) % Period) % Serve);
        if (Read > 1 && Read <= Leaves + 1 && (Read - 2) % Period < Beats)
          out: assert (dut.past_q[1] == (Read <= Period + 1)
              && 32'(dut.serve_q[1]) == (Beats - 1 - (Read - 2) % Period) % Serve);
        if (Read > 0 && (starts & from_to(Begins, n)) == '0) way_back: assert (leaves_down == ~dut.down);
        if (n >= Lead && Read <= Leaves && known && 32'(written_q) < Rows && (starts & from_to(Lead, n)) == '0)
          next_way: assert (comes_down == ~leaves_down);
      end
    end
  end
  // Reads: of the clock that is next, and those of memory rows in this one, but for the last two rows of a frame.
  logic reading_next;
  logic [1:0] reads_row;
  always_comb begin
    reading_next = 1'b0;
    reads_row = '0;
    for (int beat = 0; beat < Beats; beat++) begin
      reading_next |= pair_begins(2 + beat);
      if (beat == 0 || (Beats - 1 - beat) % Serve == Serve - 1) begin
        for (int pair = 1; pair < Pairs; pair++) begin
          reads_row[0] |= starts[Reads+beat+pair*Period];
          reads_row[1] |= starts[Reads+beat+pair*Period] & ~(Rows % 2 != 0 && pair == Pairs - 1);
        end
      end
    end
    if (started) begin
      if ((starts & from_to(Begins, Begins + (Pairs - 1) * Period)) == '0) no_pair: assert (dut.pair == '0);
      comes_to_read: assert (dut.next_read == reading_next);
      for (int side = 0; side < 2; side++) assert (dut.reads[side] == reads_row[side]);
      for (int i = 0; i < 2; i++) begin
        assert (dut.read_start_q[i] == pair_begins(i + 1));
        assert (dut.frame_start_q[i] == starts[Latency+i]);
      end
    end
  end

  always_comb if (started && following) placed: assert (32'(place) < Leaves
      && (age == '0 || (32'(age) >= Lead && 32'(age) <= Reads + 3 + 32'(place) && starts[age])));
  for (genvar s = 0; s < 2; s++) begin : g_side
    if (InWords != Paths) begin : g_buffer
      always_comb begin
        if (started) writes: assert (dut.g_side[s].g_buffer.write_row == ends_row);
        if (started) past: assert (dut.g_side[s].g_buffer.reads_row
            == ((starts & from_to(Reads, Reads + Beats)) != '0));
        for (int n = Reads; n < Reads + Beats; n++)
          if (started && starts[n]) assert (32'(dut.g_side[s].g_buffer.read_time) == n - Reads);
        if (started && active) at: assert (32'(dut.g_side[s].g_buffer.write_time) == 32'(position) * Beats / Clocks);
      end
    end
    localparam int Slots = (Rows - 1 - s) / 2, Odd = (Rows - 1 - s) % 2;
    function automatic int at(input int slot, input int memory_row, input logic down);
      at = (down ? Slots - 1 - slot : slot) * Burst + memory_row;
    endfunction

    // Addresses of the writer and the reader: of the memory row that is next.
    for (genvar b = 0; b < Rows; b++) begin : g_row
      localparam int Slot = b > Odd ? (b - Odd) / 2 : 0;
      for (genvar p = b > 0 ? 0 : 1; p < Clocks && Slot < Slots; p++) begin : g_position
        localparam int Row = b > 0 && (b - 1) % 2 == Odd ? Burst - 1 - (Clocks - 1 - p) / Gather : 0;
        always_comb begin
          if (started && known && now == b * Clocks + p)
            writes: assert (32'(dut.g_side[s].write_address) == at(Slot, Row, comes_down));
        end
      end
    end
    for (genvar n = Reads + 1; n < Reads + Leaves; n++) begin : g_read
      localparam int Pair = (n - Reads) / Period, Time = (n - Reads) % Period,
          Row = Time == 0 ? 0 : Burst - (Beats - Time) / Serve;
      localparam bit Same = Pair > 0 && Time < Beats && Row < Burst;
      localparam int Next = Same ? Pair : Pair + 1;
      if (Next <= Slots) begin : g_some
        always_comb begin
          if (started && starts[n]) reads: assert (32'(dut.g_side[s].read_address)
              == at(Slots - Next, Same ? Row : 0, leaves_down));
        end
      end
    end

    // The word followed.
    for (genvar h = 0; h < Paths; h++) begin : g_path
      for (genvar l = 0; l < Leaves; l++) begin : g_place
        localparam int Pair = l / Period, Time = l % Period, Row = Rows - 1 - s - 2 * Pair;
        logic here;
        assign here = started && following && !dropped && 32'(place) == l && 32'(half) == s * Paths + h;
        if (Time >= Beats || Row < 0) begin : g_none
          always_comb no_word: assert (!here);
        end else begin : g_some
          localparam int At = (Time * Paths + h) / InWords;  // position
          localparam int Came = (Row + 1) * Clocks + At;
          localparam int Until = (Clocks - 1 - At) % Gather;  // clocks to the write
          localparam int Entry = (Gather - 1 - Until) * InWords + (Time * Paths + h) % InWords;  // of the memory row
          localparam int Since = Time - (Serve - 1 - (Beats - 1 - Time) % Serve);
          localparam int ReadAt = Reads + Pair * Period + (Since > 0 ? Since : 0);
          if (Pair > 0) begin : g_stored
            logic [RowWords*Width-1:0] entry;
            logic gathers;
            assign entry = dut.g_side[s].u_ram.u_ram.g_block
                .words[at((Row - Odd) / 2, Burst - 1 - (Clocks - 1 - At) / Gather, word_down)];
            assign gathers = age == '0 && now <= Came + Until;
            always_comb begin
              if (here) begin
                if (age == '0) came: assert (now > Came && now <= (Rows - 1) * Clocks);
                else if (32'(age) <= Reads) whole: assert (32'(written_q) == Rows);
                if (32'(age) <= Reads) way: assert (known && comes_down == word_down);
                else if (32'(age) <= ReadAt) way_back: assert (leaves_down == word_down);
                if (32'(age) <= ReadAt && !gathers) stands: assert (entry[Entry*Width+:Width] == value);
                if (32'(age) > ReadAt && 32'(age) <= Reads + 1 + l)
                  was_read: assert (dut.g_side[s].u_ram.word[Entry*Width+:Width] == value);
                if (32'(age) == Reads + 2 + l) taken: assert (dut.g_side[s].word[h*Width+:Width] == value);
              end
            end
            if (Until > 0) begin : g_gather
              always_comb if (here && gathers) stands: assert (dut.g_gather
                  .kept[(Entry+(Came+Until-now)*InWords)*Width+:Width] == value);
            end
          end else if (InWords == Paths) begin : g_past
            always_comb if (here) passes: assert (watched);
          end else begin : g_buffered
            logic [RowWords*Width-1:0] entry;
            logic [(RowWords-InWords)*Width-1:0] kept;
            if (s == 0) assign kept = dut.g_side[s].g_buffer.g_last.kept;
            else assign kept = dut.g_gather.kept;
            assign entry = dut.g_side[s].g_buffer.u_row.u_ram.g_distributed.words[Time];
            always_comb begin
              if (here) begin
                came: assert (32'(age) >= Lead + At);
                if (32'(age) < Lead + At + Until) gathers: assert (
                    kept[(Entry+(Lead+At+Until-1-32'(age))*InWords)*Width+:Width] == value);
                if (32'(age) >= Lead + At + Until && 32'(age) <= ReadAt)
                  stands: assert (entry[Entry*Width+:Width] == value);
                if (32'(age) == ReadAt + 1)
                  was_read: assert (dut.g_side[s].g_buffer.u_row.word[Entry*Width+:Width] == value);
                if (32'(age) == ReadAt + 2) taken: assert (dut.g_side[s].past[h*Width+:Width] == value);
              end
            end
          end
        end
      end
    end
  end
end

bind td_ram ram_check #(.Depth(Depth), .Defined(0), .Covered(0)) u_check (.*);

// Protocol: bursts of Columns / InWords clocks as protocol_bursts allows them, no faster in all than a frame of them
// leaves; pairs of rows going out, 6 enabled clocks behind their starts.
module protocol_frame_stack;
  localparam int Clocks = Columns / InWords, Beats = Columns / Paths,
      Period = 2 * Columns / Lanes, Pairs = (Rows + 1) / 2, PositionWidth = $clog2(Clocks),
      RowWidth = $clog2(Rows + 1);
  // Clocks that a frame waits, where rows come faster than they leave.
  localparam int Leaves = (Pairs - 1) * Period + (Rows % 2 != 0 ? Beats : Period),
      Wait = Leaves > Rows * Clocks ? Leaves - Rows * Clocks : 0;
  logic active;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  logic last_row, bursts;
  logic [15:0] wait_left = '0, out_left = '0;
  logic [5:0] start_q = '0;
  assign holds = bursts & ~(in_start & in_frame_start & wait_left != '0);
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[5] | out_left != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row,
    .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations(), .counts()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start & last_row) wait_left <= 16'(Clocks + Wait - 1);
      else wait_left <= wait_left - 16'(wait_left != '0);
      start_q <= {start_q[4:0], out_start};
      out_left <= start_q[5] ? 16'(Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (reset) begin
      wait_left <= '0;
      start_q <= '0;
      out_left <= '0;
    end
  end
endmodule
