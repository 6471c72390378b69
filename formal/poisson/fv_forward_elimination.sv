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
forward_elimination_steps #(
  .Rows(Rows), .Columns(Columns), .Neumann(Neumann), .Words(Words), .Width(Width), .CoeffWidth(CoeffWidth),
  .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth), .MomentWidth(MomentWidth), .MeanLatency(MeanLatency)
) u_steps (
  .*, .left(u_protocol.left), .next_row(u_protocol.next_row), .burst_row(u_protocol.row_q)
);

bind dut.u_state_row ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);
