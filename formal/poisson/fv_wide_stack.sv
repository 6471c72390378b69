// SPDX-License-Identifier: Apache-2.0
// fv_wide_stack: the word of an arbitrary place of every frame leaves unchanged in its beat and at its place of it, the
// last row first; the first words out Latency enabled clocks behind those of the last row, and no pause in a frame;
// starts, frame_start and alone 6 clocks before. Any gaps between bursts, any en, and frames that begin afresh.

parameter int Width = 1, Rows = 3, Columns = 16, InWords = 2, OutWords = 4;
localparam int InWidth = $clog2(InWords), PositionWidth = $clog2(Columns / InWords), RowWidth = $clog2(Rows + 1);
input logic choose_last;  // the word followed is one of in_last
input logic [RowWidth-1:0] choose_row;
input logic [PositionWidth-1:0] choose_position;
input logic [InWidth-1:0] choose_word;  // of a clock

localparam int OutWidth = $clog2(OutWords), Clocks = Columns / InWords, Beats = Columns / OutWords,
    Pairs = (Rows + 1) / 2, Latency = Clocks - Beats / 2 + 2;
localparam int ToStart = Latency + 2 - 6;  // clocks from the start of the last row to the first start
localparam int Longest = Latency + Pairs * 2 * Beats + 1;  // to the last word, and one more
localparam int AgeWidth = $clog2(Longest), BeatWidth = $clog2(Beats);

wire active = u_protocol.active, last_row = u_protocol.last_row;
wire [PositionWidth-1:0] position = u_protocol.position;
wire [RowWidth-1:0] row = u_protocol.row;

// All of the input as late as the words are, and the starts of last rows as late as anything that follows from them.
logic [1:0] start_q, frame_start_q, active_q;
logic [1:0][PositionWidth-1:0] position_q;
logic [1:0][RowWidth-1:0] row_q;
logic [Longest-1:0] closes;  // closes[n]: a last row began n + 1 enabled clocks ago
always_ff @(posedge clk) begin
  if (en) begin
    start_q <= {start_q[0], in_start};
    frame_start_q <= {frame_start_q[0], in_frame_start};
    active_q <= {active_q[0], active};
    position_q <= {position_q[0], position};
    row_q <= {row_q[0], row};
    closes <= {closes[Longest-2:0], in_start & last_row};
  end
  if (rst) begin
    start_q <= '0;
    frame_start_q <= '0;
    active_q <= '0;
    closes <= '0;
  end
end

// The word followed, the same in every frame: chosen in the first clock, then constant. It comes with row `with_row`.
logic of_last, in_last_row;
logic [RowWidth-1:0] with_row;
logic [PositionWidth-1:0] at_position;
logic [InWidth-1:0] word;
assign in_last_row = with_row == RowWidth'(Rows - 1);
always_ff @(posedge clk) begin
  if (!started) begin
    of_last <= choose_last;
    with_row <= choose_last || 32'(choose_row) >= Rows ? RowWidth'(Rows - 1)
        : choose_row == '0 ? RowWidth'(1) : choose_row;
    at_position <= choose_position;
    word <= choose_word;
  end
end

// Where it leaves: its block of OutWords / 2 positions gives the beat and the half of it.
function automatic logic [BeatWidth-1:0] mirror(input logic [BeatWidth-1:0] beat);
  logic above;
  above = 1'b0;
  for (int b = BeatWidth - 1; b >= 0; b--) begin
    mirror[b] = beat[b] ^ above;
    above = above | beat[b];
  end
endfunction
logic [31:0] in_row, block;
logic [BeatWidth-1:0] beat;
logic [OutWidth-1:0] lane;
logic [RowWidth-1:0] own_row;
logic [AgeWidth-1:0] read_age;  // the n of closes[n] in the clock in which the memory is read, 2 before it leaves
assign in_row = 32'(at_position) * InWords + 32'(word);
assign block = in_row / (OutWords / 2);
assign beat = block[0] ? mirror(BeatWidth'(block >> 1)) : BeatWidth'(block >> 1);
assign lane = OutWidth'(32'(block[0]) * (OutWords / 2) + in_row % (OutWords / 2));
assign own_row = of_last ? with_row : with_row - RowWidth'(1);
assign read_age = AgeWidth'(Latency - 1 + (Rows - 1 - 32'(own_row)) * Beats + 32'(beat));

// A word of the last two rows comes behind the start of the last row and waits in `closed` for its read. Any other is
// in `open` until the next frame could begin, because that has words of its own before the last of this one are read.
logic comes, closing, has_open, due, reads, held;
logic [1:0] reads_q;
logic [Width-1:0] in_word, open, closed, expected, out_word;
assign comes = active_q[1] & (row_q[1] == with_row) & (position_q[1] == at_position);
assign closing = in_last_row ? comes : closes[Clocks];
assign in_word = of_last ? in_last[word*Width+:Width] : in_ahead[word*Width+:Width];
assign reads = closes[read_age];
assign out_word = out_data[lane*Width+:Width];
kept #(.Width(OutWords * Width)) u_kept (.clk, .rst, .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) begin
    if (comes) open <= in_word;
    has_open <= ~in_last_row & (comes | (has_open & ~closing & ~frame_start_q[1]));
    if (closing) closed <= in_last_row ? in_word : open;
    due <= closing | (due & ~reads);
    if (reads) expected <= closed;
    reads_q <= {reads_q[0], reads};
  end
  if (rst) begin
    has_open <= 1'b0;
    due <= 1'b0;
    reads_q <= '0;
  end
end

logic [Pairs-1:0] pairs;  // that begin
for (genvar pair = 0; pair < Pairs; pair++) begin : g_pair
  assign pairs[pair] = closes[ToStart-1+pair*2*Beats];
end

always_comb begin
  if (started) begin
    start_when_due: assert (out_start == (pairs != '0));
    frame_start_when_due: assert (out_frame_start == pairs[0]);
    if (out_start) alone_when_due: assert (out_alone == (Rows % 2 != 0 && pairs[Pairs-1]));
    if (closing) complete: assert (!due && (in_last_row || has_open));
    if (reads) came_before: assert (due);
    if (reads_q[1]) in_place: assert (out_word == expected);
    first_row_last: cover (reads_q[1] && own_row == '0 && 32'(beat) == Beats - 1 && held && expected != '0);
    behind_next: cover (reads_q[1] && active && en && expected != '0);
  end
end

// What makes the proof end.
wide_stack_steps #(
  .Width(Width), .Rows(Rows), .Columns(Columns), .InWords(InWords), .OutWords(OutWords), .ToStart(ToStart),
  .Longest(Longest)
) u_steps (
  .*, .left(u_protocol.u_bursts.left), .next_row(u_protocol.u_bursts.next_row),
  .burst_row(u_protocol.u_bursts.row_q), .wait_left(u_protocol.wait_left)
);

bind td_ram ram_check #(.Depth(Depth), .Defined(0), .Covered(0)) u_check (.*);

// Protocol: bursts of Columns / InWords clocks as protocol_bursts allows them, no faster in all than a frame of them
// leaves; pairs of rows going out, 6 enabled clocks behind their starts.
module protocol_wide_stack;
  localparam int Clocks = Columns / InWords, Beats = Columns / OutWords, PositionWidth = $clog2(Clocks),
      RowWidth = $clog2(Rows + 1);
  logic active;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  logic last_row;
  // Clocks that a frame of an odd number of rows waits, where rows come as fast as they leave.
  localparam int Wait = (Rows + 1) / 2 * 2 * Beats > Rows * Clocks ? (Rows + 1) / 2 * 2 * Beats - Rows * Clocks : 0;
  logic bursts, unused_saturations, unused_counts;
  logic [15:0] wait_left = '0, out_left = '0;
  logic [5:0] start_q = '0;
  assign holds = bursts & ~(in_start & in_frame_start & wait_left != '0);
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[5] | out_left != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row,
    .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations(unused_saturations),
    .counts(unused_counts)
  );
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start & last_row) wait_left <= 16'(Clocks + Wait - 1);
      else wait_left <= wait_left - 16'(wait_left != '0);
      start_q <= 6'({start_q, out_start});
      out_left <= start_q[5] ? 16'(2 * Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (reset) begin
      wait_left <= '0;
      start_q <= '0;
      out_left <= '0;
    end
  end
endmodule
