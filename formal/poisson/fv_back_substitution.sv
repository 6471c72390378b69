// SPDX-License-Identifier: Apache-2.0
// fv_back_substitution: z[i] = d[i] - c[i] z[i+1] for every row of an arbitrary column, of any frame, 8 enabled clocks
// behind d[i], with the coefficient of its own row and column; start and frame_start with their burst. No word of the
// frame before, and none from power-up, enters: the specification has none, and the memory begins with any contents.
// Rounding is proven of td_round_saturate.

parameter int Rows = 3, Columns = 8, Words = 16;
localparam int PositionWidth = $clog2(Columns), InWidth = 2, Width = 3, CoeffWidth = 3, Drop = -1, SettledWidth = 2,
    TableWords = Words;
input logic [PositionWidth-1:0] chosen;

localparam int RowWidth = $clog2(Rows + 1), Latency = 8, LastShiftWidth = 1, Aligned = InWidth - Drop + CoeffWidth - 1,
    ExactWidth = (Aligned > Width + CoeffWidth ? Aligned : Width + CoeffWidth) + 1;

logic active, last_row, present;  // present: the word of the column
logic [PositionWidth-1:0] position, column;  // column: chosen in the first clock, then constant
logic [RowWidth-1:0] row;
protocol_bursts #(.Columns(Columns), .Rows(Rows)) u_protocol (
  .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds(allowed)
);
assign present = active & (position == column);

// The last row comes first; there the coefficient meets zero, so its shift does not matter.
logic [LastShiftWidth+CoeffWidth-1:0] square[Rows*Columns];
initial $readmemh("square.hex", square);

// The recursion: a step in each clock in which the word followed is so old, as the multiplier takes it. Bursts are as
// long as the way, so the next word of the column finds the last one done.
logic [Latency-1:0] start_q, frame_start_q;
logic [Latency-1:0] old;  // old[n]: a word of the column was present n + 1 enabled clocks ago
logic signed [InWidth-1:0] d, d_q;
logic signed [CoeffWidth-1:0] c, c_q;
logic [LastShiftWidth-1:0] unused_shift;
logic signed [Width-1:0] below, below_q, z;  // below: z of the row below
logic signed [Width+CoeffWidth-1:0] product;
logic signed [ExactWidth-1:0] exact;
logic unused_clipped, of_last_row, of_first_row, of_first_row_q;
td_round_saturate #(.InWidth(ExactWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_round (
  .in(exact), .out(z), .clipped(unused_clipped)
);

logic held;
kept #(.Width(Width + 2)) u_kept (.clk, .rst, .en, .out({out_start, out_frame_start, out_data}), .held);
always_ff @(posedge clk) begin
  if (!started) column <= chosen;
  if (en) begin
    start_q <= Latency'({start_q, in_start});
    frame_start_q <= Latency'({frame_start_q, in_frame_start});
    old <= Latency'({old, present});
    if (present) begin
      d <= in_data;
      {unused_shift, c} <= square[(Rows - 1 - 32'(row)) * Columns + 32'(column)];
      of_last_row <= row == '0;
      of_first_row <= row == RowWidth'(Rows - 1);
    end
    if (old[3]) begin
      below_q <= of_last_row ? '0 : below;
      {d_q, c_q, of_first_row_q} <= {d, c, of_first_row};
    end
    if (old[4]) product <= below_q * c_q;
    if (old[5]) exact <= (ExactWidth'(d_q) <<< (CoeffWidth - 1 - Drop)) - ExactWidth'(product);
    if (old[6]) below <= z;
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
    if (old[Latency-1]) substituted: assert (out_data == below);
    last_out: cover (old[Latency-1] && of_first_row_q && below != '0 && held);
  end
end

bind td_ram ram_check #(.Depth(Depth), .Defined(0)) u_check (.clk, .write_en, .write_address, .read_en, .read_address);
