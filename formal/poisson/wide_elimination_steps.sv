// SPDX-License-Identifier: Apache-2.0
// wide_elimination_steps: helps the proof of fv_wide_elimination to end. The word followed is the specification's in
// every register of the core that it passes, in the memory of the row above and in the mean; counters are those of the
// protocol; the tables stay what they are. All together follow from themselves in one clock, so induction ends.

`default_nettype none

module wide_elimination_steps #(
  parameter int Rows           = 3,
  parameter int Clocks         = 8,
  parameter int Words          = 2,
  parameter int Word           = 0,
  parameter int Neumann        = 0,
  parameter int TableWords     = 16,
  parameter int Width          = 3,
  parameter int CoeffWidth     = 3,
  parameter int SettledWidth   = 2,
  parameter int LastShiftWidth = 1,
  parameter int MomentWidth    = 9,
  parameter int MeanLatency    = 12,
  localparam int PositionWidth = $clog2(Clocks),
  localparam int RowWidth = $clog2(Rows + 1),
  localparam int AddressWidth = $clog2(TableWords),
  localparam int CoeffsWidth = Words * CoeffWidth,
  localparam int LineWidth = Words * (LastShiftWidth + CoeffWidth)
) (
  input logic                               clk,
  input logic                               rst,
  input logic                               en,
  input logic                               started,
  input logic                               active,
  input logic        [PositionWidth-1:0]    position,
  input logic        [RowWidth-1:0]         row,
  input logic        [PositionWidth:0]      left,       // of the protocol: clocks of the burst that are to come,
  input logic        [RowWidth-1:0]         next_row,   // the next burst's, 0 if a frame must begin,
  input logic        [RowWidth-1:0]         burst_row,  // that of the burst
  input logic        [PositionWidth-1:0]    column,
  input logic        [LineWidth-1:0]        square[Rows*Clocks],
  input logic        [8:0]                  start_q,
  input logic        [8:0]                  frame_start_q,
  input logic        [MeanLatency-1:0]      old,
  input logic        [9:0]                  active_q,
  input logic        [9:0][1:0]             ends_q,
  input logic        [RowWidth-1:0]         row_q,
  input logic        [RowWidth-1:0]         row_d,
  input logic                               singular,
  input logic signed [Width-1:0]            f,
  input logic signed [Width-1:0]            difference_q,
  input logic signed [Width-1:0]            d,
  input logic signed [Width-1:0]            above,
  input logic signed [CoeffWidth-1:0]       c,
  input logic signed [CoeffWidth-1:0]       c_d,
  input logic signed [CoeffWidth-1:0]       c_above,
  input logic        [LastShiftWidth-1:0]   by,
  input logic signed [Width+CoeffWidth-1:0] product,
  input logic signed [Width+CoeffWidth-1:0] ahead_product,
  input logic signed [Width+CoeffWidth:0]   shifted,
  input logic signed [Width+CoeffWidth:0]   ahead,
  input logic signed [MomentWidth-1:0]      addend,
  input logic signed [MomentWidth-1:0]      moment,
  input logic signed [Width-1:0]            sum_q,
  input logic signed [Width-1:0]            mean_q,
  input logic signed [Width+CoeffWidth-1:0] scaled
);
  logic last, left_some, known, entered;  // known: a row of the column was written since the reset, or (entered) came
  logic [Words*(Width+CoeffWidth)-1:0] entry, read;  // of the row above
  logic [LineWidth-1:0] line;
  assign last = row_q == RowWidth'(Rows - 1);
  assign left_some = left != '0;
  assign entered = known || old[7:0] != '0;
  assign entry = fv_wide_elimination.dut.u_row_above.g_distributed.words[column];
  assign read = fv_wide_elimination.dut.u_row_above.read_data;
  assign line = square[32'(row_q)*Clocks+32'(column)];
  always_ff @(posedge clk) begin
    if (en && old[7]) known <= 1'b1;
    if (rst) known <= 1'b0;
  end

  // Bursts and rows.
  always_comb begin
    if (started) begin
      in_range: assert (32'(left) < Clocks && 32'(next_row) < Rows);
      now: assert (fv_wide_elimination.dut.active == active && (!active
          || (fv_wide_elimination.dut.position == position && fv_wide_elimination.dut.row == row)));
      count: assert (fv_wide_elimination.dut.u_counter.running == left_some && (!left_some
          || fv_wide_elimination.dut.u_counter.count == PositionWidth'((PositionWidth + 1)'(Clocks) - left)));
      if (left_some) burst: assert (32'(burst_row) < Rows && fv_wide_elimination.dut.row_q == burst_row
          && next_row == (burst_row == RowWidth'(Rows - 1) ? '0 : burst_row + RowWidth'(1)));
      else if (next_row != '0) row_to_come: assert (fv_wide_elimination.dut.row_q == next_row);
      starts: assert (fv_wide_elimination.dut.start_q == start_q[7:0]
          && fv_wide_elimination.dut.frame_start_q == frame_start_q[7:0]);
      actives: assert (fv_wide_elimination.dut.active_q == active_q);
      left_behind: assert (left == (active_q[0]
          ? (PositionWidth + 1)'(Clocks - 1) - (PositionWidth + 1)'(fv_wide_elimination.dut.position_q[0]) : '0));

      // Rows of the column: behind the first one, the one before was written.
      if (old[6:0] != '0) rows_follow: assert (32'(row_q) < Rows
          && (row_q == '0 || (known && row_q == row_d + RowWidth'(1))));
      else if (entered) row_written: assert (row_q == row_d);
      if (old[7] && !known) first_written: assert (row_d == '0);
      if (!left_some) between_bursts: assert (next_row == '0 || (entered && row_q == next_row - RowWidth'(1)));
      else if (Clocks - 32'(left) > 32'(column)) behind_column: assert (entered && row_q == burst_row);
      else before_column: assert (burst_row == '0 || (entered && row_q == burst_row - RowWidth'(1)));
      if (known && !old[7]) kept_above: assert (entry[Word*Width+:Width] == d
          && entry[Words*Width+Word*CoeffWidth+:CoeffWidth] == c_d);
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
      if (started && active_q[n]) ends: assert (fv_wide_elimination.dut.first_q[n] == ends_q[n][0]
          && fv_wide_elimination.dut.last_q[n] == ends_q[n][1]);
      if (started && old[n]) ends_of_word: assert (active_q[n]
          && ends_q[n] == (n < 7 ? {last, row_q == '0} : {row_d == RowWidth'(Rows - 1), row_d == '0}));
    end
  end
  for (genvar n = 0; n < 8; n++) begin : g_place
    logic [PositionWidth-1:0] here;
    assign here = fv_wide_elimination.dut.position_q[n];
    always_comb begin
      if (started) begin
        if (active_q[n]) at_column: assert (old[n] == (here == column));
        at_start: assert (start_q[n] == (active_q[n] & (here == '0)));
      end
    end
    if (n > 0) begin : g_behind
      logic [PositionWidth-1:0] next;
      assign next = fv_wide_elimination.dut.position_q[n-1];
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
  assign {base, settled} = fv_wide_elimination.dut.u_table.u_index.g_distributed.words[column];
  for (genvar r = 0; r < Rows; r++) begin : g_row
    logic [LineWidth-1:0] stored;
    logic [AddressWidth-1:0] address;
    assign address = base + (r < 32'(settled) ? AddressWidth'(r) : AddressWidth'(settled));
    assign stored = r == Rows - 1 ? fv_wide_elimination.dut.u_table.g_last_row.u_last.g_distributed.words[column]
        : LineWidth'(fv_wide_elimination.dut.u_table.u_inner.g_distributed.words[address]);
    always_comb if (started) tables_agree: assert (stored == square[r*Clocks+32'(column)]);
  end
  always_comb begin
    if (started) begin
      if (old[5:0] != '0) own_line: assert (c == line[Word*CoeffWidth+:CoeffWidth]
          && by == (last ? line[CoeffsWidth+Word*LastShiftWidth+:LastShiftWidth] : '0));
      if (old[0]) index_read: assert (fv_wide_elimination.dut.u_table.row_q == $clog2(Rows)'(row_q)
          && fv_wide_elimination.dut.u_table.u_index.data == {base, settled}
          && fv_wide_elimination.dut.u_table.g_last_row.last_position[0] == column);
      if (old[1]) address_made: assert (fv_wide_elimination.dut.u_table.g_last_row.last_position[1] == column
          && fv_wide_elimination.dut.u_table.g_last_row.last_row[0] == last && (last
          || fv_wide_elimination.dut.u_table.address == base + (32'(row_q) < 32'(settled) ? AddressWidth'(row_q)
          : AddressWidth'(settled))));
      if (old[2]) inner_read: assert (fv_wide_elimination.dut.u_table.g_last_row.last_position[2] == column
          && fv_wide_elimination.dut.u_table.g_last_row.last_row[1] == last
          && (last || fv_wide_elimination.dut.u_table.inner == line[CoeffsWidth-1:0]));
      if (old[3]) last_read: assert (fv_wide_elimination.dut.u_table.g_last_row.last_row[2] == last
          && (last ? {fv_wide_elimination.dut.u_table.g_last_row.last_shift,
          fv_wide_elimination.dut.u_table.g_last_row.last} == line
          : fv_wide_elimination.dut.u_table.inner_q == line[CoeffsWidth-1:0]));
      if (old[4]) coefficient: assert (fv_wide_elimination.dut.coefficients[Word*CoeffWidth+:CoeffWidth] == c
          && fv_wide_elimination.dut.shifts[Word*LastShiftWidth+:LastShiftWidth] == by);
      if (old[5]) shift: assert (fv_wide_elimination.dut.shifts_q[Word*LastShiftWidth+:LastShiftWidth] == by);
      for (int n = 5; n < 8; n++) begin
        if (old[n])
          assert (fv_wide_elimination.dut.coefficients_q[n-5][Word*CoeffWidth+:CoeffWidth] == (n == 7 ? c_d : c));
      end

      // The difference, the product, d.
      if (old[2]) data: assert (fv_wide_elimination.dut.g_word[Word].data_q == f);
      if (old[2]) read_above: assert (row_q == '0 || (read[Word*Width+:Width] == d
          && read[Words*Width+Word*CoeffWidth+:CoeffWidth] == c_d));
      if (old[3]) difference: assert (fv_wide_elimination.dut.g_word[Word].difference_q[0] == difference_q);
      if (old[4]) difference_kept: assert (fv_wide_elimination.dut.g_word[Word].difference_q[1] == difference_q);
      if (old[5]) multiplied: assert (fv_wide_elimination.dut.g_word[Word].product == product);
      if (old[6]) aligned: assert (fv_wide_elimination.dut.g_word[Word].shifted == shifted);
      if (old[6:0] != '0) of_mean: assert (singular == (Neumann != 0 && Word == 0 && column == '0 && last));
      if (old[7]) state: assert (fv_wide_elimination.dut.d[Word*Width+:Width] == d);

      // A row ahead, which has no meaning in the first row.
      for (int n = 3; n < 9; n++) begin
        if (old[n] && (n < 7 ? row_q : row_d) != '0)
          assert (fv_wide_elimination.dut.g_word[Word].above_q[n-3] == (n < 7 ? d : above));
      end
      for (int n = 3; n < 8; n++) begin
        if (old[n] && (n < 7 ? row_q : row_d) != '0)
          assert (fv_wide_elimination.dut.g_word[Word].above_c_q[n-3] == (n < 7 ? c_d : c_above));
      end
      if (old[8]) state_kept: assert (fv_wide_elimination.dut.g_word[Word].d_q[0] == d);
      if (old[9]) state_out: assert (fv_wide_elimination.dut.g_word[Word].d_q[1] == d);
      if (old[8] && row_d != '0)
        ahead_multiplied: assert (fv_wide_elimination.dut.g_word[Word].ahead_product == ahead_product);
      if (old[9] && row_d != '0) ahead_out: assert (fv_wide_elimination.dut.g_word[Word].ahead == ahead);
    end
  end

  // The mean is that of position 0.
  if (Neumann != 0 && Word == 0) begin : g_mean
    always_comb begin
      if (started && column == '0) begin
        for (int n = 0; n < 5; n++) assert (fv_wide_elimination.dut.g_mean.u_mean.after[n] == old[7+n]);
        if (old[6:0] != '0) frame: assert (row_q == '0 ? (old[6:0] & ~frame_start_q[6:0]) == '0
            : (old[6:0] & frame_start_q[6:0]) == '0);
        if (known || old[7]) weight: assert (32'(fv_wide_elimination.dut.g_mean.u_mean.weight) == 32'(row_d) + 1);
        if (known) addend_due: assert (MomentWidth'(fv_wide_elimination.dut.g_mean.u_mean.addend) == addend);
        if (known && (!old[8] || row_d != '0))
          moment_due: assert (fv_wide_elimination.dut.g_mean.u_mean.moment == moment);
        if (known && old[9:8] == '0) sum_due: assert (fv_wide_elimination.dut.g_mean.u_mean.sum_q == sum_q);
        if (known && old[10:8] == '0) scaled_due: assert (fv_wide_elimination.dut.g_mean.u_mean.scaled == scaled);
        if (known && old[11:8] == '0) mean_due: assert (fv_wide_elimination.dut.g_mean.u_mean.mean == mean_q);
      end
    end
  end

endmodule

`default_nettype wire
