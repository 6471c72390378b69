// SPDX-License-Identifier: Apache-2.0
// fv_frame_stack: an arbitrary word leaves at its place of its row, last row first, unchanged; the last row 3 enabled
// clocks behind its own first word, from lane 0, the others from the lanes in turn, each Columns / Lanes clocks behind
// the one before; frame_start with the first of each lane. Any gaps between bursts, any en, any frame number, and
// frames that begin before the last one is whole.

`default_nettype none

module fv_frame_stack #(
  parameter int Width       = 1,
  parameter int Rows        = 3,
  parameter int Columns     = 4,
  parameter int Lanes       = 1,
  parameter int WordsPerRow = 1,
  localparam int Step = Columns / Lanes,
  localparam int Clocks = (Rows - 1) * Step + Columns,  // in which a frame leaves
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Rows + 1),
  localparam int PlaceWidth = $clog2(Clocks),
  localparam int LaneWidth = Lanes > 1 ? $clog2(Lanes) : 1
) (
  input logic             clk,
  input logic             rst,
  input logic             en,
  input logic             in_start,
  input logic             in_frame_start,
  input logic [Width-1:0] in_data,
  input logic             pick
);

  logic allowed, started, active, last_row;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  logic [Lanes-1:0] out_start, out_frame_start;
  logic [Lanes*Width-1:0] out_data;
  frame_stack #(.Width(Width), .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .WordsPerRow(WordsPerRow)) dut (.*);
  protocol_bursts #(.Columns(Columns), .Rows(Rows)) u_protocol (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start(out_start[0]), .active, .position, .row, .last_row, .holds(allowed)
  );
  assumed u_assumed (.clk, .rst, .allowed, .started);

  // A place is a clock of the frame that leaves; with the word goes the lane that it leaves from.
  logic due, present, watched;
  logic [PlaceWidth-1:0] place;
  logic [LaneWidth-1:0] in_lane, lane;
  logic [Width-1:0] value, out_word;
  assign in_lane = LaneWidth'((Rows - 1 - 32'(row)) % Lanes);
  follow_word #(.Width(LaneWidth + Width), .Words(Clocks), .Latency(3)) u_follow (
    .clk, .rst, .en, .pick, .in_word(active), .in_first(in_frame_start), .in_closed(last_row & ~in_start),
    .in_place(PlaceWidth'((Rows - 1 - 32'(row)) * Step + 32'(position))), .in_data({in_lane, in_data}),
    .close(in_start & last_row), .due, .present, .place, .watched, .value({lane, value})
  );
  logic [Lanes-1:0] starts, frame_starts;
  for (genvar e = 0; e < Lanes; e++) begin : g_lane
    assign starts[e] = present && 32'(place) / Step < Rows && 32'(place) % Columns == e * Step;
    assign frame_starts[e] = starts[e] && 32'(place) == e * Step;
  end
  always_comb begin
    out_word = '0;
    for (int e = 0; e < Lanes; e++) if (Lanes == 1 || lane == LaneWidth'(e)) out_word = out_data[e*Width+:Width];
  end
  logic held;
  kept #(.Width(Lanes * Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);

  always_comb begin
    if (started) begin
      frame_when_due: assert (out_frame_start == frame_starts);
      row_when_due: assert (out_start == starts);
      if (watched) in_place: assert (out_word == value);
      last_word: cover (watched && place == PlaceWidth'(Clocks - 1));
      last_word_behind_next: cover (watched && place == PlaceWidth'(Clocks - 1) && active && held);
    end
  end

  bind td_ram ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);
  // Lane 0 reads no memory where the last row is its only one, and a lane beyond the rows never does.
  for (genvar e = 0; e < Lanes; e++) begin : g_read
    if (e == 0 ? Rows > Lanes : e < Rows) begin : g_memory
      always_comb begin
        if (started) last_word_read: cover (dut.g_lane[e].u_ram.read_en
            && 32'(dut.g_lane[e].u_ram.read_address) == dut.g_lane[e].u_ram.Depth - 1);
      end
    end
  end

endmodule

`default_nettype wire
