// SPDX-License-Identifier: Apache-2.0
// fv_frame_stack: an arbitrary word leaves at its place of its row, last row first, unchanged, in the lower or the upper
// half of the words; the first words Latency enabled clocks behind the first ones of the last row, pair behind pair as
// the header says; starts, frame_start and alone 6 clocks before. Any gaps between bursts, any en, any frame number, and
// frames that begin before the last one is whole.

parameter int Width = 1, Rows = 5, Columns = 8, InWords = 1, Lanes = 1, WordsPerRow = 1;
localparam int Paths = Lanes > 1 ? Lanes / 2 : 1, Clocks = Columns / InWords, Beats = Columns / Paths,
    Period = 2 * Columns / Lanes, Pairs = (Rows + 1) / 2, Leaves = (Pairs - 1) * Period + Beats,  // clocks of a frame
    Latency = InWords == Paths ? 1 : Clocks - Beats + 4;
localparam int PositionWidth = $clog2(Clocks), RowWidth = $clog2(Rows + 1), PlaceWidth = $clog2(Leaves),
    InWidth = InWords > 1 ? $clog2(InWords) : 1, OutWidth = $clog2(2 * Paths), Lead = 6;
input logic pick, of_last;
input logic [InWidth-1:0] choose;  // of the words of a clock

// All of the input as late as the words are, and the starts going out.
wire coming = u_protocol.active, coming_last = u_protocol.last_row;
logic [Lead-1:0] start_q, frame_start_q, active_q, last_row_q, out_start_q, out_frame_start_q, out_alone_q;
logic [Lead-1:0][PositionWidth-1:0] position_q;
logic [Lead-1:0][RowWidth-1:0] row_q;
logic start, frame_start, active, last_row;
logic [RowWidth-1:0] row;
assign {start, frame_start} = {start_q[Lead-1], frame_start_q[Lead-1]};
assign {active, last_row, row} = {active_q[Lead-1], last_row_q[Lead-1], row_q[Lead-1]};
always_ff @(posedge clk) begin
  if (en) begin
    start_q <= {start_q[Lead-2:0], in_start};
    frame_start_q <= {frame_start_q[Lead-2:0], in_frame_start};
    active_q <= {active_q[Lead-2:0], coming};
    last_row_q <= {last_row_q[Lead-2:0], coming_last};
    position_q <= {position_q[Lead-2:0], u_protocol.position};
    row_q <= {row_q[Lead-2:0], u_protocol.row};
    out_start_q <= {out_start_q[Lead-2:0], out_start};
    out_frame_start_q <= {out_frame_start_q[Lead-2:0], out_frame_start};
    out_alone_q <= {out_alone_q[Lead-2:0], out_alone};
  end
  if (rst) {start_q, frame_start_q, active_q, out_start_q, out_frame_start_q} <= '0;
end

// The word, its own row counted from the last one, and its place: a clock of the frame that leaves, a word of it.
logic [31:0] up, in_row, place_in;
logic [InWidth-1:0] word;
logic [OutWidth-1:0] half_in;
logic in_word;
logic [Width-1:0] data;
assign word = InWords > 1 ? choose : '0;
assign up = 32'(Rows) - 1 - 32'(row) + (of_last ? 0 : 1);
assign in_row = 32'(position_q[Lead-1]) * InWords + 32'(word);
assign place_in = up / 2 * Period + in_row / Paths;
assign half_in = OutWidth'(up % 2 * Paths + in_row % Paths);
assign in_word = active & (of_last ? last_row : row != '0);
assign data = of_last ? in_last[word*Width+:Width] : in_ahead[word*Width+:Width];

logic due, present, watched;
logic [PlaceWidth-1:0] place;
logic [OutWidth-1:0] half;
logic [Width-1:0] value;
follow_word #(.Width(OutWidth + Width), .Words(Leaves), .Latency(Latency)) u_follow (
  .clk, .rst, .en, .pick, .in_word, .in_first(frame_start), .in_closed(last_row & ~start),
  .in_place(PlaceWidth'(place_in)), .in_data({half_in, data}), .close(start & last_row), .due, .present, .place,
  .watched, .value({half, value})
);
logic held, pair_leaves;
kept #(.Width(2 * Paths * Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
assign pair_leaves = present && 32'(place) % Period == 0;

always_comb begin
  if (started) begin
    start_when_due: assert (out_start_q[Lead-1] == pair_leaves);
    frame_start_when_due: assert (out_frame_start_q[Lead-1] == due);
    if (pair_leaves) alone_when_due: assert (out_alone_q[Lead-1] == (Rows % 2 != 0 && 32'(place) / Period == Pairs - 1));
    if (watched) in_place: assert (out_data[half*Width+:Width] == value);
    last_word: cover (watched && place == PlaceWidth'(Leaves - 1));
    behind_next: cover (watched && 32'(place) >= Leaves - 2 && active && held);
  end
end

bind td_ram ram_check #(.Depth(Depth), .Defined(0), .Covered(0)) u_check (.*);

// Protocol: bursts of Columns / InWords clocks as protocol_bursts allows them, no faster in all than a frame of them
// leaves; pairs of rows going out, 6 enabled clocks behind their starts.
module protocol_frame_stack;
  localparam int Clocks = Columns / InWords, Beats = Columns / Paths,
      Period = 2 * Columns / Lanes, Pairs = (Rows + 1) / 2, PositionWidth = $clog2(Clocks),
      RowWidth = $clog2(Rows + 1);
  // Clocks that a frame waits, where rows come faster than they leave.
  localparam int Leaves = (Pairs - 1) * Period + (Rows % 2 != 0 ? Beats : Period),
      Wait = Leaves > Rows * Clocks ? Leaves - Rows * Clocks : 0;
  logic active;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  logic last_row, bursts;
  logic [15:0] wait_left = '0, out_left = '0;
  logic [5:0] start_q = '0;
  assign holds = bursts & ~(in_start & in_frame_start & wait_left != '0);
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[5] | out_left != '0);
  protocol_bursts #(.Columns(Clocks), .Rows(Rows)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row,
    .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations(), .counts()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start & last_row) wait_left <= 16'(Clocks + Wait - 1);
      else wait_left <= wait_left - 16'(wait_left != '0);
      start_q <= {start_q[4:0], out_start};
      out_left <= start_q[5] ? 16'(Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (reset) begin
      wait_left <= '0;
      start_q <= '0;
      out_left <= '0;
    end
  end
endmodule
