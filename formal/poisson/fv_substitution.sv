// SPDX-License-Identifier: Apache-2.0
// fv_substitution: z[i] = e[i] + c[i] c[i+1] z[i+2] for every lower row (Word 0) or upper row (Word 1) of an arbitrary
// beat in the pairs of any frame, 2 enabled clocks behind e[i], with the coefficient of its own pair and beat; start,
// frame_start and alone with their pair. Beside a row alone leaves 0. Each clip is counted once, and none of a row that
// does not count. No word of the frame before, and none from power-up, enters: the specification has none. Rounding is
// proven of td_round_saturate.

parameter int Rows = 5, Columns = 4;
parameter int Word = 0;  // the one followed
parameter int TableWords = 4;
localparam int Words = 2, Paths = 1, Beats = Columns, PositionWidth = $clog2(Beats), InWidth = 2, Width = 3,
    CoeffWidth = 3, Drop = -1, SettledWidth = 3;
input logic [PositionWidth-1:0] chosen;

localparam int ToStart = 6;
localparam int ToWords = 8;  // from a start to the first words out
localparam int Aligned = InWidth - Drop + CoeffWidth - 1,
    ExactWidth = (Aligned > Width + CoeffWidth ? Aligned : Width + CoeffWidth) + 1, Pairs = (Rows + 1) / 2,
    PairWidth = $clog2(Pairs + 1), CountWidth = $clog2(Words + 1);

logic active, present, last;  // present: the beat followed
logic [PositionWidth-1:0] position, column;  // column: chosen in the first clock, then constant
logic [PairWidth-1:0] pair;
protocol_pairs #(.Columns(Columns), .Rows(Rows)) u_protocol (
  .clk, .rst, .en, .in_start, .in_frame_start, .in_alone, .out_start, .active, .position, .pair, .last,
  .holds(allowed)
);
assign present = active & (position == column);

logic [Words*CoeffWidth:0] square[Pairs*Beats];
initial $readmemh("square.hex", square);

// The recursion: a step in each clock in which the beat followed is so old, as the multiplier takes it. A pair is as
// long as the loop or longer, so the next beat of the column finds the last one done.
logic [ToStart-1:0] start_q, frame_start_q, alone_q;
logic [ToWords-1:0] old, active_q;  // old[n]: the beat of the column was present n + 1 enabled clocks ago
logic [ToWords-1:0][PairWidth-1:0] pair_q;
logic not_counted;  // the row beside a row alone
assign not_counted = Word == 1 && Rows % 2 != 0 && pair_q[6] == PairWidth'(Pairs - 1);
logic [31:0] from_top;  // pairs
logic [Words*CoeffWidth:0] line;
logic signed [InWidth-1:0] e;
logic signed [CoeffWidth-1:0] c;
logic signed [Width-1:0] below, z, rounded;  // z of the row followed, below: of the one 2 rows below
logic signed [Width+CoeffWidth-1:0] product;
logic signed [ExactWidth-1:0] exact;
logic clipped;
assign from_top = Pairs - 1 - 32'(pair_q[4]);
assign line = square[from_top*Beats+32'(column)];
assign c = line[Word*CoeffWidth+:CoeffWidth];
assign e = in_data[Word*InWidth+:InWidth];
td_round_saturate #(.InWidth(ExactWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_round (
  .in(exact), .out(rounded), .clipped
);

logic held, followed, clip_due, counted;  // followed: the clip of the beat was decided in the clock before
logic [CountWidth-1:0] sum, sum_q;
logic none;  // no beat was in the rounding
kept #(.Width(Words * Width + 3)) u_kept (
  .clk, .rst, .en, .out({out_start, out_frame_start, out_alone & out_start, out_data}), .held
);
always_comb begin
  sum = '0;
  for (int word = 0; word < Words; word++) sum = sum + CountWidth'(dut.clipped_q[word]);
end
always_ff @(posedge clk) begin
  if (!started) column <= chosen;
  if (en) begin
    start_q <= {start_q[ToStart-2:0], in_start};
    frame_start_q <= {frame_start_q[ToStart-2:0], in_frame_start};
    alone_q <= {alone_q[ToStart-2:0], in_alone};
    old <= {old[ToWords-2:0], present};
    active_q <= {active_q[ToWords-2:0], active};
    pair_q <= {pair_q[ToWords-2:0], pair};
    if (old[3]) below <= pair_q[3] == '0 ? '0 : z;
    if (old[4]) product <= below * c;
    if (old[5]) exact <= (ExactWidth'(e) <<< (CoeffWidth - 1 - Drop)) - ExactWidth'(product);
    if (old[6]) z <= not_counted ? '0 : rounded;
  end
  followed <= en & old[6] & ~rst;
  clip_due <= clipped & ~not_counted;
  none <= ~(en & active_q[6]) | rst;
  sum_q <= rst ? '0 : sum;
  if (rst) begin
    start_q <= '0;
    frame_start_q <= '0;
    old <= '0;
    active_q <= '0;
  end
end
assign counted = dut.clipped_q[Word];

always_comb begin
  if (started) begin
    start_when_due: assert (out_start == start_q[ToStart-1]);
    frame_start_when_due: assert (out_frame_start == frame_start_q[ToStart-1]);
    if (out_start) alone_when_due: assert (out_alone == alone_q[ToStart-1]);
    if (old[ToWords-1]) substituted: assert (out_data[Word*Width+:Width] == z);
    if (followed) clip_counted: assert (counted == clip_due);
    if (none) no_clip: assert (!counted);
    count_is_sum: assert (saturations == sum_q);
    last_out: cover (old[ToWords-1] && pair_q[ToWords-1] == PairWidth'(Rows / 2 - 1) && z != '0 && held);
    clip_in_last: cover (followed && counted && pair_q[ToWords-1] == PairWidth'(Rows / 2 - 1));
  end
end

// What makes the proof of a z that waits end: places go down the pipeline as here, and the memory has the last z.
if (Beats > 4) begin : g_waits
  logic known;  // a z of the column was written since the reset
  wire [Width-1:0] entry = dut.g_word[Word].g_waits.u_below.u_ram.g_distributed.words[column];
  always_ff @(posedge clk) begin
    if (en && old[ToWords-1]) known <= 1'b1;
    if (rst) known <= 1'b0;
  end
  always_comb begin
    if (started) begin
      actives: assert (dut.active_q == active_q);
      for (int n = 0; n < ToWords; n++) if (active_q[n]) assert (old[n] == (dut.position_q[n] == column));
      if (known && !old[ToWords-1]) stands: assert (entry == z);
    end
  end
end
