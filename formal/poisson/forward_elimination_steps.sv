// SPDX-License-Identifier: Apache-2.0
// forward_elimination_steps: helps the proof of fv_forward_elimination to end, as wide_elimination_steps does. The word
// followed is the specification's in every register of the core that it passes, in the memory of the row above and in
// the mean; counters are those of the protocol; the tables stay what they are.

`default_nettype none

module forward_elimination_steps #(
  parameter int Rows           = 3,
  parameter int Columns        = 8,
  parameter int Neumann        = 0,
  parameter int Words          = 16,
  parameter int Width          = 3,
  parameter int CoeffWidth     = 3,
  parameter int SettledWidth   = 2,
  parameter int LastShiftWidth = 1,
  parameter int MomentWidth    = 9,
  parameter int MeanLatency    = 12,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows + 1),
  localparam int AddressWidth = $clog2(Words),
  localparam int LineWidth = LastShiftWidth + CoeffWidth
) (
  input logic                               clk,
  input logic                               rst,
  input logic                               en,
  input logic                               started,
  input logic                               active,
  input logic        [PositionWidth-1:0]    position,
  input logic        [RowWidth-1:0]         row,
  input logic        [PositionWidth:0]      left,       // of the protocol: words of the burst that are to come,
  input logic        [RowWidth-1:0]         next_row,   // the next burst's, 0 if a frame must begin,
  input logic        [RowWidth-1:0]         burst_row,  // that of the burst
  input logic        [PositionWidth-1:0]    column,
  input logic        [LineWidth-1:0]        square[Rows*Columns],
  input logic        [8:0]                  start_q,
  input logic        [8:0]                  frame_start_q,
  input logic        [MeanLatency-1:0]      old,
  input logic        [RowWidth-1:0]         row_q,
  input logic        [RowWidth-1:0]         row_of_addend,
  input logic                               singular,
  input logic signed [Width-1:0]            f,
  input logic signed [Width-1:0]            above,
  input logic signed [Width-1:0]            difference_q,
  input logic signed [CoeffWidth-1:0]       c,
  input logic        [LastShiftWidth-1:0]   by,
  input logic signed [Width+CoeffWidth-1:0] product,
  input logic signed [Width+CoeffWidth:0]   shifted,
  input logic signed [MomentWidth-1:0]      addend,
  input logic signed [MomentWidth-1:0]      moment,
  input logic signed [Width-1:0]            sum_q,
  input logic signed [Width-1:0]            mean_q,
  input logic signed [Width+CoeffWidth-1:0] scaled
);

  logic last, left_some, known, entered;  // known: a row of the column was written since the reset, or (entered) came
  logic [7:0] active_q;
  logic [RowWidth-1:0] row_d;  // of the last row that was written, or is about to be
  logic [Width-1:0] entry;     // of the row above
  logic [LineWidth-1:0] line;
  assign last = row_q == RowWidth'(Rows - 1);
  assign left_some = left != '0;
  assign entered = known || old[7:0] != '0;
  assign active_q = fv_forward_elimination.dut.active_q;
  assign entry = fv_forward_elimination.dut.u_state_row.g_distributed.words[column];
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
      now: assert (fv_forward_elimination.dut.active == active && (!active
          || (fv_forward_elimination.dut.position == position && fv_forward_elimination.dut.row == row)));
      count: assert (fv_forward_elimination.dut.u_counter.running == left_some && (!left_some
          || fv_forward_elimination.dut.u_counter.count == PositionWidth'((PositionWidth + 1)'(Columns) - left)));
      if (left_some) burst: assert (32'(burst_row) < Rows && fv_forward_elimination.dut.row_q == burst_row
          && next_row == (burst_row == RowWidth'(Rows - 1) ? '0 : burst_row + RowWidth'(1)));
      else if (next_row != '0) row_to_come: assert (fv_forward_elimination.dut.row_q == next_row);
      starts: assert (fv_forward_elimination.dut.start_q == start_q[7:0]
          && fv_forward_elimination.dut.frame_start_q == frame_start_q[7:0]);
      left_behind: assert (left == (active_q[0]
          ? (PositionWidth + 1)'(Columns - 1) - (PositionWidth + 1)'(fv_forward_elimination.dut.position_q[0]) : '0));

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
    assign here = fv_forward_elimination.dut.position_q[n];
    always_comb begin
      if (started) begin
        if (active_q[n]) at_column: assert (old[n] == (here == column));
        if (old[n]) present: assert (active_q[n]);
        at_start: assert (start_q[n] == (active_q[n] & (here == '0)));
      end
    end
    if (n > 0) begin : g_behind
      logic [PositionWidth-1:0] next;
      assign next = fv_forward_elimination.dut.position_q[n-1];
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
  assign {base, settled} = fv_forward_elimination.dut.u_table.u_index.g_distributed.words[column];
  for (genvar r = 0; r < Rows; r++) begin : g_row
    logic [LineWidth-1:0] stored;
    logic [AddressWidth-1:0] address;
    assign address = base + (r < 32'(settled) ? AddressWidth'(r) : AddressWidth'(settled));
    assign stored = r == Rows - 1 ? fv_forward_elimination.dut.u_table.g_last_row.u_last.g_distributed.words[column]
        : LineWidth'(fv_forward_elimination.dut.u_table.u_inner.g_distributed.words[address]);
    always_comb if (started) tables_agree: assert (stored == square[r*Columns+32'(column)]);
  end
  always_comb begin
    if (started) begin
      if (old[5:0] != '0) own_line: assert (c == line[CoeffWidth-1:0]
          && by == (last ? line[CoeffWidth+:LastShiftWidth] : '0));
      if (old[0]) index_read: assert (fv_forward_elimination.dut.u_table.row_q == $clog2(Rows)'(row_q)
          && fv_forward_elimination.dut.u_table.u_index.data == {base, settled}
          && fv_forward_elimination.dut.u_table.g_last_row.last_position[0] == column);
      if (old[1]) address_made: assert (fv_forward_elimination.dut.u_table.g_last_row.last_position[1] == column
          && fv_forward_elimination.dut.u_table.g_last_row.last_row[0] == last && (last
          || fv_forward_elimination.dut.u_table.address == base + (32'(row_q) < 32'(settled) ? AddressWidth'(row_q)
          : AddressWidth'(settled))));
      if (old[2]) inner_read: assert (fv_forward_elimination.dut.u_table.g_last_row.last_position[2] == column
          && fv_forward_elimination.dut.u_table.g_last_row.last_row[1] == last
          && (last || fv_forward_elimination.dut.u_table.inner == line[CoeffWidth-1:0]));
      if (old[3]) last_read: assert (fv_forward_elimination.dut.u_table.g_last_row.last_row[2] == last
          && (last ? {fv_forward_elimination.dut.u_table.g_last_row.last_shift,
          fv_forward_elimination.dut.u_table.g_last_row.last} == line
          : fv_forward_elimination.dut.u_table.inner_q == line[CoeffWidth-1:0]));
      if (old[4]) coefficient: assert (fv_forward_elimination.dut.coefficient == c
          && fv_forward_elimination.dut.shift == by);
      if (old[5]) shift: assert (fv_forward_elimination.dut.shift_q == by);

      // The difference, the product, d.
      for (int n = 0; n < 3; n++) if (old[n]) assert (fv_forward_elimination.dut.data_q[n] == f);
      for (int n = 0; n < 2; n++) if (old[n]) assert (fv_forward_elimination.dut.first_row_q[n] == (row_q == '0));
      if (old[1]) read_above: assert (row_q == '0 || fv_forward_elimination.dut.state == above);
      if (old[2]) above_or_0: assert (fv_forward_elimination.dut.above == (row_q == '0 ? '0 : above));
      if (old[3]) difference: assert (fv_forward_elimination.dut.difference_q[0] == difference_q);
      if (old[4]) difference_kept: assert (fv_forward_elimination.dut.difference_q[1] == difference_q);
      if (old[5]) multiplied: assert (fv_forward_elimination.dut.product == product && (!singular || product == '0));
      if (old[6]) aligned: assert (fv_forward_elimination.dut.shifted == (singular
          ? (Width + CoeffWidth + 1)'(mean_q) <<< (CoeffWidth - 1) : shifted));
      if (old[6:0] != '0) of_mean: assert (singular == (Neumann != 0 && column == '0 && last));
      if (Neumann != 0 && column == '0) last_is_0: assert (square[(Rows-1)*Columns][CoeffWidth-1:0] == '0);
      if (old[7]) state: assert (fv_forward_elimination.dut.d == above);
    end
  end

  // The mean is that of position 0.
  if (Neumann != 0) begin : g_mean
    always_comb begin
      for (int n = 0; n < 5; n++) begin
        if (started && old[n]) assert (fv_forward_elimination.dut.singular_q[n] == (column == '0 && last));
      end
      if (started && old[5]) joins: assert (fv_forward_elimination.dut.g_mean.u_mean.mean == mean_q || !singular);
      if (started && old[5]) joined: assert (fv_forward_elimination.dut.last_mean == (singular ? mean_q : '0));
      if (started && old[8]) row_added: assert (row_of_addend == row_d);
      if (started && column == '0) begin
        for (int n = 0; n < 5; n++) assert (fv_forward_elimination.dut.g_mean.u_mean.after[n] == old[7+n]);
        if (old[6:0] != '0) frame: assert (row_q == '0 ? (old[6:0] & ~frame_start_q[6:0]) == '0
            : (old[6:0] & frame_start_q[6:0]) == '0);
        if (known || old[7]) weight: assert (32'(fv_forward_elimination.dut.g_mean.u_mean.weight) == 32'(row_d) + 1);
        if (known) addend_due: assert (MomentWidth'(fv_forward_elimination.dut.g_mean.u_mean.addend) == addend);
        if (known && (!old[8] || row_d != '0))
          moment_due: assert (fv_forward_elimination.dut.g_mean.u_mean.moment == moment);
        if (known && old[9:8] == '0) sum_due: assert (fv_forward_elimination.dut.g_mean.u_mean.sum_q == sum_q);
        if (known && old[10:8] == '0) scaled_due: assert (fv_forward_elimination.dut.g_mean.u_mean.scaled == scaled);
        if (known && old[11:8] == '0) mean_due: assert (fv_forward_elimination.dut.g_mean.u_mean.mean == mean_q);
      end
    end
  end

endmodule

`default_nettype wire
