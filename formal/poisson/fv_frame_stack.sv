// SPDX-License-Identifier: Apache-2.0
// fv_frame_stack: an arbitrary word leaves at its place of its row, last row first, unchanged; the last row 3 enabled
// clocks behind its own first word, the others without a pause behind it; frame_start with the first. Any gaps between
// bursts, any en, any frame number, and frames that begin before the last one is whole.

parameter int Width = 1, Rows = 3, Columns = 4, WordsPerRow = 1;
input logic pick;

localparam int Clocks = Rows * Columns;  // in which a frame leaves
localparam int PositionWidth = $clog2(Columns), RowWidth = $clog2(Rows + 1), PlaceWidth = $clog2(Clocks);

logic active, last_row;
logic [PositionWidth-1:0] position;
logic [RowWidth-1:0] row;
protocol_bursts #(.Columns(Columns), .Rows(Rows)) u_protocol (
  .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds(allowed)
);

// A place is a clock of the frame that leaves.
logic due, present, watched;
logic [PlaceWidth-1:0] place;
logic [Width-1:0] value;
follow_word #(.Width(Width), .Words(Clocks), .Latency(3)) u_follow (
  .clk, .rst, .en, .pick, .in_word(active), .in_first(in_frame_start), .in_closed(last_row & ~in_start),
  .in_place(PlaceWidth'((Rows - 1 - 32'(row)) * Columns + 32'(position))), .in_data,
  .close(in_start & last_row), .due, .present, .place, .watched, .value
);
logic held;
kept #(.Width(Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);

always_comb begin
  if (started) begin
    frame_when_due: assert (out_frame_start == (present && place == '0));
    row_when_due: assert (out_start == (present && 32'(place) % Columns == 0));
    if (watched) in_place: assert (out_data == value);
    last_word: cover (watched && place == PlaceWidth'(Clocks - 1));
    last_word_behind_next: cover (watched && place == PlaceWidth'(Clocks - 1) && active && held);
    last_word_read: cover (dut.u_ram.read_en && 32'(dut.u_ram.read_address) == dut.u_ram.Depth - 1);
  end
end

bind td_ram ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);
