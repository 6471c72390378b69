// SPDX-License-Identifier: Apache-2.0
// fv_wide_elimination: d[i] = c[i] (f[i] - d[i-1]) and e[i-1] = d[i-1] - c[i-1] d[i] for every row of word Word in an
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

localparam int ToStart = 9;
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
logic [ToStart-1:0] start_q, frame_start_q;
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
logic [1:0] unused_mean;
td_round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
  .in(moment), .out(sum), .clipped(unused_mean[0])
);
td_round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
  .in(scaled), .out(mean), .clipped(unused_mean[1])
);

logic held;
kept #(.Width(2 * Words * OutWidth + 2)) u_kept (
  .clk, .rst, .en, .out({out_start, out_frame_start, out_last, out_ahead}), .held
);
always_ff @(posedge clk) begin
  if (!started) column <= chosen;
  if (en) begin
    start_q <= {start_q[ToStart-2:0], in_start};
    frame_start_q <= {frame_start_q[ToStart-2:0], in_frame_start};
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
    if (old[2]) difference_q <= difference;
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
  decided <= {4{en & ~rst}} & {old[9], old[9], old[6], old[2]};
  due <= clipped & {row_d == RowWidth'(Rows - 1), row_d != '0, 2'b11};
  none <= ~({4{en & ~rst}}
      & {active_q[9] & ends_q[9][1], active_q[9] & ~ends_q[9][0], active_q[6], active_q[2]});
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
wide_elimination_steps #(
  .Rows(Rows), .Clocks(Clocks), .Words(Words), .Word(Word), .Neumann(Neumann), .TableWords(TableWords), .Width(Width),
  .CoeffWidth(CoeffWidth), .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth), .MomentWidth(MomentWidth),
  .MeanLatency(MeanLatency)
) u_steps (
  .*, .left(u_protocol.u_bursts.left), .next_row(u_protocol.u_bursts.next_row), .burst_row(u_protocol.u_bursts.row_q)
);

bind dut.u_row_above ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);

// Protocol: bursts of Columns / Words clocks as protocol_bursts allows them; words leave 2 enabled clocks behind the
// starts going out. out_last counts in the last row of a frame, out_ahead in all but the first.
module protocol_wide_elimination;
  localparam int Clocks = Columns / Words, PositionWidth = $clog2(Clocks), RowWidth = $clog2(Rows + 1);
  logic active;  // a clock of a burst comes in 2 enabled clocks, with this position in it
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;  // of the burst in its frame
  logic last_row;
  logic [15:0] out_left = '0;
  logic [1:0] start_q = '0, frame_start_q;
  logic [RowWidth-1:0] out_row, out_row_q;
  logic words, unused_counts;
  assign words = counts_out_start & (start_q[1] | out_left != '0);
  assign out_row = ~start_q[1] ? out_row_q : frame_start_q[1] ? '0 : out_row_q + RowWidth'(1);
  assign counts_out_last = words & (out_row == RowWidth'(Rows - 1));
  assign counts_out_ahead = words & (out_row != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations, .counts(unused_counts)
  );
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[0], out_start};
      frame_start_q <= {frame_start_q[0], out_frame_start};
      out_left <= start_q[1] ? 16'(Clocks - 1) : out_left - 16'(out_left != '0);
      out_row_q <= out_row;
    end
    if (reset) begin
      start_q <= '0;
      out_left <= '0;
    end
  end
endmodule
