// SPDX-License-Identifier: Apache-2.0
// fv_transpose: an arbitrary word leaves in its column at the place of its row, unchanged; the first column 3 enabled
// clocks behind the first word of the last row, the others behind it without a pause; frame_start with the first. Any
// gaps between bursts, any en, any frame number, and frames that begin before the last one is whole.

parameter int Width = 1, Columns = 4, MakhoulIn = 0, MakhoulOut = 0;
input logic pick;

localparam int IndexWidth = $clog2(Columns);

logic coming, coming_last;
logic [IndexWidth-1:0] coming_position;
logic [$clog2(Columns+1)-1:0] coming_row;
protocol_bursts #(.Columns(Columns), .Rows(Columns)) u_protocol (
  .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active(coming), .position(coming_position),
  .row(coming_row), .last_row(coming_last), .holds(allowed)
);

// Words come 2 enabled clocks behind all this, and leave so behind their starts.
logic start, frame_start, active, last_row, column_leaves, frame_leaves;
logic [IndexWidth-1:0] position;
logic [$clog2(Columns+1)-1:0] row;
logic [1:0] start_q, frame_start_q, active_q, last_row_q, column_leaves_q, frame_leaves_q;
logic [1:0][IndexWidth-1:0] position_q;
logic [1:0][$clog2(Columns+1)-1:0] row_q;
assign {start, frame_start, active, last_row} = {start_q[1], frame_start_q[1], active_q[1], last_row_q[1]};
assign {column_leaves, frame_leaves, position, row} = {column_leaves_q[1], frame_leaves_q[1], position_q[1], row_q[1]};
always_ff @(posedge clk) begin
  if (en) begin
    start_q <= {start_q[0], in_start};
    frame_start_q <= {frame_start_q[0], in_frame_start};
    active_q <= {active_q[0], coming};
    last_row_q <= {last_row_q[0], coming_last};
    position_q <= {position_q[0], coming_position};
    row_q <= {row_q[0], coming_row};
    column_leaves_q <= {column_leaves_q[0], out_start};
    frame_leaves_q <= {frame_leaves_q[0], out_frame_start};
  end
  if (rst) {start_q, frame_start_q, active_q, column_leaves_q, frame_leaves_q} <= '0;
end

// Makhoul's order: even samples upwards, then odd samples downwards.
function automatic logic [IndexWidth-1:0] place_of_sample(input logic [IndexWidth-1:0] n);
  return n % 2 == 0 ? n / 2 : IndexWidth'(Columns - 1) - n / 2;
endfunction
function automatic logic [IndexWidth-1:0] sample_at_place(input logic [IndexWidth-1:0] p);
  return 32'(p) < Columns / 2 ? p * 2 : IndexWidth'(2 * (Columns - 1 - 32'(p)) + 1);
endfunction
logic [IndexWidth-1:0] column, row_place;
assign column = MakhoulIn != 0 ? sample_at_place(position) : position;
assign row_place = MakhoulOut != 0 ? place_of_sample(IndexWidth'(row)) : IndexWidth'(row);

logic due, present, watched;
logic [2*IndexWidth-1:0] place;
logic [Width-1:0] value;
follow_word #(.Width(Width), .Words(Columns * Columns), .Latency(3)) u_follow (
  .clk, .rst, .en, .pick, .in_word(active), .in_first(frame_start), .in_closed(last_row & ~start),
  .in_place({column, row_place}), .in_data, .close(start & last_row), .due, .present, .place, .watched, .value
);
logic held;
kept #(.Width(Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);

always_comb begin
  if (started) begin
    frame_when_due: assert (frame_leaves == due);
    column_when_due: assert (column_leaves == (present && place[IndexWidth-1:0] == '0));
    if (watched) in_place: assert (out_data == value);
    last_word: cover (watched && place == '1);
    last_word_behind_next: cover (watched && place == '1 && active && held);
  end
end

bind dut.u_ram ram_check #(.Depth(Depth)) u_check (.*);
