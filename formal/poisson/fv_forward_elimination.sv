// SPDX-License-Identifier: Apache-2.0
// fv_forward_elimination: d[i] = c[i] (f[i] - d[i-1]) for every row of an arbitrary column, of any frame, 7 enabled
// clocks behind f[i], with the coefficient of its own row and column; start and frame_start with their burst. Neumann:
// the last row of column 0 is minus the mean. No word of the frame before, and none from power-up, enters: the
// specification has none, and the memories begin with any contents. Rounding is proven of td_round_saturate.

parameter int Rows = 3, Columns = 8, Neumann = 0, Words = 16;
localparam int PositionWidth = $clog2(Columns), Width = 3, CoeffWidth = 3, OutWidth = 2, StoreDrop = 1,
    SettledWidth = 2, LastShiftWidth = 1, MomentDrop = 1, MeanReciprocal = 2, MeanDrop = 1, TableWords = Words;
input logic [PositionWidth-1:0] chosen;

localparam int RowWidth = $clog2(Rows + 1), Latency = 9;
localparam int MeanLatency = 12;  // from f to the mean that it is in
localparam int MomentWidth = Width + 2 * $clog2(Rows) + 2;

logic active, last_row;
logic [PositionWidth-1:0] position, column;  // column: chosen in the first clock, then constant
logic [RowWidth-1:0] row;
protocol_bursts #(.Columns(Columns), .Rows(Rows)) u_protocol (
  .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds(allowed)
);

logic [LastShiftWidth+CoeffWidth-1:0] square[Rows*Columns];
initial $readmemh("square.hex", square);

// The recursion for one word at a time: a step in each clock in which the word followed is so old, as the multiplier
// takes it. Bursts are longer than the way, so the next word of the column finds the last one done.
logic [Latency-1:0] start_q, frame_start_q;
logic [MeanLatency-1:0] old;  // old[n]: a word of the column was present n + 1 enabled clocks ago
logic signed [Width-1:0] f, above, difference, difference_q, rounded, d;  // above: d of the row above
logic signed [CoeffWidth-1:0] c;
logic [LastShiftWidth-1:0] by;
logic [RowWidth-1:0] row_q;
logic singular;  // the mean replaces this d
logic signed [Width+CoeffWidth-1:0] product;
logic signed [Width+CoeffWidth:0] shifted;
logic signed [OutWidth-1:0] stored, expected;
logic [2:0] unused_clipped;
td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_difference (
  .in((Width + 1)'(f) - (row_q == '0 ? '0 : (Width + 1)'(above))), .out(difference), .clipped(unused_clipped[0])
);
td_round_saturate #(.InWidth(Width + CoeffWidth + 1), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_rounded (
  .in(shifted), .out(rounded), .clipped(unused_clipped[1])
);
td_round_saturate #(.InWidth(Width), .Drop(StoreDrop), .OutWidth(OutWidth)) u_store (
  .in(above), .out(stored), .clipped(unused_clipped[2])
);

logic signed [MomentWidth-1:0] addend, moment;
logic signed [Width-1:0] sum, sum_q, mean, mean_q;
logic signed [Width+CoeffWidth-1:0] scaled;
logic [1:0] unused_mean;
td_round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
  .in(moment), .out(sum), .clipped(unused_mean[0])
);
td_round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
  .in(scaled), .out(mean), .clipped(unused_mean[1])
);
assign d = singular ? mean_q : rounded;

logic held;
logic [RowWidth-1:0] row_of_addend;
kept #(.Width(OutWidth + 2)) u_kept (.clk, .rst, .en, .out({out_start, out_frame_start, out_data}), .held);
always_ff @(posedge clk) begin
  if (!started) column <= chosen;
  if (en) begin
    start_q <= Latency'({start_q, in_start});
    frame_start_q <= Latency'({frame_start_q, in_frame_start});
    old <= MeanLatency'({old, active & (position == column)});
    if (active && position == column) begin
      f <= in_data;
      {by, c} <= square[32'(row) * Columns + 32'(column)];
      row_q <= row;
      singular <= Neumann != 0 && column == '0 && last_row;
    end
    if (old[2]) difference_q <= difference;
    if (old[4]) product <= difference_q * c;
    if (old[5]) shifted <= (Width + CoeffWidth + 1)'(product) <<< by;
    if (old[6]) above <= d;
    if (old[7]) begin
      expected <= stored;
      addend <= MomentWidth'(32'(above) * (32'(row_q) + 1));
      row_of_addend <= row_q;
    end
    if (old[8]) moment <= (row_of_addend == '0 ? '0 : moment) + addend;
    if (old[9]) sum_q <= sum;
    if (old[10]) scaled <= (Width + CoeffWidth)'(-MeanReciprocal * 32'(sum_q));
    if (old[11]) mean_q <= mean;
  end
  if (rst) begin
    start_q <= '0;
    frame_start_q <= '0;
    old <= '0;
  end
end

always_comb begin
  if (started) begin
    start_when_due: assert (out_start == start_q[Latency-1]);
    frame_start_when_due: assert (out_frame_start == frame_start_q[Latency-1]);
    if (old[Latency-1]) eliminated: assert (out_data == expected);
    last_row_out: cover (old[Latency-1] && row_q == RowWidth'(Rows - 1) && expected != '0 && expected != '1);
    if (Neumann != 0) mean_out: cover (old[Latency-1] && singular && expected != '0);
  end
end

// What makes the proof end.
// Steps of the proof, as those of fv_wide_elimination: the word followed is the specification's in every register of the
// core that it passes, in the memory of the row above and in the mean; counters are those of the protocol; the tables
// stay what they are.
if (1) begin : g_steps
  localparam int AddressWidth = $clog2(Words), LineWidth = LastShiftWidth + CoeffWidth;
  wire [PositionWidth:0] left = u_protocol.left;  // of the protocol: words of the burst that are to come,
  wire [RowWidth-1:0] next_row = u_protocol.next_row;  // the next burst's, 0 if a frame must begin,
  wire [RowWidth-1:0] burst_row = u_protocol.row_q;  // that of the burst
  logic last, left_some, known, entered;  // known: a row of the column was written since the reset, or (entered) came
  logic [7:0] active_q;
  logic [RowWidth-1:0] row_d;  // of the last row that was written, or is about to be
  logic [Width-1:0] entry;     // of the row above
  logic [LineWidth-1:0] line;
  assign last = row_q == RowWidth'(Rows - 1);
  assign left_some = left != '0;
  assign entered = known || old[7:0] != '0;
  assign active_q = dut.active_q;
  assign entry = dut.u_state_row.g_distributed.words[column];
  assign line = square[32'(row_q)*Columns+32'(column)];
  always_ff @(posedge clk) begin
    if (en && old[6]) row_d <= row_q;
    if (en && old[7]) known <= 1'b1;
    if (rst) known <= 1'b0;
  end

  // Bursts and rows.
  always_comb begin
    if (started) begin
      in_range: assert (32'(left) < Columns && 32'(next_row) < Rows);
      now: assert (dut.active == active && (!active
          || (dut.position == position && dut.row == row)));
      count: assert (dut.u_counter.running == left_some && (!left_some
          || dut.u_counter.count == PositionWidth'((PositionWidth + 1)'(Columns) - left)));
      if (left_some) burst: assert (32'(burst_row) < Rows && dut.row_q == burst_row
          && next_row == (burst_row == RowWidth'(Rows - 1) ? '0 : burst_row + RowWidth'(1)));
      else if (next_row != '0) row_to_come: assert (dut.row_q == next_row);
      starts: assert (dut.start_q == start_q[7:0]
          && dut.frame_start_q == frame_start_q[7:0]);
      left_behind: assert (left == (active_q[0]
          ? (PositionWidth + 1)'(Columns - 1) - (PositionWidth + 1)'(dut.position_q[0]) : '0));

      // Rows of the column: behind the first one, the one before was written.
      if (old[6:0] != '0) rows_follow: assert (32'(row_q) < Rows
          && (row_q == '0 || (known && row_q == row_d + RowWidth'(1))));
      else if (entered) row_written: assert (row_q == row_d);
      if (old[7] && !known) first_written: assert (row_d == '0);
      if (!left_some) between_bursts: assert (next_row == '0 || (entered && row_q == next_row - RowWidth'(1)));
      else if (Columns - 32'(left) > 32'(column)) behind_column: assert (entered && row_q == burst_row);
      else before_column: assert (burst_row == '0 || (entered && row_q == burst_row - RowWidth'(1)));
      if (known && !old[7]) kept_above: assert (entry == above);
    end
  end

  for (genvar n = 0; n < MeanLatency; n++) begin : g_old
    always_comb begin
      if (started) begin
        for (int m = n + 1; m < MeanLatency && m < n + Columns; m++) assert (!(old[n] & old[m]));
      end
    end
  end
  for (genvar n = 0; n < 8; n++) begin : g_place
    logic [PositionWidth-1:0] here;
    assign here = dut.position_q[n];
    always_comb begin
      if (started) begin
        if (active_q[n]) at_column: assert (old[n] == (here == column));
        if (old[n]) present: assert (active_q[n]);
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
  assign {base, settled} = dut.u_table.u_index.g_distributed.words[column];
  for (genvar r = 0; r < Rows; r++) begin : g_row
    logic [LineWidth-1:0] stored;
    logic [AddressWidth-1:0] address;
    assign address = base + (r < 32'(settled) ? AddressWidth'(r) : AddressWidth'(settled));
    assign stored = r == Rows - 1 ? dut.u_table.g_last_row.u_last.g_distributed.words[column]
        : LineWidth'(dut.u_table.u_inner.g_distributed.words[address]);
    always_comb if (started) tables_agree: assert (stored == square[r*Columns+32'(column)]);
  end
  always_comb begin
    if (started) begin
      if (old[5:0] != '0) own_line: assert (c == line[CoeffWidth-1:0]
          && by == (last ? line[CoeffWidth+:LastShiftWidth] : '0));
      if (old[0]) index_read: assert (dut.u_table.row_q == $clog2(Rows)'(row_q)
          && dut.u_table.u_index.data == {base, settled}
          && dut.u_table.g_last_row.last_position[0] == column);
      if (old[1]) address_made: assert (dut.u_table.g_last_row.last_position[1] == column
          && dut.u_table.g_last_row.last_row[0] == last && (last
          || dut.u_table.address == base + (32'(row_q) < 32'(settled) ? AddressWidth'(row_q)
          : AddressWidth'(settled))));
      if (old[2]) inner_read: assert (dut.u_table.g_last_row.last_position[2] == column
          && dut.u_table.g_last_row.last_row[1] == last
          && (last || dut.u_table.inner == line[CoeffWidth-1:0]));
      if (old[3]) last_read: assert (dut.u_table.g_last_row.last_row[2] == last
          && (last ? {dut.u_table.g_last_row.last_shift,
          dut.u_table.g_last_row.last} == line
          : dut.u_table.inner_q == line[CoeffWidth-1:0]));
      if (old[4]) coefficient: assert (dut.coefficient == c
          && dut.shift == by);
      if (old[5]) shift: assert (dut.shift_q == by);

      // The difference, the product, d.
      for (int n = 0; n < 3; n++) if (old[n]) assert (dut.data_q[n] == f);
      for (int n = 0; n < 2; n++) if (old[n]) assert (dut.first_row_q[n] == (row_q == '0));
      if (old[1]) read_above: assert (row_q == '0 || dut.state == above);
      if (old[2]) above_or_0: assert (dut.above == (row_q == '0 ? '0 : above));
      if (old[3]) difference: assert (dut.difference_q[0] == difference_q);
      if (old[4]) difference_kept: assert (dut.difference_q[1] == difference_q);
      if (old[5]) multiplied: assert (dut.product == product && (!singular || product == '0));
      if (old[6]) aligned: assert (dut.shifted == (singular
          ? (Width + CoeffWidth + 1)'(mean_q) <<< (CoeffWidth - 1) : shifted));
      if (old[6:0] != '0) of_mean: assert (singular == (Neumann != 0 && column == '0 && last));
      if (Neumann != 0 && column == '0) last_is_0: assert (square[(Rows-1)*Columns][CoeffWidth-1:0] == '0);
      if (old[7]) state: assert (dut.d == above);
    end
  end

  // The mean is that of position 0.
  if (Neumann != 0) begin : g_mean
    always_comb begin
      for (int n = 0; n < 5; n++) begin
        if (started && old[n]) assert (dut.singular_q[n] == (column == '0 && last));
      end
      if (started && old[5]) joins: assert (dut.g_mean.u_mean.mean == mean_q || !singular);
      if (started && old[5]) joined: assert (dut.last_mean == (singular ? mean_q : '0));
      if (started && old[8]) row_added: assert (row_of_addend == row_d);
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

bind dut.u_state_row ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);
