// SPDX-License-Identifier: Apache-2.0
// fv_transpose: an arbitrary word leaves in its column at the place of its row, unchanged; the first column 3 enabled
// clocks behind the first word of the last row, the others behind it without a pause; frame_start with the first. Any
// gaps between bursts, any en, any frame number, and frames that begin before the last one is whole.

parameter int Width = 1, Columns = 4, MakhoulIn = 0, MakhoulOut = 0;
input logic pick;

localparam int IndexWidth = $clog2(Columns), RowWidth = $clog2(Columns + 1), Leaves = Columns * Columns, Begins = 2,
    Longest = Begins + 2 + Leaves;

logic coming, coming_last;
logic [IndexWidth-1:0] coming_position;
logic [RowWidth-1:0] coming_row;
protocol_bursts #(.Columns(Columns), .Rows(Columns)) u_protocol (
  .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active(coming), .position(coming_position),
  .row(coming_row), .last_row(coming_last), .holds(allowed)
);

// Words come 2 enabled clocks behind all this, and leave so behind their starts. starts[n]: the last row of a frame
// began n + 1 enabled clocks ago.
logic [Longest-1:0] starts;
logic [1:0] active_q;
logic [1:0][IndexWidth-1:0] position_q;
logic [1:0][RowWidth-1:0] row_q;
wire [IndexWidth-1:0] position = position_q[1];
wire [RowWidth-1:0] row = row_q[1];
wire active = active_q[1];
logic column_begins;
always_comb begin
  column_begins = 1'b0;
  for (int column = 0; column < Columns; column++) column_begins |= starts[Begins+column*Columns];
end

// Makhoul's order: even samples upwards, then odd samples downwards.
function automatic logic [IndexWidth-1:0] place_of_sample(input logic [IndexWidth-1:0] n);
  return n % 2 == 0 ? n / 2 : IndexWidth'(Columns - 1) - n / 2;
endfunction
function automatic logic [IndexWidth-1:0] sample_at_place(input logic [IndexWidth-1:0] p);
  return 32'(p) < Columns / 2 ? p * 2 : IndexWidth'(2 * (Columns - 1 - 32'(p)) + 1);
endfunction

logic following, watched, dropped, held;
logic [IndexWidth-1:0] column, row_place;  // of the word followed
logic [$clog2(Longest+1)-1:0] age;  // of the last row of its frame, as in starts; 0: it is still to begin
logic [Width-1:0] value;
assign watched = following & (32'(age) == Begins + 2 + 32'({column, row_place}));
assign dropped = active & (row == '0) & (age == '0);  // a frame begins before its own is whole
kept #(.Width(Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) begin
    starts <= {starts[Longest-2:0], in_start & coming_last};
    active_q <= {active_q[0], coming};
    position_q <= {position_q[0], coming_position};
    row_q <= {row_q[0], coming_row};
    if (following && age != '0) age <= age + 1'b1;
    else age <= active && 32'(row) == Columns - 1 ? $bits(age)'(Begins + 32'(position)) : '0;
    if (!following) begin
      following <= pick & active;
      column <= MakhoulIn != 0 ? sample_at_place(position) : position;
      row_place <= MakhoulOut != 0 ? place_of_sample(IndexWidth'(row)) : IndexWidth'(row);
      value <= in_data;
    end else begin
      following <= ~watched & ~dropped;
    end
  end
  if (rst) {starts, active_q, following} <= '0;
end

always_comb begin
  if (started) begin
    frame_when_due: assert (out_frame_start == starts[Begins]);
    column_when_due: assert (out_start == column_begins);
    if (watched) in_place: assert (out_data == value);
    last_word: cover (watched && {column, row_place} == '1);
    last_word_behind_next: cover (watched && {column, row_place} == '1 && active && held);
  end
end

// What makes the proof end.
// Steps of the proof: by the clocks since a last row began, where the reader of the core is; by row and position, where
// the writer is, and when it may come there; that the word followed stands in the memory until it is read. All together
// follow from themselves in one clock, so induction ends.
if (1) begin : g_steps
  wire [IndexWidth:0] left = u_protocol.left;  // of the protocol: words of the burst that are to come,
  wire [RowWidth-1:0] next_row = u_protocol.next_row;  // the next burst's, 0 if a frame must begin

  function automatic logic [Longest-1:0] from_to(input int from, input int to);  // bits from .. to - 1
    from_to = '0;
    for (int n = 0; n < Longest; n++) from_to[n] = n >= from && n < to;
  endfunction

  logic known, word_transposed;  // known: a row of a frame came since the reset
  logic [31:0] now;  // word of the frame that comes, or the one before which it pauses
  assign now = active ? 32'(row) * Columns + 32'(position) : 32'(dut.row_q) * Columns;
  always_ff @(posedge clk) begin
    if (en) begin
      known <= known | active;
      if (!following) word_transposed <= dut.write_transposed;
    end
    if (rst) known <= 1'b0;
  end

  always_comb begin
    if (started) begin
      burst_left: assert (left == (active_q[0] ? (IndexWidth + 1)'(Columns - 1) - position_q[0] : '0));
      if (active_q[0]) burst: assert (row_q[0] == u_protocol.row_q
          && next_row == (32'(row_q[0]) == Columns - 1 ? '0 : row_q[0] + 1'b1));
      if (active && !active_q[0]) paused: assert (next_row == (32'(row) == Columns - 1 ? '0 : row + 1'b1));
      if (!active && active_q[0]) next: assert (row_q[0] == '0 || (known && row_q[0] == RowWidth'(dut.row_q)));
      if (!active && !active_q[0])
        next_to_come: assert (next_row == '0 ? !known || dut.row_q == '0 : known && next_row == RowWidth'(dut.row_q));
      writes: assert (dut.write_active == active);
      if (active) present: assert ((known || now == 0) && dut.write_position == position && RowWidth'(dut.row) == row);
      if (known || active) turned: assert (dut.write_transposed
          == (dut.read_transposed ^ (active ? now <= Leaves - Columns : dut.row_q != '0)));
      reads: assert (dut.read_active == ((starts & from_to(Begins, Begins + Leaves)) != '0));
      begins: assert (dut.read_start == starts[Begins]);
      checked: assert (dut.u_ram.u_ram.u_check.started);
    end
  end
  for (genvar i = 0; i < 2; i++) begin : g_late
    always_comb begin
      if (started) begin
        starts_late: assert (dut.start_q[i] == (active_q[i] && position_q[i] == '0)
            && (!dut.start_q[i] || dut.frame_start_q[i] == (row_q[i] == '0)));
        if (active_q[i]) in_frame: assert (32'(row_q[i]) < Columns);
        if (active_q[i] && 32'(row_q[i]) == Columns - 1) last_began: assert (starts[i+32'(position_q[i])]);
        for (int n = i; n < i + Columns; n++)
          if (starts[n]) assert (active_q[i] && 32'(row_q[i]) == Columns - 1 && 32'(position_q[i]) == n - i);
        for (int n = i + 1; n < Longest; n++) begin
          if (starts[n] && active_q[i] && 32'(row_q[i]) < Columns - 1)
            assert (n >= Columns + i + 32'(row_q[i]) * Columns + 32'(position_q[i]));
        end
      end
    end
  end
  always_comb begin
    if (started && active && position != '1)
      goes_on: assert (active_q[0] && position_q[0] == position + 1'b1 && row_q[0] == row);
    else if (started && active_q[0]) begins_at: assert (position_q[0] == '0
        && (!active || row_q[0] == '0 || row_q[0] == row + 1'b1));
  end
  for (genvar n = 0; n < Longest; n++) begin : g_age
    always_comb begin
      if (started && starts[n]) begin
        apart: assert ((starts & from_to(n + 1, n + Leaves)) == '0);
        if (next_row != '0) next_frame: assert (n + 32'(left) >= Columns + 32'(next_row) * Columns - 1);
        if (n >= Begins && n < Begins + Leaves) reader: assert (32'(dut.read_position) == n - Begins);
        if (n >= Begins) came: assert (known && (n <= Columns || dut.u_ram.u_ram.u_check.written == '1));
      end
    end
  end

  // The word followed.
  always_comb if (started && following)
    in_time: assert (age == '0
        || (32'(age) >= Begins && 32'(age) <= Begins + 2 + 32'({column, row_place}) && starts[age]));
  for (genvar c = 0; c < Columns; c++) begin : g_column
    for (genvar r = 0; r < Columns; r++) begin : g_row
      localparam logic [IndexWidth-1:0] Row = IndexWidth'(r),
          Column = IndexWidth'(c), Place = MakhoulOut != 0 ? place_of_sample(Row) : Row,
          At = MakhoulIn != 0 ? place_of_sample(Column) : Column;  // in the row
      localparam int Came = r * Columns + 32'(At), ReadAt = Begins + c * Columns + 32'(Place);
      logic here;
      assign here = started && following && !dropped && 32'(column) == c && row_place == Place;
      always_comb begin
        if (started && known && now > Came)
          was_written: assert (dut.u_ram.u_ram.u_check.written[dut.write_transposed ? {Column, Row} : {Row, Column}]);
        if (here) begin
          if (age == '0) came: assert (known && now > Came && now <= Leaves - Columns
              && word_transposed == dut.write_transposed);
          else if (32'(age) <= ReadAt) turned: assert (word_transposed == dut.read_transposed
              && 32'(age) >= Begins + (r == Columns - 1 ? 32'(At) : 0));
          if (32'(age) <= ReadAt)
            stands: assert (dut.u_ram.u_ram.g_block.words[word_transposed ? {Column, Row} : {Row, Column}] == value);
          if (32'(age) == ReadAt + 1) was_read: assert (dut.u_ram.word == value);
        end
      end
    end
  end
end

bind dut.u_ram.u_ram ram_check #(.Depth(Depth)) u_check (.*);
