// SPDX-License-Identifier: Apache-2.0
// fv_elimination: d[i] = c[i] (f[i] - d[i-1]) and e[i-1] = d[i-1] - c[i-1] d[i] for every row of word Word in an
// arbitrary clock of the bursts, of any frame, 9 enabled clocks behind f[i], with the coefficients of its own row,
// clock and word; start and frame_start with their burst. Neumann: the last row of position 0 is minus the mean. Each
// clip is counted once, that of a stored d in the last row alone, that of e in all rows but the first; those of the
// mean are proven of column_mean. No word of the frame before, and none from power-up, enters: the specification has
// none, and the memories begin with any contents. Rounding is proven of td_round_saturate.

parameter int Rows = 3, Columns = 16, Words = 2;
parameter int Word = 0;  // the one followed
parameter int Neumann = 0, TableWords = 16;
localparam int Clocks = Columns / Words, PositionWidth = $clog2(Clocks), Width = 3, CoeffWidth = 3, OutWidth = 2,
    StoreDrop = 1, SettledWidth = 2, LastShiftWidth = 1, MomentDrop = 1, MeanReciprocal = 2, MeanDrop = 1;
input logic [PositionWidth-1:0] chosen;

localparam int ToStart = 5, Starts = 9;  // from a start to its start out, 6 before the words; kept
localparam int ToWords = 11;  // from a start to the first words out
localparam int MeanLatency = 12;  // from a start to the mean that its word is in
localparam int MomentWidth = Width + 2 * $clog2(Rows) + 2, RowWidth = $clog2(Rows + 1),
    CountWidth = $clog2(4 * Words + 3), LineWidth = Words * (LastShiftWidth + CoeffWidth);

wire active = u_protocol.active, last_row = u_protocol.last_row;
wire [PositionWidth-1:0] position = u_protocol.position;
wire [RowWidth-1:0] row = u_protocol.row;
logic [PositionWidth-1:0] column;  // column: chosen in the first clock, then constant

logic [LineWidth-1:0] square[Rows*Clocks];
initial $readmemh("square.hex", square);
logic [LineWidth-1:0] line;
assign line = square[32'(row)*Clocks+32'(column)];

// The recursion for one word at a time: a step in each clock in which the word followed is so old, as the multiplier
// takes it. Bursts are longer than the loop, so the next word of the column finds the last one done.
logic [Starts-1:0] start_q, frame_start_q;
logic [MeanLatency-1:0] old;  // old[n]: the column was present n + 1 enabled clocks ago
logic [9:0] active_q;
logic [9:0][1:0] ends_q;  // of any word: in the last row, in the first one
logic signed [Width-1:0] f, difference, difference_q, rounded, d, above;  // above: d of the row above that of d
logic signed [CoeffWidth-1:0] c, c_d, c_above;  // c_d: c that belongs to d
logic [LastShiftWidth-1:0] by;
logic [RowWidth-1:0] row_q, row_d;
logic singular;  // the mean replaces this d
logic signed [Width+CoeffWidth-1:0] product, ahead_product;
logic signed [Width+CoeffWidth:0] shifted, ahead;
logic signed [OutWidth-1:0] stored, expected_last, ahead_rounded, expected_ahead;
logic [3:0] clipped;
td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_difference (
  .in((Width + 1)'(f) - (row_q == '0 ? '0 : (Width + 1)'(d))), .out(difference), .clipped(clipped[0])
);
td_round_saturate #(.InWidth(Width + CoeffWidth + 1), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_rounded (
  .in(shifted), .out(rounded), .clipped(clipped[1])
);
td_round_saturate #(
  .InWidth(Width + CoeffWidth + 1), .Drop(CoeffWidth - 1 + StoreDrop), .OutWidth(OutWidth)
) u_ahead (
  .in(ahead), .out(ahead_rounded), .clipped(clipped[2])
);
td_round_saturate #(.InWidth(Width), .Drop(StoreDrop), .OutWidth(OutWidth)) u_store (
  .in(d), .out(stored), .clipped(clipped[3])
);

logic signed [MomentWidth-1:0] addend, moment;
logic signed [Width-1:0] sum, sum_q, mean, mean_q;
logic signed [Width+CoeffWidth-1:0] scaled;
td_round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
  .in(moment), .out(sum), .clipped()
);
td_round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
  .in(scaled), .out(mean), .clipped()
);

logic held;
kept #(.Width(2 * Words * OutWidth + 2)) u_kept (
  .clk, .rst, .en, .out({out_start, out_frame_start, out_last, out_ahead}), .held
);
always_ff @(posedge clk) begin
  if (!started) column <= chosen;
  if (en) begin
    start_q <= {start_q[Starts-2:0], in_start};
    frame_start_q <= {frame_start_q[Starts-2:0], in_frame_start};
    old <= {old[MeanLatency-2:0], active & (position == column)};
    active_q <= {active_q[8:0], active};
    ends_q <= {ends_q[8:0], {last_row, row == '0}};
    if (active && position == column) begin
      c <= line[Word*CoeffWidth+:CoeffWidth];
      by <= last_row ? line[Words*CoeffWidth+Word*LastShiftWidth+:LastShiftWidth] : '0;
      row_q <= row;
      singular <= Neumann != 0 && Word == 0 && column == '0 && last_row;
    end
    if (old[1]) f <= in_data[Word*Width+:Width];
    if (old[3]) difference_q <= difference;
    if (old[4]) product <= difference_q * c;
    if (old[5]) shifted <= (Width + CoeffWidth + 1)'(product) <<< by;
    if (old[6]) begin
      d <= singular ? mean_q : rounded;
      c_d <= c;
      {above, c_above} <= {d, c_d};
      row_d <= row_q;
    end
    if (old[7]) begin
      ahead_product <= d * c_above;
      addend <= MomentWidth'(32'(d) * (32'(row_d) + 1));
    end
    if (old[8]) begin
      ahead <= ((Width + CoeffWidth + 1)'(above) <<< (CoeffWidth - 1)) - (Width + CoeffWidth + 1)'(ahead_product);
      moment <= (row_d == '0 ? '0 : moment) + addend;
    end
    if (old[9]) begin
      expected_last <= stored;
      expected_ahead <= ahead_rounded;
      sum_q <= sum;
    end
    if (old[10]) scaled <= (Width + CoeffWidth)'(-MeanReciprocal * 32'(sum_q));
    if (old[11]) mean_q <= mean;
  end
  if (rst) begin
    start_q <= '0;
    frame_start_q <= '0;
    old <= '0;
    active_q <= '0;
  end
end

// Clips: those of the word followed, and that there are none without a word; the sum of all.
logic [3:0] decided, counted, due, none;  // decided: in the clock before, of the word followed
logic [CountWidth-1:0] total, total_q;
assign counted = dut.clipped[4*Word+:4];
always_comb begin
  total = CountWidth'(dut.clipped_mean[0]) + CountWidth'(dut.clipped_mean[1]);
  for (int node = 0; node < 4 * Words; node++) total = total + CountWidth'(dut.clipped[node]);
end
always_ff @(posedge clk) begin
  decided <= {4{en & ~rst}} & {old[9], old[9], old[6], old[3]};
  due <= clipped & {row_d == RowWidth'(Rows - 1), row_d != '0, 2'b11};
  none <= ~({4{en & ~rst}}
      & {active_q[9] & ends_q[9][1], active_q[9] & ~ends_q[9][0], active_q[6], active_q[3]});
  total_q <= rst ? '0 : total;
end

always_comb begin
  if (started) begin
    start_when_due: assert (out_start == start_q[ToStart-1]);
    frame_start_when_due: assert (out_frame_start == frame_start_q[ToStart-1]);
    if (old[ToWords-1]) eliminated: assert (out_last[Word*OutWidth+:OutWidth] == expected_last);
    if (old[ToWords-1] && row_d != '0) ahead_of_row: assert (out_ahead[Word*OutWidth+:OutWidth] == expected_ahead);
    clips_counted: assert ((counted & decided) == (due & decided));
    no_clips: assert ((counted & none) == '0);
    count_is_sum: assert (saturations == total_q);
    last_row_out: cover (old[ToWords-1] && row_d == RowWidth'(Rows - 1) && expected_ahead != '0 && held);
    clip_ahead: cover (decided[2] && counted[2] && row_d == RowWidth'(Rows - 1));
    if (Neumann != 0 && Word == 0) mean_out: cover (old[ToWords-1] && singular && expected_last != '0);
  end
end

// What makes the proof end.
// Steps of the proof: the word followed is the specification's in every register of the core that it passes, in the
// memory of the row above and in the mean; counters are those of the protocol; the tables stay what they are. All
// together follow from themselves in one clock, so induction ends.
if (1) begin : g_steps
  localparam int AddressWidth = $clog2(TableWords), CoeffsWidth = Words * CoeffWidth;
  wire [PositionWidth:0] left = u_protocol.u_bursts.left;  // of the protocol: clocks of the burst that are to come,
  wire [RowWidth-1:0] next_row = u_protocol.u_bursts.next_row;  // the next burst's, 0 if a frame must begin,
  wire [RowWidth-1:0] burst_row = u_protocol.u_bursts.row_q;  // that of the burst
  logic last, left_some, known, entered;  // known: a row of the column was written since the reset, or (entered) came
  logic [Words*Width-1:0] d_entry, d_read;  // of the row above
  logic [Words*CoeffWidth-1:0] c_entry, c_read;
  logic [LineWidth-1:0] line;
  assign last = row_q == RowWidth'(Rows - 1);
  assign left_some = left != '0;
  assign entered = known || old[7:0] != '0;
  assign d_entry = dut.u_d_above.u_ram.g_distributed.words[column];
  assign d_read = dut.u_d_above.u_ram.read_data;
  assign c_entry = dut.u_c_above.u_ram.g_distributed.words[column];
  assign c_read = dut.u_c_above.u_ram.read_data;
  assign line = square[32'(row_q)*Clocks+32'(column)];
  always_ff @(posedge clk) begin
    if (en && old[7]) known <= 1'b1;
    if (rst) known <= 1'b0;
  end

  // Bursts and rows.
  always_comb begin
    if (started) begin
      in_range: assert (32'(left) < Clocks && 32'(next_row) < Rows);
      now: assert (dut.active == active && (!active
          || (dut.position == position && dut.row == row)));
      count: assert (dut.position == (left_some ? PositionWidth'((PositionWidth + 1)'(Clocks) - left) : '0));
      if (left_some) burst: assert (32'(burst_row) < Rows && dut.row_q == burst_row
          && next_row == (burst_row == RowWidth'(Rows - 1) ? '0 : burst_row + RowWidth'(1)));
      else if (next_row != '0) row_to_come: assert (dut.row_q == next_row);
      starts: assert (dut.start_q == start_q[6:0]
          && dut.frame_start_q == frame_start_q[6:0]);
      actives: assert (dut.active_q == active_q);
      left_behind: assert (left == (active_q[0]
          ? (PositionWidth + 1)'(Clocks - 1) - (PositionWidth + 1)'(dut.position_q[0]) : '0));

      // Rows of the column: behind the first one, the one before was written.
      if (old[6:0] != '0) rows_follow: assert (32'(row_q) < Rows
          && (row_q == '0 || (known && row_q == row_d + RowWidth'(1))));
      else if (entered) row_written: assert (row_q == row_d);
      if (old[7] && !known) first_written: assert (row_d == '0);
      if (!left_some) between_bursts: assert (next_row == '0 || (entered && row_q == next_row - RowWidth'(1)));
      else if (Clocks - 32'(left) > 32'(column)) behind_column: assert (entered && row_q == burst_row);
      else before_column: assert (burst_row == '0 || (entered && row_q == burst_row - RowWidth'(1)));
      if (known && !old[7]) kept_above: assert (d_entry[Word*Width+:Width] == d
          && c_entry[Word*CoeffWidth+:CoeffWidth] == c_d);
    end
  end

  for (genvar n = 0; n < MeanLatency; n++) begin : g_old
    always_comb begin
      if (started) begin
        for (int m = n + 1; m < MeanLatency && m < n + Clocks; m++) assert (!(old[n] & old[m]));
      end
    end
  end
  for (genvar n = 0; n < 10; n++) begin : g_ends
    always_comb begin
      if (started && active_q[n]) ends: assert (dut.first_q[n] == ends_q[n][0]
          && dut.last_q[n] == ends_q[n][1]);
      if (started && old[n]) ends_of_word: assert (active_q[n]
          && ends_q[n] == (n < 7 ? {last, row_q == '0} : {row_d == RowWidth'(Rows - 1), row_d == '0}));
    end
  end
  for (genvar n = 0; n < 8; n++) begin : g_place
    logic [PositionWidth-1:0] here;
    assign here = dut.position_q[n];
    always_comb begin
      if (started) begin
        if (active_q[n]) at_column: assert (old[n] == (here == column));
        at_start: assert (start_q[n] == (active_q[n] & (here == '0)));
      end
    end
    if (n > 0) begin : g_behind
      logic [PositionWidth-1:0] next;
      assign next = dut.position_q[n-1];
      always_comb begin
        if (started) begin
          if (active_q[n] && here != '1) goes_on: assert (active_q[n-1] && next == here + PositionWidth'(1));
          else if (active_q[n-1]) begins: assert (next == '0);
        end
      end
    end
  end

  // The coefficient: in the table, which stays as it is, and behind it.
  logic [AddressWidth-1:0] base;
  logic [SettledWidth-1:0] settled;
  assign {base, settled} = dut.u_table.u_index.u_rom.g_distributed.words[column];
  for (genvar r = 0; r < Rows; r++) begin : g_row
    logic [LineWidth-1:0] stored;
    logic [AddressWidth-1:0] address;
    assign address = base + (r < 32'(settled) ? AddressWidth'(r) : AddressWidth'(settled));
    assign stored = r == Rows - 1 ? dut.u_table.g_last_row.u_last.u_rom.g_distributed.words[column]
        : LineWidth'(dut.u_table.u_inner.u_rom.g_distributed.words[address]);
    always_comb if (started) tables_agree: assert (stored == square[r*Clocks+32'(column)]);
  end
  always_comb begin
    if (started) begin
      if (old[5:0] != '0) own_line: assert (c == line[Word*CoeffWidth+:CoeffWidth]
          && by == (last ? line[CoeffsWidth+Word*LastShiftWidth+:LastShiftWidth] : '0));
      if (old[0]) index_read: assert (dut.u_table.row_q == $clog2(Rows)'(row_q)
          && dut.u_table.u_index.data == {base, settled}
          && dut.u_table.g_last_row.last_position[0] == column);
      if (old[1]) address_made: assert (dut.u_table.g_last_row.last_position[1] == column
          && dut.u_table.g_last_row.last_row[0] == last && (last
          || dut.u_table.address == base + (32'(row_q) < 32'(settled) ? AddressWidth'(row_q)
          : AddressWidth'(settled))));
      if (old[2]) read: assert (dut.u_table.g_last_row.last_row[1] == last
          && (last ? dut.u_table.g_last_row.u_last.word == line
          : dut.u_table.u_inner.word == line[CoeffsWidth-1:0]));
      if (old[3]) read_q: assert (dut.u_table.g_last_row.last_row[2] == last
          && (last ? {dut.u_table.g_last_row.last_shift, dut.u_table.g_last_row.last} == line
          : dut.u_table.inner == line[CoeffsWidth-1:0]));
      if (old[4]) coefficient: assert (dut.coefficients[Word*CoeffWidth+:CoeffWidth] == c
          && dut.shifts[Word*LastShiftWidth+:LastShiftWidth] == by);
      if (old[5]) shift: assert (dut.shifts_q[Word*LastShiftWidth+:LastShiftWidth] == by);
      for (int n = 5; n < 8; n++) begin
        if (old[n])
          assert (dut.coefficients_q[n-5][Word*CoeffWidth+:CoeffWidth] == (n == 7 ? c_d : c));
      end

      // The difference, the product, d.
      if (old[2]) data: assert (dut.g_word[Word].data_q[0] == f);
      if (old[2]) read_above: assert (row_q == '0 || (d_read[Word*Width+:Width] == d
          && c_read[Word*CoeffWidth+:CoeffWidth] == c_d));
      if (old[3]) operands: assert (dut.g_word[Word].data_q[1] == f
          && dut.g_word[Word].above == (row_q == '0 ? '0 : d));
      if (old[4]) difference: assert (dut.g_word[Word].difference_q == difference_q);
      if (old[5]) multiplied: assert (dut.g_word[Word].product == product);
      if (old[6]) aligned: assert (dut.g_word[Word].shifted == shifted);
      if (old[6:0] != '0) of_mean: assert (singular == (Neumann != 0 && Word == 0 && column == '0 && last));
      if (old[7]) state: assert (dut.d[Word*Width+:Width] == d);

      // A row ahead, which has no meaning in the first row.
      if (old[3] && row_q != '0) read_above_q: assert (dut.above_d[Word*Width+:Width] == d
          && dut.above_c[Word*CoeffWidth+:CoeffWidth] == c_d);
      for (int n = 4; n < 9; n++) begin
        if (old[n] && (n < 7 ? row_q : row_d) != '0)
          assert (dut.g_word[Word].above_q[n-4] == (n < 7 ? d : above));
      end
      for (int n = 4; n < 8; n++) begin
        if (old[n] && (n < 7 ? row_q : row_d) != '0)
          assert (dut.g_word[Word].above_c_q[n-4] == (n < 7 ? c_d : c_above));
      end
      if (old[8]) state_kept: assert (dut.g_word[Word].d_q[0] == d);
      if (old[9]) state_out: assert (dut.g_word[Word].d_q[1] == d);
      if (old[8] && row_d != '0)
        ahead_multiplied: assert (dut.g_word[Word].ahead_product == ahead_product);
      if (old[9] && row_d != '0) ahead_out: assert (dut.g_word[Word].ahead == ahead);
    end
  end

  // The mean is that of position 0.
  if (Neumann != 0 && Word == 0) begin : g_mean
    always_comb begin
      if (started && column == '0) begin
        for (int n = 0; n < 5; n++) assert (dut.g_mean.u_mean.after[n] == old[7+n]);
        if (old[6:0] != '0) frame: assert (row_q == '0 ? (old[6:0] & ~frame_start_q[6:0]) == '0
            : (old[6:0] & frame_start_q[6:0]) == '0);
        if (known || old[7]) weight: assert (32'(dut.g_mean.u_mean.weight) == 32'(row_d) + 1);
        if (known) addend_due: assert (MomentWidth'(dut.g_mean.u_mean.addend) == addend);
        if (known && (!old[8] || row_d != '0))
          moment_due: assert (dut.g_mean.u_mean.moment == moment);
        if (known && old[9:8] == '0) sum_due: assert (dut.g_mean.u_mean.sum_q == sum_q);
        if (known && old[10:8] == '0) scaled_due: assert (dut.g_mean.u_mean.scaled == scaled);
        if (known && old[11:8] == '0) mean_due: assert (dut.g_mean.u_mean.mean == mean_q);
      end
    end
  end
end

bind dut.u_d_above ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);
bind dut.u_c_above ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);

// Protocol: bursts of Columns / Words clocks as protocol_bursts allows them; words leave 6 enabled clocks behind the
// starts going out. out_last counts in the last row of a frame, out_ahead in all but the first.
module protocol_elimination;
  localparam int Clocks = Columns / Words, PositionWidth = $clog2(Clocks), RowWidth = $clog2(Rows + 1);
  logic active;  // a clock of a burst comes in 2 enabled clocks, with this position in it
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;  // of the burst in its frame
  logic last_row;
  logic [15:0] out_left = '0;
  logic [5:0] start_q = '0, frame_start_q;
  logic [RowWidth-1:0] out_row, out_row_q;
  logic words;
  assign words = counts_out_start & (start_q[5] | out_left != '0);
  assign out_row = ~start_q[5] ? out_row_q : frame_start_q[5] ? '0 : out_row_q + RowWidth'(1);
  assign counts_out_last = words & (out_row == RowWidth'(Rows - 1));
  assign counts_out_ahead = words & (out_row != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations, .counts()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[4:0], out_start};
      frame_start_q <= {frame_start_q[4:0], out_frame_start};
      out_left <= start_q[5] ? 16'(Clocks - 1) : out_left - 16'(out_left != '0);
      out_row_q <= out_row;
    end
    if (reset) begin
      start_q <= '0;
      out_left <= '0;
    end
  end
endmodule
