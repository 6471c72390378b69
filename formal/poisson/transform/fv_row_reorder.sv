// SPDX-License-Identifier: Apache-2.0
// fv_row_reorder: an arbitrary word leaves at its place, unchanged; a burst 2 enabled clocks behind the last word of
// its row; frame_start with the burst of a frame's first row. Any gaps, any en, and frames that begin inside a row.

parameter int Width = 1, Columns = 8, ToBurst = 1;
input logic pick;

localparam int PositionWidth = $clog2(Columns);

protocol_words #(.Columns(Columns)) u_protocol (
  .clk, .rst, .en, .in_valid, .in_frame_start, .out_start, .holds(allowed)
);

// Place in the row.
logic of_first_row, of_first_row_q;
logic [PositionWidth-1:0] position, next_position;
assign position = in_frame_start ? '0 : next_position;
assign of_first_row = in_frame_start | (of_first_row_q & (position != '0));
logic row_end;
assign row_end = in_valid & (position == PositionWidth'(Columns - 1));
always_ff @(posedge clk) begin
  if (en && in_valid) begin
    next_position <= position + PositionWidth'(1);
    of_first_row_q <= of_first_row;
  end
end

// Makhoul's order: even samples upwards, then odd samples downwards.
logic [PositionWidth-1:0] place_of_sample, sample_at_place;
assign place_of_sample = position % 2 == 0 ? position / 2 : PositionWidth'(Columns - 1) - position / 2;
assign sample_at_place = 32'(position) < Columns / 2 ? position * 2
    : PositionWidth'(2 * (Columns - 1 - 32'(position)) + 1);

logic due, present, watched;
logic [PositionWidth-1:0] place;
logic [Width-1:0] value;
follow_word #(.Width(Width), .Words(Columns), .Latency(2)) u_follow (
  .*, .in_word(in_valid), .in_first(in_valid & (position == '0)), .in_closed(1'b0),
  .in_place(ToBurst != 0 ? place_of_sample : sample_at_place), .close(row_end)
);
logic [1:0] first_row_ends;
logic held;
kept #(.Width(Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) first_row_ends <= {first_row_ends[0], row_end & of_first_row};
  if (rst) first_row_ends <= '0;
end

always_comb begin
  if (started) begin
    burst_when_due: assert (out_start == due);
    frame_start_when_due: assert (out_frame_start == first_row_ends[1]);
    if (watched) in_place: assert (out_data == value);
    last_word: cover (watched && place == PositionWidth'(Columns - 1));
    behind_restart: cover (watched && out_frame_start && in_frame_start);
    back_to_back: cover (due && next_position == '0 && in_valid && held);
  end
end

bind dut.u_ram ram_check #(.Depth(Depth)) u_check (.*);
