// SPDX-License-Identifier: Apache-2.0
// fv_row_order: an arbitrary word leaves at its place, unchanged, in a burst that begins 2 enabled clocks behind the
// last word of its row; start and frame_start with that word. Any gaps, any en, and frames that begin inside a row.

parameter int Width = 1, Columns = 8, Paths = 2;
input logic pick;

localparam int PositionWidth = $clog2(Columns), Beats = Columns / Paths, BeatWidth = $clog2(Beats);

// Place in the row.
logic of_first_row, of_first_row_q, row_end;
logic [PositionWidth-1:0] position, next_position;
assign position = in_frame_start ? '0 : next_position;
assign of_first_row = in_frame_start | (of_first_row_q & (position != '0));
assign row_end = in_valid & (position == PositionWidth'(Columns - 1));
always_ff @(posedge clk) begin
  if (en && in_valid) begin
    next_position <= position + PositionWidth'(1);
    of_first_row_q <= of_first_row;
  end
end

// Makhoul's order: even samples upwards, then odd samples downwards; a path has Beats neighbours.
logic [PositionWidth-1:0] makhoul;
assign makhoul = position % 2 == 0 ? position / 2 : PositionWidth'(Columns - 1) - position / 2;

localparam int PathWidth = Paths > 1 ? $clog2(Paths) : 1;
logic due, present, watched;
logic [BeatWidth-1:0] place;
logic [PathWidth+Width-1:0] followed;
follow_word #(.Width(PathWidth + Width), .Words(Beats), .Latency(2)) u_follow (
  .clk, .rst, .en, .pick, .in_word(in_valid), .in_first(in_valid & (position == '0)), .in_closed(1'b0),
  .in_place(BeatWidth'(makhoul)), .in_data({PathWidth'(32'(makhoul) / Beats), in_data}), .close(row_end),
  .due, .present, .place, .watched, .value(followed)
);

logic [PathWidth-1:0] path;
assign path = Paths > 1 ? followed[Width+:PathWidth] : '0;
always_comb begin
  if (started) begin
    if (!rst) start_with_last: assert (out_start == row_end);
    if (!rst) frame_start_with_last: assert (out_frame_start == (row_end & of_first_row));
    if (watched) in_place: assert (out_data[path*Width+:Width] == followed[Width-1:0]);
    last_word: cover (watched && place == BeatWidth'(Beats - 1) && path == PathWidth'(Paths - 1));
    back_to_back: cover (due && next_position == PositionWidth'(1) && in_valid && en);
  end
end

bind td_ram ram_check #(.Depth(Depth)) u_check (.clk, .write_en, .write_address, .read_en, .read_address);

// Protocol: single words go in; bursts of Columns / Paths beats go out, 2 enabled clocks behind their start.
module protocol_row_order;
  logic [1:0] start_q;
  always_ff @(posedge clk) begin
    if (en) start_q <= {start_q[0], out_start};
    if (reset) start_q <= '0;
  end
  protocol_words #(.Columns(Columns), .Lanes(Paths)) u_words (
    .clk, .rst, .en, .in_valid, .in_frame_start, .out_start(start_q[1]), .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations(), .counts
  );
endmodule
